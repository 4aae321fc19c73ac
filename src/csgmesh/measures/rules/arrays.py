"""Rules about the arrays: numbers in range, no point twice, none unused."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.mesh import Mesh


class HasMesh(Protocol):
    """A case of the plane or of space."""

    @property
    def mesh(self) -> Mesh: ...


def check_indices(case: HasMesh) -> Check:
    """Every number points to something, and coordinates are finite."""
    mesh, rule = case.mesh, "indices"
    failures: list[Failure] = []
    total = 0
    limits: list[tuple[str, np.ndarray, int, int]] = []
    n_curves = 0 if mesh.curves is None else len(mesh.curves)
    for kind in mesh.cells:
        limits.append((f"cells[{kind!r}]", mesh.cells[kind], 0, mesh.n_points))
        region = mesh.cell_region[kind]
        limits.append((f"cell_region[{kind!r}]", region, 0, len(mesh.region_names)))
    for kind in mesh.facets:
        limits += [
            (f"facets[{kind!r}]", mesh.facets[kind], 0, mesh.n_points),
            (f"facet_marker[{kind!r}]", mesh.facet_marker[kind], -1, len(mesh.boundary_names)),
            (f"facet_region[{kind!r}]", mesh.facet_region[kind], -1, len(mesh.region_names)),
            (f"facet_curve[{kind!r}]", mesh.facet_curve[kind], -1, n_curves),
        ]
    limits.append(("point_marker", mesh.point_marker, -1, len(mesh.boundary_names)))
    for name, values, low, end in limits:
        total += values.size
        if values.size and (values.min() < low or values.max() >= end):
            rows = np.flatnonzero(
                ((values < low) | (values >= end)).reshape(len(values), -1).any(1)
            )
            message = f"{name} must lie from {low} to {end - 1}; row {rows[0]} is {values[rows[0]]}"
            entities = tuple(rows[:100].tolist())
            failures.append(Failure(rule, message, (), "row", entities, len(rows)))
    bad = np.flatnonzero(~np.isfinite(mesh.points).all(axis=1))
    failures += offenders(rule, "point", bad, mesh.points[bad], "is|are not finite")
    return Check.of(rule, total + mesh.points.size, failures)


def check_points(case: HasMesh) -> Check:
    """No two points are the same, and each belongs to a cell."""
    mesh, rule = case.mesh, "points"
    order = np.lexsort(mesh.points.T[::-1])
    same = (np.diff(mesh.points[order], axis=0) == 0).all(axis=1)
    twice = np.sort(order[1:][same])
    failures = offenders(rule, "point", twice, mesh.points[twice], "is|are there twice")
    is_used = np.zeros(mesh.n_points, bool)
    for rows in mesh.cells.values():
        is_used[rows] = True
    unused = np.flatnonzero(~is_used)
    failures += offenders(rule, "point", unused, mesh.points[unused], "belongs|belong to no cell")
    return Check.of(rule, mesh.n_points, failures)

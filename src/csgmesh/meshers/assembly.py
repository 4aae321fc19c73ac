"""From the kernels' arrays to a Mesh."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh import kernels
from csgmesh.mesh import Mesh
from csgmesh.meshers.pairing import periodic_pairs

if TYPE_CHECKING:
    from csgmesh.meshers.workspace import Workspace


def assemble(work: Workspace, info: Mapping[str, object]) -> Mesh:
    """The domain's triangles, its facets, and what the domain knows about them.

    Takes the workspace apart, so that it and the mesh are never both in memory.
    """
    domain = work.domain
    source, number, cells, regions = _cells(work)
    facets = facets_of(work, number)
    markers = _point_markers(work, len(source), number)
    points = work.points[: 2 * work.n_points].reshape(-1, 2).take(source, axis=0)
    # A mesh takes over arrays that nobody can write to, and copies others.
    for array in (points, cells, regions, markers, *facets.values()):
        array.flags.writeable = False
    return Mesh(
        points=points,
        cells={"triangle": cells},
        cell_region={"triangle": regions},
        region_names=domain.region_names,
        boundary_names=domain.boundary_names,
        point_marker=markers,
        curves=domain.curves,
        periodic=periodic_pairs(work, number) if domain.periodic else (),
        domain=domain,
        info={**info, "n_points": len(points), "n_cells": len(cells)},
        **{name: {"line": array} for name, array in facets.items()},
    )


def _cells(work: Workspace) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Vertices in the mesh's order, their numbers there, and the triangles with their regions.

    The mesh has the domain's points in their order, then the others; those that no triangle uses
    are left out.
    """
    used = np.zeros(work.n_points, np.uint8)
    n_cells = kernels.mark_used(work.origin, work.twin, work.n_triangles, used)
    source = np.arange(work.n_points, dtype=np.int32)
    source[: len(work.rank)] = work.rank
    in_order = used.view(np.bool_).take(source)
    if not in_order.all():
        source = source[in_order]
    number = np.full(work.n_points, -1, np.int32)
    number[source] = np.arange(len(source), dtype=np.int32)
    cells = np.empty((n_cells, 3), np.int64)
    regions = np.empty(n_cells, np.int64)
    kernels.extract(work.origin, work.twin, work.n_triangles, number, cells.reshape(-1), regions)
    work.release()
    return source, number, cells, regions


def facets_of(work: Workspace, number: np.ndarray) -> dict[str, Any]:
    """Subsegments as facets, each with its first region on the left."""
    domain, segment = work.domain, work.segment
    ends = number.take(work.ends.reshape(-1, 2)).astype(np.int64)
    sides = domain.segment_region[segment]
    left, right = sides[:, 0], sides[:, 1]
    turned = (right >= 0) & ((left < 0) | (right < left))
    curve = domain.segment_curve[segment]
    interval = work.interval * (curve >= 0)[:, None]
    if turned.any():
        ends, sides, interval = (_swapped(pairs, turned) for pairs in (ends, sides, interval))
    found = {
        "facets": ends,
        "facet_marker": domain.segment_marker[segment],
        "facet_region": sides,
        "facet_curve": curve,
        "facet_interval": interval,
    }
    kept = (left >= 0) | (right >= 0)
    return found if kept.all() else {name: array[kept] for name, array in found.items()}


def _swapped(pairs: np.ndarray, which: np.ndarray) -> np.ndarray:
    return np.where(which[:, None], pairs[:, ::-1], pairs)


def _point_markers(work: Workspace, n_points: int, number: np.ndarray) -> np.ndarray:
    markers = np.full(n_points, -1, np.int64)
    marked = np.flatnonzero(work.domain.point_marker >= 0)
    vertex = work.rank.take(marked)
    markers[number.take(vertex)] = work.domain.point_marker[marked]
    return markers

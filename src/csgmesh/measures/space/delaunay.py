"""Exact rules about tetrahedra: orientation, and Delaunay where a mesh promised it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from csgmesh import kernels
from csgmesh.measures.results import Check, offenders

if TYPE_CHECKING:
    from csgmesh.measures.space.case import SpaceCase

#: Volumes above this share of the product of three edges need no exact test: rounding of their
#: determinant is a hundred times less.
_SURE = 1e-13


def are_oriented(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Whether tetrahedra (m, 4) have a positive volume, by an exact predicate, (m,)."""
    a, b, c, d = (points[rows[:, k]] for k in range(4))
    u, v, w = b - a, c - a, d - a
    volume = (u * np.cross(v, w)).sum(axis=1)
    size = np.sqrt((u * u).sum(axis=1) * (v * v).sum(axis=1) * (w * w).sum(axis=1))
    out = np.asarray(volume > 0.0)
    close = np.flatnonzero(~(np.abs(volume) > _SURE * size))
    if len(close):
        out[close] = kernels.tetra_orientations(points, rows[close]) > 0
    return out


def check_delaunay(case: SpaceCase) -> Check:
    """No vertex lies inside the circumsphere of a neighbour of its tetrahedron.

    Where that holds all over a mesh of a convex domain, no vertex lies inside any sphere (Delaunay
    1934). Only of meshes that promise it.
    """
    rule, mesh = "Delaunay", case.mesh
    if mesh.info.get("delaunay") is not True or set(mesh.cells) != {"tetra"}:
        return Check.skipped(rule, "not promised")
    rows, faces = mesh.cells["tetra"], case.faces
    inner = np.flatnonzero(faces.count == 2)
    behind, ahead = faces.behind[inner], faces.ahead[inner]
    apex = rows[ahead].sum(axis=1) - faces.points[inner, :3].sum(axis=1)
    bad = inner[kernels.in_spheres(mesh.points, rows[behind], apex) > 0]
    failures = offenders(rule, "face", bad, case.face_places(bad), "is|are not Delaunay")
    return Check.of(rule, len(inner), failures)

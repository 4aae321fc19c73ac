"""The worst triangles of a mesh of the plane."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.input_angles import input_angles
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.meshers.worst.lowest import JUMP, lowest, mean_edges

#: Shells reach a little beyond their radius: vertices on them are rounded.
SHELL = 1.0 + 1e-3


def worst_triangles(mesh: Mesh, count: int) -> list[dict[str, object]]:
    """See `worst_cells`."""
    cells = mesh.cells.get("triangle")
    if cells is None or not len(cells):
        raise InputError("worst_cells needs a plane mesh of triangles; this one has none")
    angle = _smallest_angles(mesh.points[cells])
    worst = lowest(angle, count)
    reasons = _reasons(mesh, cells, worst, angle[worst])
    places = mesh.points[cells[worst]].mean(axis=1)
    return [
        {"place": [float(x), float(y)], "angle": float(a), "reason": reason}
        for (x, y), a, reason in zip(places, angle[worst], reasons, strict=True)
    ]


def _smallest_angles(corners: np.ndarray) -> np.ndarray:
    """Smallest angle of each triangle, degrees."""
    angle = np.full(len(corners), np.inf)
    for i in range(3):
        u = corners[:, (i + 1) % 3] - corners[:, i]
        v = corners[:, (i + 2) % 3] - corners[:, i]
        turn = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        angle = np.minimum(angle, np.arctan2(turn, (u * v).sum(axis=1)))
    return np.degrees(angle)


def _reasons(mesh: Mesh, cells: np.ndarray, worst: np.ndarray, angle: np.ndarray) -> list[str]:
    corners = mesh.points[cells[worst]]
    sharp = np.zeros(len(worst), bool)
    if mesh.domain is not None:
        for apex, _, radius in zip(*input_angles(mesh.domain), strict=True):
            away = np.hypot(*np.moveaxis(corners - apex, -1, 0))
            sharp |= (away <= radius * SHELL).any(axis=1)
    gap = _in_a_gap(mesh, cells[worst])
    near = _around(cells, cells[worst], mesh.n_points)
    mean = mean_edges(mesh.points, near.ravel(), np.roll(near, -1, axis=1).ravel())[cells[worst]]
    jump = mean.max(axis=1) > JUMP * mean.min(axis=1)
    asked = mesh.info.get("min_angle", 0.0)
    short = angle < (float(asked) if isinstance(asked, (int, float)) else 0.0)
    found = [
        (sharp, "input angle"),
        (gap, "narrow gap"),
        (jump, "size jump"),
        (short, "budget"),
    ]
    return [
        next((reason for holds, reason in found if holds[i]), "within the bound")
        for i in range(len(worst))
    ]


def _in_a_gap(mesh: Mesh, cells: np.ndarray) -> np.ndarray:
    """Which cells span from boundary to boundary."""
    facets = np.sort(mesh.facets["line"], axis=1)
    on_boundary = np.zeros(mesh.n_points, bool)
    on_boundary[facets] = True
    ends = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2)
    across = mesh.points[ends[..., 1]] - mesh.points[ends[..., 0]]
    shortest = np.hypot(across[..., 0], across[..., 1]).argmin(axis=1)
    edge = np.sort(ends[np.arange(len(cells)), shortest], axis=1)
    key = edge[:, 0] * mesh.n_points + edge[:, 1]
    is_facet = np.isin(key, facets[:, 0] * mesh.n_points + facets[:, 1])
    return on_boundary[cells].all(axis=1) & ~is_facet


def _around(cells: np.ndarray, some: np.ndarray, n_points: int) -> np.ndarray:
    """The cells at the vertices of some."""
    touched = np.zeros(n_points, bool)
    touched[some] = True
    return cells[touched[cells].any(axis=1)]

"""Where a mesh's worst cells are, and why."""

from __future__ import annotations

from typing import Any

import numpy as np

from csgmesh.domain.input_angles import input_angles
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.options import check_whole

#: Shells reach a little beyond their radius: vertices on them are rounded.
SHELL = 1.0 + 1e-3
#: Mean edge lengths at a cell's vertices that differ by this factor make a jump in size.
JUMP = 1.8


def worst_cells(mesh: Mesh, count: int = 5) -> list[dict[str, object]]:
    """The triangles with the smallest angles, each with its place and the likely reason.

    Parameters
    ----------
    mesh : Mesh
        A mesh of a plane domain.
    count : int, default 5
        How many cells to list.

    Returns
    -------
    list of dict
        ``place`` [x, y] of the centroid, ``angle`` in degrees, and ``reason``: ``"input angle"``
        (within the protected shell of one below 60 degrees), ``"narrow gap"`` (all vertices on the
        boundary, and no facet is the shortest edge), ``"size jump"`` (mean edge lengths at the
        vertices differ by a factor of 1.8), ``"budget"`` (below the angle asked for without any of
        these: the mesher had to stop), or ``"within the bound"``. JSON-able, worst first.

    Raises
    ------
    InputError
        If this is no mesh, or one without triangles.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Triangle((0, 0), (4, 0), (4, 1)))
    >>> worst = cm.worst_cells(mesh, 1)[0]
    >>> worst["reason"], round(worst["angle"], 2)
    ('input angle', 14.04)
    """
    if not isinstance(mesh, Mesh):
        raise InputError(
            f"worst_cells needs a Mesh, as generate returns; got {type(mesh).__name__}"
        )
    cells = mesh.cells.get("triangle")
    if mesh.dim != 2 or cells is None or not len(cells):
        raise InputError("worst_cells needs a plane mesh of triangles; this one has none")
    angle = _smallest_angles(mesh.points[cells])
    worst = _lowest(angle, check_whole("count", count, 1))
    reasons = _reasons(mesh, cells, worst, angle[worst])
    places = mesh.points[cells[worst]].mean(axis=1)
    return [
        {"place": [float(x), float(y)], "angle": float(a), "reason": reason}
        for (x, y), a, reason in zip(places, angle[worst], reasons, strict=True)
    ]


def _lowest(values: np.ndarray, count: int) -> np.ndarray:
    """Where the lowest values are, in order; of equal ones the first."""
    if count >= len(values):
        return np.argsort(values, kind="stable")
    level = np.partition(values, count - 1)[count - 1]
    few = np.flatnonzero(values <= level)
    return few[np.argsort(values[few], kind="stable")][:count]


def describe(cell: dict[str, object]) -> str:
    """One of `worst_cells` as text.

    Examples
    --------
    >>> describe({"place": [0.5, 2.0], "angle": 3.1234, "reason": "narrow gap"})
    '3.12° at (0.5, 2) (narrow gap)'
    """
    place: Any = cell["place"]
    x, y = place
    return f"{cell['angle']:.3g}° at ({x:.6g}, {y:.6g}) ({cell['reason']})"


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
    mean = _mean_edges(mesh.points, _around(cells, cells[worst], mesh.n_points))[cells[worst]]
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


def _mean_edges(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Mean length of the edges at each vertex, those of two cells counted twice."""
    a, b = cells.ravel(), np.roll(cells, -1, axis=1).ravel()
    length = np.hypot(*(points[b] - points[a]).T)
    total = np.bincount(a, length, len(points)) + np.bincount(b, length, len(points))
    return total / np.maximum(np.bincount(a, None, len(points)) * 2, 1)

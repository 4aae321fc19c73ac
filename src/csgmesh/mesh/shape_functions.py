"""Shape functions of straight cells in space at given places.

A hexahedron is the trilinear image of a cube, a wedge that of a triangle times a line, a pyramid
that of a cube whose roof has shrunk to a point.
"""

from __future__ import annotations

import numpy as np

_NEWTON_STEPS = 12

#: Coordinates found must give back the place to this share of the cell's extent.
_NEAR = 1e-11

#: Where Newton's method starts.
_CENTRE = {"hexahedron": (0.5, 0.5, 0.5), "wedge": (1 / 3, 1 / 3, 0.5), "pyramid": (0.5, 0.5, 0.25)}


def weights_in_tetrahedra(corners: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Barycentric coordinates of places (m, 3) in tetrahedra (m, 4, 3), (m, 4).

    Examples
    --------
    >>> corners = np.array([[(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]])
    >>> weights_in_tetrahedra(corners, np.array([[0.25, 0.125, 0.125]])).tolist()
    [[0.5, 0.25, 0.125, 0.125]]
    """
    a, b, c, d = (corners[:, k] - places for k in range(4))
    parts = np.stack(
        [_triple(b, d, c), _triple(a, c, d), _triple(a, d, b), _triple(a, b, c)], axis=1
    )
    return np.asarray(parts / parts.sum(axis=1, keepdims=True))


def weights_in_cells(
    kind: str, corners: np.ndarray, places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Weights of the corners of cells (m, k, 3) at places (m, 3), by Newton's method.

    Returns
    -------
    weights : (m, k) float64
    fits : (m,) bool
        Whether they give back the place; not so outside the cell, by however little.

    Examples
    --------
    >>> cube = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1),
    ...                  (1, 1, 1), (0, 1, 1)], float)
    >>> weights, fits = weights_in_cells("hexahedron", cube[None], np.array([[0.5, 0.5, 0.0]]))
    >>> weights.tolist(), fits
    ([[0.25, 0.25, 0.25, 0.25, 0.0, 0.0, 0.0, 0.0]], array([ True]))
    """
    local = corners - places[:, None]
    at = np.tile(_CENTRE[kind], (len(corners), 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(_NEWTON_STEPS):
            value, slopes = _shapes(kind, at)
            rest = np.einsum("mk,mkj->mj", value, local)
            du, dv, dw = (np.einsum("mk,mkj->mj", slope, local) for slope in slopes)
            step = [_triple(rest, dv, dw), _triple(du, rest, dw), _triple(du, dv, rest)]
            at = np.clip(at - np.stack(step, axis=1) / _triple(du, dv, dw)[:, None], 0.0, 1.0)
        value, _ = _shapes(kind, at)
        rest = np.abs(np.einsum("mk,mkj->mj", value, local)).max(axis=1, initial=0.0)
        extent = np.ptp(corners, axis=1).max(axis=1, initial=0.0)
    return value, (rest <= _NEAR * extent) & (value >= 0.0).all(axis=1)


def _shapes(kind: str, at: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Shape functions (m, k), and their slopes in each of the three directions."""
    u, v, w = at.T[:, :, None]
    if kind == "wedge":
        floor = np.concatenate([1 - u - v, u, v], axis=1)
        along = [np.broadcast_to(row, floor.shape) for row in ([-1.0, 1, 0], [-1.0, 0, 1])]
    else:
        floor = np.concatenate([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
        along = [
            np.concatenate([v - 1, 1 - v, v, -v], axis=1),
            np.concatenate([u - 1, -u, u, 1 - u], axis=1),
        ]
    # The roof of a pyramid is its apex, whatever u and v.
    roof, rising = (
        (np.ones_like(u), [np.zeros_like(u)] * 2) if kind == "pyramid" else (floor, along)
    )
    slopes = [np.hstack([(1 - w) * a, w * b]) for a, b in zip(along, rising, strict=True)]
    return np.hstack([(1 - w) * floor, w * roof]), [*slopes, np.hstack([-floor, roof])]


def _triple(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    return np.asarray((a * np.cross(b, c)).sum(axis=1))

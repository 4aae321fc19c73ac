"""Jacobians over whole cells in space: bounds that hold everywhere, not at corners alone.

The determinant of the map of a straight-edged cell is a polynomial in its reference coordinates:
constant on tetrahedra, of degree 2 along each direction of hexahedra and wedges; on pyramids, less
a factor that vanishes at the apex only, of degree 2 across the base. In Bernstein form its
coefficients bound it (Johnen, Remacle, Geuzaine 2013).
"""

from __future__ import annotations

import numpy as np

#: Halvings of a cell after which a bound that is still undecided counts as broken.
_DEEPEST = 5

#: From values at 0, 1/2, 1 to coefficients of degree 2.
_TO_BERNSTEIN = np.array([(1.0, 0.0, 0.0), (-0.5, 2.0, -0.5), (0.0, 0.0, 1.0)])

_CORNERS = {
    "hexahedron": np.array(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        float,
    ),
    "wedge": np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], float),
}


def least_jacobians(points: np.ndarray, kind: str, cells: np.ndarray) -> np.ndarray:
    """A lower bound of each cell's Jacobian determinant, above zero where the cell is valid.

    Parameters
    ----------
    points : (n, 3) float64
    kind : str
        ``tetra``, ``hexahedron``, ``wedge`` or ``pyramid``.
    cells : (m, k) int64
        Corners.

    Returns
    -------
    (m,) float64
        The exact minimum for tetrahedra; for other kinds a lower bound that is positive if the
        minimum is above a small share of the largest value, and a value found if it is not
        positive.

    Examples
    --------
    >>> corners = _CORNERS["hexahedron"] * 2.0
    >>> least_jacobians(corners, "hexahedron", np.arange(8)[None])
    array([8.])
    """
    shape = points[cells]
    if kind == "tetra":
        a, b, c = (shape[:, k] - shape[:, 0] for k in (1, 2, 3))
        return (a * np.cross(b, c)).sum(axis=1)
    low, high = np.zeros((len(cells), 3)), np.ones((len(cells), 3))
    out = np.full(len(cells), np.inf)
    owner = np.arange(len(cells))
    for depth in range(_DEEPEST + 1):
        value, bound = _bounds(kind, shape[owner], low, high)
        least = bound.min(axis=1)
        found = value.min(axis=1)
        settled = (least > 0.0) | (found <= 0.0) | (depth == _DEEPEST)
        np.minimum.at(out, owner[settled], np.where(found <= 0.0, found, least)[settled])
        if settled.all():
            break
        owner, low, high = _halved(owner[~settled], low[~settled], high[~settled])
    return out


def _halved(
    owner: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All eight parts of boxes in reference coordinates."""
    middle = 0.5 * (low + high)
    choice = np.indices((2, 2, 2)).reshape(3, 8).T
    lows = np.where(choice[None] == 0, low[:, None], middle[:, None]).reshape(-1, 3)
    highs = np.where(choice[None] == 0, middle[:, None], high[:, None]).reshape(-1, 3)
    return np.repeat(owner, 8), lows, highs


def _bounds(
    kind: str, shape: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values on a grid of each box in reference coordinates, and Bernstein coefficients."""
    grid = np.stack(np.meshgrid(*[(0.0, 0.5, 1.0)] * 3, indexing="ij"), axis=3).reshape(-1, 3)
    at = low[:, None] + (high - low)[:, None] * grid
    value = _determinant(kind, shape, at).reshape(len(shape), 3, 3, 3)
    bound = np.einsum("ai,bj,ck,mijk->mabc", *[_TO_BERNSTEIN] * 3, value)
    return value.reshape(len(shape), -1), bound.reshape(len(shape), -1)


def _determinant(kind: str, shape: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Determinants of cells (m, k, 3) at reference points (m, q, 3), (m, q).

    A wedge's triangle is covered by the square of collapsed coordinates (u, v (1 - u)); its map
    stays of degree 2 there. A pyramid's factor is left out.
    """
    u, v, w = (at[:, :, k, None] for k in range(3))
    corner = [shape[:, None, k] for k in range(shape.shape[1])]
    if kind == "hexahedron":
        floor = _bilinear(corner[:4], u, v)
        roof = _bilinear(corner[4:], u, v)
        du = (1 - w) * floor[1] + w * roof[1]
        dv = (1 - w) * floor[2] + w * roof[2]
        dw = roof[0] - floor[0]
    elif kind == "wedge":
        v = v * (1 - u)
        du = (1 - w) * (corner[1] - corner[0]) + w * (corner[4] - corner[3])
        dv = (1 - w) * (corner[2] - corner[0]) + w * (corner[5] - corner[3])
        rise = [corner[k + 3] - corner[k] for k in range(3)]
        dw = (1 - u - v) * rise[0] + u * rise[1] + v * rise[2]
    else:
        base = _bilinear(corner[:4], u, v)
        du, dv, dw = base[1], base[2], corner[4] - base[0]
    return (du * np.cross(dv, dw)).sum(axis=2)


def _bilinear(
    corner: list[np.ndarray], u: np.ndarray, v: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A bilinear patch and its derivatives."""
    a, b, c, d = corner
    place = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    return place, (1 - v) * (b - a) + v * (c - d), (1 - u) * (d - a) + u * (c - b)

"""Triangles split at points on their edges or inside them, the same way from both sides."""

from __future__ import annotations

import numpy as np

#: Rows of triangles, and the corners of those that take their place.
_Split = tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray, np.ndarray]]]


def halved(
    points: np.ndarray,
    triangles: np.ndarray,
    edge: np.ndarray,
    vertex: np.ndarray,
    facet: np.ndarray,
    inner: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Split all triangles around each edge at its vertex, and triangles at points inside them.

    Parameters
    ----------
    points : (n', 3) float64
    triangles : (m, 3) int64
    edge : (k, 2) int64
        Lower and higher point of each, in increasing order.
    vertex : (k,) int64
        The vertex that splits each edge.
    facet, inner : (l,) int64
        Triangles and vertices inside them, of use where no edge of the triangle is split.

    Returns
    -------
    triangles : (m', 3) int64
        Those that were not split first. May have a vertex twice.
    parent : (m',) int64

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]])
    >>> two = np.array([[0, 1, 2], [0, 2, 3]])
    >>> none = np.zeros(0, int)
    >>> halved(square, two, np.array([[0, 2]]), np.array([4]), none, none)[0].tolist()
    [[4, 0, 1], [4, 1, 2], [4, 2, 3], [4, 3, 0]]
    """
    middle = _middles(triangles, edge, vertex, len(points))
    count = (middle >= 0).sum(axis=1)
    at_point = np.full(len(triangles), -1)
    at_point[facet] = inner
    at_point[count > 0] = -1
    rows = np.flatnonzero((count == 0) & (at_point < 0))
    parts, parents = [triangles[rows]], [rows]
    rows = np.flatnonzero(at_point >= 0)
    (a, b, c), p = triangles[rows].T, at_point[rows]
    split = [(rows, [(a, b, p), (b, c, p), (c, a, p)])]
    # Turned so that the edge that is split alone, or not split alone, comes last.
    rows = np.flatnonzero(count == 1)
    (a, b, c), (_, _, p) = _turned(triangles, middle, rows, middle[rows] >= 0)
    split.append((rows, [(p, a, b), (p, b, c)]))
    rows = np.flatnonzero(count == 2)
    split += _at_two_edges(points, rows, *_turned(triangles, middle, rows, middle[rows] < 0))
    rows = np.flatnonzero(count == 3)
    (a, b, c), (p, q, r) = triangles[rows].T, middle[rows].T
    split.append((rows, [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]))
    for rows, corners in split:
        parts.append(np.stack([np.column_stack(c) for c in corners], axis=1).reshape(-1, 3))
        parents.append(np.repeat(rows, len(corners)))
    return np.concatenate(parts), np.concatenate(parents)


def _at_two_edges(
    points: np.ndarray, rows: np.ndarray, corners: np.ndarray, middles: np.ndarray
) -> list[_Split]:
    """Triangles whose last edge alone is whole: a corner, and two along the shorter diagonal."""
    (a, b, c), (p, q, _) = corners, middles
    short = _nearer(points, (a, q), (p, c))
    out: list[_Split] = [(rows, [(p, b, q)])]
    for chosen, pair in ((short, [(a, p, q), (a, q, c)]), (~short, [(a, p, c), (p, q, c)])):
        out.append((rows[chosen], [(x[chosen], y[chosen], z[chosen]) for x, y, z in pair]))
    return out


def _middles(triangles: np.ndarray, edge: np.ndarray, vertex: np.ndarray, n: int) -> np.ndarray:
    """Vertices that split the edges of each triangle, -1 for none, (m, 3)."""
    if not len(edge):
        return np.full(triangles.shape, -1)
    head = np.roll(triangles, -1, axis=1)
    edge = edge[:, 0] * n + edge[:, 1]
    key = np.minimum(triangles, head) * n + np.maximum(triangles, head)
    at = np.minimum(np.searchsorted(edge, key), len(edge) - 1)
    return np.where(edge[at] == key, vertex[at], -1)


def _turned(
    triangles: np.ndarray, middle: np.ndarray, rows: np.ndarray, special: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Corners and edges' vertices of triangles, turned so that the special edge is the last."""
    turn = (np.argmax(special, axis=1)[:, None] + np.arange(1, 4)) % 3
    return (
        np.take_along_axis(triangles[rows], turn, axis=1).T,
        np.take_along_axis(middle[rows], turn, axis=1).T,
    )


def _nearer(
    points: np.ndarray, one: tuple[np.ndarray, np.ndarray], two: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Whether the first diagonal is shorter, ties by the lower number, from whichever side."""
    first, second = (((points[x] - points[y]) ** 2).sum(axis=1) for x, y in (one, two))
    close = np.abs(first - second) <= 1e-9 * (first + second)
    lower = np.minimum(*one) < np.minimum(*two)
    return np.where(close, lower, first < second)

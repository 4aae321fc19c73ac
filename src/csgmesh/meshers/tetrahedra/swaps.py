"""Swaps on the surface: of two diagonals of neighbouring triangles, the tetrahedra's wins."""

from __future__ import annotations

import numpy as np

from csgmesh.meshers.tetrahedra.net import Net

#: Cosine between the normals of two triangles and those of their swap, above which the surface is
#: flat enough there for either diagonal.
_FLAT = 0.8
#: Rounds of swaps. Each takes one of a triangle's edges, so a fan of long ones takes several.
_ROUNDS = 60
#: Cotangents of the two angles opposite to an edge add up to less than this where the other
#: diagonal is better by more than rounding.
_BETTER = -1e-9


def swap_missing(
    net: Net, points: np.ndarray, triangles: np.ndarray, face: np.ndarray, fixed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Swap edges of the surface where that makes faces of more triangles.

    Missing triangles are also made Delaunay in their face, for only such can be found.

    Parameters
    ----------
    net : Net
    points : (n, 3) float64
    triangles : (m, 3) int64
    face : (m,) int64
        No edge between two faces is swapped.
    fixed : (k, 2) int64
        Nor any of these.

    Returns
    -------
    triangles : (m, 3) int64
    found : (m,) int64
        Face of the net each triangle is, -1 if it is none.
    """
    triangles = triangles.copy()
    found = net.faces(triangles)
    for _ in range(_ROUNDS):
        if (found >= 0).all():
            break
        # All that shares an edge with a missing triangle has two of the missing ones' corners.
        at_missing = np.zeros(len(points), bool)
        at_missing[triangles[found < 0]] = True
        some = np.flatnonzero(at_missing[triangles].sum(axis=1) >= 2)
        rows, swapped = candidates(points, triangles[some], face[some], fixed, found[some] < 0)
        rows = some[rows]
        there = net.faces(swapped.reshape(-1, 3)).reshape(-1, 2)
        gain = (there >= 0).sum(axis=1) - (found[rows] >= 0).sum(axis=1)
        worth = np.where(gain == 0, 0.5 * is_better(points, swapped), gain)
        order = np.argsort(-worth, kind="stable")
        order = order[worth[order] > 0]
        if not len(order):
            break
        chosen = order[apart(rows[order], len(triangles))]
        triangles[rows[chosen]] = swapped[chosen]
        found[rows[chosen]] = there[chosen]
    return triangles, found


def candidates(
    points: np.ndarray,
    triangles: np.ndarray,
    face: np.ndarray,
    fixed: np.ndarray,
    wanted: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of triangles (k, 2), one of them `wanted`, and what they become (k, 2, 3)."""
    n = len(points)
    tail, head = triangles[:, [1, 2, 0]], triangles[:, [2, 0, 1]]
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    key = (low * n + high).reshape(-1)
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    start = np.flatnonzero(np.diff(ordered, prepend=-1))
    count = np.diff(start, append=len(ordered))
    start = start[count == 2]
    one, two = order[start], order[start + 1]
    t, u = one // 3, two // 3
    is_free = (face[t] == face[u]) & (wanted[t] | wanted[u])
    edges = np.sort(fixed, axis=1)
    is_free &= ~np.isin(key[one], edges[:, 0] * n + edges[:, 1])
    one, two, t, u = one[is_free], two[is_free], t[is_free], u[is_free]
    c, d = triangles[t, one % 3], triangles[u, two % 3]
    a, b = tail.reshape(-1)[one], head.reshape(-1)[one]
    # The triangles are (c, a, b) and (d, b, a); they become (c, a, d) and (d, b, c).
    swapped = np.stack([np.column_stack([c, a, d]), np.column_stack([d, b, c])], axis=1)
    old, new = normals(points, triangles[np.stack([t, u], axis=1)]), normals(points, swapped)
    is_flat = (old[:, 0] * old[:, 1]).sum(axis=1) > _FLAT
    for i in range(2):
        for j in range(2):
            is_flat &= (old[:, i] * new[:, j]).sum(axis=1) > _FLAT
    return np.stack([t, u], axis=1)[is_flat], swapped[is_flat]


def is_better(points: np.ndarray, swapped: np.ndarray) -> np.ndarray:
    """Whether pairs of triangles (k, 2, 3) from `candidates` are Delaunay, and were not, (k,)."""
    c, a, d = (points[swapped[:, 0, k]] for k in range(3))
    b = points[swapped[:, 1, 1]]
    return np.asarray(_cotangent(a - c, b - c) + _cotangent(a - d, b - d) < _BETTER)


def _cotangent(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    sine = np.sqrt((np.cross(u, v) ** 2).sum(axis=1))
    return np.asarray((u * v).sum(axis=1) / np.where(sine > 0.0, sine, 1.0))


def normals(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit normals of triangles (..., 3), zero where there is none."""
    a, b, c = (points[triangles[..., k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.sqrt((normal * normal).sum(axis=-1, keepdims=True))
    return np.asarray(normal / np.where(length > 0.0, length, 1.0))


def apart(rows: np.ndarray, n: int) -> np.ndarray:
    """Of pairs (k, 2) in order of preference, those without a triangle of an earlier one."""
    first = np.full(n, len(rows))
    number = np.arange(len(rows))
    np.minimum.at(first, rows.reshape(-1), np.repeat(number, 2))
    return np.asarray((first[rows] == number[:, None]).all(axis=1))

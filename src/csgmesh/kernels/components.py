"""Which parts of a domain hang together, by union-find (Tarjan 1975) over vertices."""

from __future__ import annotations

from numba import njit

from .pointers import ENTRY, HELPER, pointer


@njit(**HELPER)
def root(parent, v):
    """The vertex that stands for all that v is joined to; halves the path there."""
    while parent[v] != v:
        parent[v] = parent[parent[v]]
        v = parent[v]
    return v


@njit(**HELPER)
def join(parent, a, b):
    a = root(parent, a)
    b = root(parent, b)
    if a < b:
        parent[b] = a
    else:
        parent[a] = b


@njit(**ENTRY)
def count_outer(points, segments, sides, parents, leftmost, uppermost):
    """Number of groups of connected segments with no region around them.

    `parents` (n,) comes as 0 … n - 1 and goes as a union-find forest; `leftmost` and `uppermost`
    (n,) come as -1. The half-edge that leaves a group's leftmost vertex most steeply upwards
    has the group's surroundings on its left.
    """
    xy = pointer(points)
    end = pointer(segments)
    side = pointer(sides)
    parent = pointer(parents)
    left = pointer(leftmost)
    up = pointer(uppermost)
    n_half = segments.shape[0]
    for k in range(0, n_half, 2):
        join(parent, end[k], end[k + 1])
    for h in range(n_half):
        v = end[h]
        r = root(parent, v)
        w = left[r] if left[r] >= 0 else v
        dx = xy[2 * v] - xy[2 * w]
        if left[r] < 0 or dx < 0.0 or (dx == 0.0 and xy[2 * v + 1] < xy[2 * w + 1]):
            left[r] = v
    for h in range(n_half):
        v = end[h]
        r = root(parent, v)
        if left[r] == v:
            g = up[r]
            if g < 0:
                up[r] = h
            else:
                o = end[h ^ 1]
                w = end[g ^ 1]
                dx = xy[2 * o] - xy[2 * v]
                dy = xy[2 * o + 1] - xy[2 * v + 1]
                ex = xy[2 * w] - xy[2 * v]
                ey = xy[2 * w + 1] - xy[2 * v + 1]
                if ex * dy > ey * dx:
                    up[r] = h
    n = 0
    for r in range(parents.shape[0]):
        if up[r] >= 0 and side[up[r]] < 0:
            n += 1
    return n


@njit(**ENTRY)
def join_triangles(origin, twin, n_triangles, parents):
    """Join the vertices of each triangle with a region; parents[v] is then the least of v's."""
    here = pointer(origin)
    there = pointer(twin)
    parent = pointer(parents)
    for t in range(0, 4 * n_triangles, 4):
        if there[t + 3] >= 0:
            join(parent, here[t], here[t + 1])
            join(parent, here[t], here[t + 2])
    for v in range(parents.shape[0]):
        parent[v] = root(parent, v)

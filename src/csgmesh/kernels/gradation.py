"""Limit the growth of sizes given at vertices along the edges of the triangulation."""

from __future__ import annotations

from math import hypot

from numba import njit

from .pointers import ENTRY, HELPER, pointer

#: A value that would sink by less than this share is left alone.
WORTH = 1e-3


@njit(**HELPER)
def relax(xy, origin, size, t, growth):
    """Lower the sizes of triangle t's vertices where another vertex forces it; how many sank."""
    sunk = 0
    for e in range(3):
        u = origin[t + e]
        v = origin[t + (e + 1 if e < 2 else 0)]
        reach = growth * hypot(xy[2 * u] - xy[2 * v], xy[2 * u + 1] - xy[2 * v + 1])
        if size[u] + reach < size[v] * (1.0 - WORTH):
            size[v] = size[u] + reach
            sunk += 1
        elif size[v] + reach < size[u] * (1.0 - WORTH):
            size[u] = size[v] + reach
            sunk += 1
    return sunk


@njit(**ENTRY)
def limit_gradation(points, origin, twin, n_triangles, sizes, growth):
    """Sweep over the domain's triangles forth and back; returns how many values sank."""
    xy = pointer(points)
    here = pointer(origin)
    there = pointer(twin)
    size = pointer(sizes)
    sunk = 0
    for i in range(2 * n_triangles):
        t = 4 * i if i < n_triangles else 4 * (2 * n_triangles - 1 - i)
        if there[t + 3] >= 0:
            sunk += relax(xy, here, size, t, growth)
    return sunk


@njit(**ENTRY)
def expected_points(points, origin, twin, n_triangles, sizes, per_area):
    """Integral of per_area / h² over the domain: how many points its sizes ask for."""
    xy = pointer(points)
    here = pointer(origin)
    there = pointer(twin)
    size = pointer(sizes)
    total = 0.0
    for t in range(0, 4 * n_triangles, 4):
        if there[t + 3] >= 0:
            a = here[t]
            b = here[t + 1]
            c = here[t + 2]
            area = (xy[2 * b] - xy[2 * a]) * (xy[2 * c + 1] - xy[2 * a + 1])
            area -= (xy[2 * b + 1] - xy[2 * a + 1]) * (xy[2 * c] - xy[2 * a])
            h = (size[a] + size[b] + size[c]) / 3.0
            total += 0.5 * area * per_area / (h * h)
    return total

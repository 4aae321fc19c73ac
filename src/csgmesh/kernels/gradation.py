"""Limit the growth of sizes given at vertices along the edges of the triangulation."""

from __future__ import annotations

from math import sqrt

from numba import njit

from .pointers import ENTRY, HELPER, pointer
from .triangulation import following, preceding

#: A value that would sink by less than this share is left alone.
WORTH = 1e-3
#: Mean distance of a triangle's points from its nearest vertex, per square root of twice its area.
BETWEEN = 0.4


@njit(**HELPER)
def put(v, queue, queued, state, n):
    """Put vertex v at the end of the ring of n places, unless it waits there already."""
    if queued[v] == 0:
        queued[v] = 1
        queue[state[1]] = v
        state[1] = state[1] + 1 if state[1] + 1 < n else 0
        state[2] = state[2] + 1


@njit(**HELPER)
def lower(xy, size, u, v, growth):
    """Lower the size at v if u forces it; whether it did."""
    excess = size[v] * (1.0 - WORTH) - size[u]
    if excess <= 0.0:
        return False
    dx = xy[2 * u] - xy[2 * v]
    dy = xy[2 * u + 1] - xy[2 * v + 1]
    square = growth * growth * (dx * dx + dy * dy)
    if excess * excess <= square:
        return False
    size[v] = size[u] + sqrt(square)
    return True


@njit(**HELPER)
def find_sources(xy, origin, twin, n_triangles, size, growth, queue, queued, state, n):
    """Lower what another vertex of the same triangle forces down, and queue it."""
    for t in range(0, 4 * n_triangles, 4):
        if twin[t + 3] >= 0:
            for e in range(3):
                u = origin[t + e]
                v = origin[t + (e + 1 if e < 2 else 0)]
                if lower(xy, size, u, v, growth):
                    put(v, queue, queued, state, n)
                elif lower(xy, size, v, u, growth):
                    put(u, queue, queued, state, n)


@njit(**HELPER)
def spread(xy, origin, twin, size, v, growth, edge_of, queue, queued, state, n):
    """Look at the neighbours of v along the edges of the domain."""
    h = edge_of[v]
    first = h
    while True:
        o = twin[h]
        u = origin[following(h)]
        if u >= 0 and (twin[h | 3] >= 0 or twin[o | 3] >= 0) and lower(xy, size, v, u, growth):
            put(u, queue, queued, state, n)
        h = twin[preceding(h)]
        if h == first:
            break


@njit(**ENTRY)
def limit_gradation(points, origin, twin, n_triangles, sizes, growth, edges, queues, flags, ends):
    """Lower sizes until none exceeds a neighbour's by more than growth times their distance.

    From every vertex whose size sank its neighbours are looked at again, first come first served.
    edges, queues, flags: scratch with one entry a vertex, flags 0; ends: three zeros.
    """
    xy = pointer(points)
    here = pointer(origin)
    there = pointer(twin)
    size = pointer(sizes)
    edge_of = pointer(edges)
    queue = pointer(queues)
    queued = pointer(flags)
    state = pointer(ends)
    n = queues.shape[0]
    for t in range(0, 4 * n_triangles, 4):
        if there[t + 3] >= 0:
            for e in range(3):
                edge_of[here[t + e]] = t + e
    find_sources(xy, here, there, n_triangles, size, growth, queue, queued, state, n)
    while state[2] > 0:
        state[2] = state[2] - 1
        v = queue[state[0]]
        state[0] = state[0] + 1 if state[0] + 1 < n else 0
        queued[v] = 0
        spread(xy, here, there, size, v, growth, edge_of, queue, queued, state, n)


@njit(**ENTRY)
def expected_points(points, origin, twin, n_triangles, sizes, growth, per_area):
    """Integral of per_area / h² over the domain: how many points its sizes ask for at least.

    Between vertices that are far from one another sizes may be as large as the growth allows.
    """
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
            h = (size[a] + size[b] + size[c]) / 3.0 + growth * BETWEEN * sqrt(max(area, 0.0))
            total += 0.5 * area * per_area / (h * h)
    return total

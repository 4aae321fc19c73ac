"""Plan to put a vertex in where nothing else helps, or to take one out."""

from __future__ import annotations

from numba import njit

from ..pointers import HELPER
from .cells import (
    C_CLOSED,
    C_COME,
    C_GONE,
    C_OLD,
    C_RING,
    C_VERTEX_ROOM,
    C_VERTICES,
    FREE,
    FROZEN,
    GAIN,
    gather_ring,
    gather_star,
    is_better,
    place_in,
)
from .climbing import ANYWHERE, climb, worst_at
from .shapes import shape_of


@njit(**HELPER)
def contraction(view, u, v):
    """Plan to draw u to v; the worst shape around it then, or 0 if that is no gain.

    Returns the number of new cells as well.
    """
    n = gather_star(view, u)
    if n < 0:
        return 0.0, -1
    old = 2.0
    for k in range(n):
        old = min(old, view.score[view.star[k]])
    new = 2.0
    m = 0
    for k in range(n):
        t = view.star[k]
        view.slot[k] = t
        if place_in(view, t, v) < 4:
            continue
        at = 4 * m
        for i in range(4):
            w = view.corner[4 * t + i]
            view.fresh[at + i] = v if w == u else w
        view.fresh_region[m] = view.region[t]
        m += 1
        new = min(
            new,
            shape_of(
                view.xyz,
                view.fresh[at],
                view.fresh[at + 1],
                view.fresh[at + 2],
                view.fresh[at + 3],
            ),
        )
        if not is_better(new, old):
            return 0.0, -1
    view.count[C_GONE] = u
    view.count[C_OLD] = n
    return new, m


@njit(**HELPER)
def plan_contraction(view, t):
    """Plan to draw a free corner of cell t to where that helps most; cells then, or -1."""
    best = 0.0
    what = -1
    m = -1
    for k in range(17):
        if k == 16:
            k = what
            if what < 0:
                return -1
        u = view.corner[4 * t + (k >> 2)]
        v = view.corner[4 * t + (k & 3)]
        if u == v or view.kind[u] != FREE or view.kind[v] == FROZEN:
            continue
        value, m = contraction(view, u, v)
        if value > best:
            best = value
            what = k
    return m


@njit(**HELPER)
def outer_triangles(view, n, a, b):
    """Copy the triangles opposite a or b of n cells at that edge to `link`, `fresh`; how many."""
    m = 0
    for k in range(n):
        t = view.slot[k]
        for f in range(4):
            v = view.corner[4 * t + f]
            if v != a and v != b:
                continue
            view.fresh_region[m] = view.region[t]
            for e in range(3):
                u = view.corner[4 * t + (f ^ (e + 1))]
                view.fresh[4 * m + e + 1] = u
                for c in range(3):
                    view.link[9 * m + 3 * e + c] = view.xyz[3 * u + c]
            m += 1
    return m


@njit(**HELPER)
def divide_edge(view, t, i, j):
    """Plan to put a vertex on edge i, j of cell t and where it serves best; cells then, or -1."""
    a = view.corner[4 * t + i]
    b = view.corner[4 * t + j]
    if view.kind[a] == FROZEN and view.kind[b] == FROZEN:
        return -1
    n = gather_ring(view, t, a, b)
    if n < 0 or view.count[C_CLOSED] == 0:
        return -1
    old = 2.0
    for k in range(view.count[C_RING]):
        if view.spoke[k] >= 0:
            return -1
        view.slot[k] = view.ring_cell[k]
        old = min(old, view.score[view.ring_cell[k]])
    m = outer_triangles(view, n, a, b)
    for c in range(3):
        view.place[c] = 0.5 * (view.xyz[3 * a + c] + view.xyz[3 * b + c])
    now = worst_at(view, m, view.place[0], view.place[1], view.place[2], -2.0)
    now = climb(view, m, now, ANYWHERE)
    if not is_better(now, old * GAIN):
        return -1
    v = view.count[C_VERTICES]
    for k in range(m):
        view.fresh[4 * k] = v
    for c in range(3):
        view.xyz[3 * v + c] = view.place[c]
    view.count[C_COME] = v
    view.count[C_OLD] = n
    return m


@njit(**HELPER)
def plan_insertion(view, t):
    """Plan to divide an edge of cell t by a new vertex; how many cells there will be, or -1."""
    if view.count[C_VERTICES] == view.count[C_VERTEX_ROOM]:
        return -1
    for k in range(16):
        if k >> 2 < k & 3:
            m = divide_edge(view, t, k >> 2, k & 3)
            if m >= 0:
                return m
    return -1

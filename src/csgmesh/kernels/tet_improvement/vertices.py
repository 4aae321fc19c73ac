"""Move vertices: free ones here, those of the surface by a wish that is put on the surface."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import HELPER
from .cells import C_CLOCK, C_WISHES, FREE, N_GOAL, ON_CURVE, gather_star, is_better
from .climbing import ANYWHERE, IN_PLANE, ON_LINE, climb, link_of, worst_at
from .shapes import shape_over


@njit(**HELPER)
def move_to(view, v, n, x, y, z):
    """Put v, whose star of n cells is listed, elsewhere."""
    view.xyz[3 * v] = x
    view.xyz[3 * v + 1] = y
    view.xyz[3 * v + 2] = z
    for k in range(n):
        t = view.star[k]
        view.score[t] = shape_over(view.link, k, x, y, z)
        for f in range(4 * t, 4 * t + 4):
            view.changed[view.corner[f]] = view.count[C_CLOCK]


@njit(**HELPER)
def start_at(view, v):
    for c in range(3):
        view.place[c] = view.xyz[3 * v + c]


@njit(**HELPER)
def smooth(view, v):
    """Move a free vertex to a better place; whether there was one."""
    if view.kind[v] != FREE:
        return False
    n = gather_star(view, v)
    if n < 0:
        return False
    now = link_of(view, v, n)
    if now > view.number[N_GOAL]:
        return False
    start_at(view, v)
    if not is_better(climb(view, n, now, ANYWHERE), now):
        return False
    move_to(view, v, n, view.place[0], view.place[1], view.place[2])
    return True


@njit(**HELPER)
def find_normal(view, v, n):
    """Write the exact normal at v, from a surface triangle of its star, to place[3:6]."""
    for k in range(n):
        t = view.star[k]
        for f in range(4 * t, 4 * t + 4):
            w = view.wall[f]
            if w < 0 or view.corner[f] == v:
                continue
            at = 3 * w
            while view.triangle[at] != v:
                at += 1
            for c in range(3):
                view.place[3 + c] = view.normal[3 * at + c]
            return True
    return False


@njit(**HELPER)
def find_tangent(view, v):
    """Write the direction between the neighbours of v along its curve to place[3:6]."""
    first = view.segment_begin[v]
    if view.segment_begin[v + 1] - first != 2:
        return False
    a = 3 * view.segment[first]
    b = 3 * view.segment[first + 1]
    x = view.xyz[b] - view.xyz[a]
    y = view.xyz[b + 1] - view.xyz[a + 1]
    z = view.xyz[b + 2] - view.xyz[a + 2]
    size = sqrt(x * x + y * y + z * z)
    if size == 0.0:
        return False
    view.place[3] = x / size
    view.place[4] = y / size
    view.place[5] = z / size
    return True


@njit(**HELPER)
def wish(view, v, busy):
    """Note where a vertex of the surface had better be, unless a neighbour on it has a wish.

    `busy`, a mark a vertex, keeps the wishes of one round independent.
    """
    if busy[v] != 0:
        return False
    n = gather_star(view, v)
    if n < 0:
        return False
    now = link_of(view, v, n)
    if now > view.number[N_GOAL]:
        return False
    start_at(view, v)
    mode = IN_PLANE
    if view.kind[v] == ON_CURVE:
        mode = ON_LINE
        if not find_tangent(view, v):
            return False
    elif not find_normal(view, v, n):
        return False
    busy[v] = 1
    if not is_better(climb(view, n, now, mode), now):
        return False
    k = view.count[C_WISHES]
    view.count[C_WISHES] = k + 1
    view.wish[k] = v
    for c in range(3):
        view.moves[3 * k + c] = view.place[c]
    for i in range(n):
        t = view.star[i]
        for f in range(4 * t, 4 * t + 4):
            busy[view.corner[f]] = 1
    return True


@njit(**HELPER)
def grant(view, k):
    """Move the vertex of wish k to its place on the surface, if that is still a gain."""
    v = view.wish[k]
    n = gather_star(view, v)
    now = link_of(view, v, n)
    x = view.moves[3 * k]
    y = view.moves[3 * k + 1]
    z = view.moves[3 * k + 2]
    if not is_better(worst_at(view, n, x, y, z, now), now):
        return False
    move_to(view, v, n, x, y, z)
    return True

"""Take cells out of a piece and put others into the same place."""

from __future__ import annotations

from numba import njit

from ..pointers import HELPER
from .cells import (
    C_CLOCK,
    C_EDGE,
    C_FREE,
    C_NEW_WALL,
    C_OLD,
    C_ROOM,
    C_STAMP,
    C_TOP,
    place_in,
)
from .shapes import shape_of

#: Entries of a face in the list of those that wait for their other side.
ENTRY_WIDTH = 5


@njit(**HELPER)
def new_plan(view):
    """Begin a plan that leaves the surface and all vertices where they are."""
    for k in range(C_EDGE, C_OLD):
        view.count[k] = -1


@njit(**HELPER)
def set_new_wall(view, at, a, b, c, wall):
    """Say that face a, b, c becomes a wall, at one of two places in `count`."""
    view.count[at] = min(a, min(b, c))
    view.count[at + 1] = a + b + c - min(a, min(b, c)) - max(a, max(b, c))
    view.count[at + 2] = max(a, max(b, c))
    view.count[at + 3] = wall


@njit(**HELPER)
def new_wall(view, low, middle, high):
    """The new wall on a face, -1 for none."""
    for at in range(C_NEW_WALL, C_NEW_WALL + 8, 4):
        if view.count[at] == low and view.count[at + 1] == middle and view.count[at + 2] == high:
            return view.count[at + 3]
    return -1


@njit(**HELPER)
def write_entry(view, m, h, outer, wall):
    """Write the corners of face h, sorted, and what lies beyond it, as entry m."""
    t4 = h & ~3
    a = view.corner[t4 + ((h & 3) ^ 1)]
    b = view.corner[t4 + ((h & 3) ^ 2)]
    c = view.corner[t4 + ((h & 3) ^ 3)]
    low = min(a, min(b, c))
    high = max(a, max(b, c))
    at = ENTRY_WIDTH * m
    view.border[at] = low
    view.border[at + 1] = a + b + c - low - high
    view.border[at + 2] = high
    view.border[at + 3] = outer
    view.border[at + 4] = wall


@njit(**HELPER)
def gather_border(view, n):
    """List the faces around the n cells in `slot`, but for walls at the edge in `count`."""
    stamp = view.count[C_STAMP] + 1
    view.count[C_STAMP] = stamp
    a = view.count[C_EDGE]
    b = view.count[C_EDGE + 1]
    for i in range(n):
        view.mark[view.slot[i]] = stamp
    m = 0
    for i in range(n):
        t = view.slot[i]
        at_edge = a >= 0 and place_in(view, t, a) < 4 and place_in(view, t, b) < 4
        for f in range(4):
            h = 4 * t + f
            g = view.mate[h]
            if g >= 0 and view.mark[g >> 2] == stamp:
                continue
            if at_edge and g < 0 and view.corner[h] != a and view.corner[h] != b:
                continue
            write_entry(view, m, h, g, view.wall[h])
            m += 1
    return m


@njit(**HELPER)
def has_room(view, extra):
    """Whether `extra` more cells find room."""
    t = view.count[C_FREE]
    extra -= view.count[C_ROOM] - view.count[C_TOP]
    while extra > 0 and t >= 0:
        extra -= 1
        t = view.mate[4 * t]
    return extra <= 0


@njit(**HELPER)
def next_cell(view):
    """Number of a cell that is free from now on to be used."""
    t = view.count[C_FREE]
    if t >= 0:
        view.count[C_FREE] = view.mate[4 * t]
    else:
        t = view.count[C_TOP]
        view.count[C_TOP] = t + 1
    return t


@njit(**HELPER)
def free_cell(view, t):
    """Give cell t back."""
    view.corner[4 * t] = -1
    view.score[t] = 2.0
    view.mate[4 * t] = view.count[C_FREE]
    view.count[C_FREE] = t


@njit(**HELPER)
def join_face(view, h, m):
    """Join face h of a new cell to the waiting face that it is, or let it wait; how many wait."""
    write_entry(view, m, h, h, -1)
    own = ENTRY_WIDTH * m
    low = view.border[own]
    middle = view.border[own + 1]
    high = view.border[own + 2]
    for at in range(0, own, ENTRY_WIDTH):
        if view.border[at] == low and view.border[at + 1] == middle and view.border[at + 2] == high:
            g = view.border[at + 3]
            wall = max(view.border[at + 4], new_wall(view, low, middle, high))
            view.mate[h] = g
            view.wall[h] = wall
            if g >= 0:
                view.mate[g] = h
                view.wall[g] = wall
            last = own - ENTRY_WIDTH
            for k in range(ENTRY_WIDTH):
                view.border[at + k] = view.border[last + k]
            return m - 1
    return m + 1


@njit(**HELPER)
def refill(view, m):
    """Replace the cells in `slot` by the m in `fresh`; False if there is no room."""
    n = view.count[C_OLD]
    if not has_room(view, m - n):
        return False
    clock = view.count[C_CLOCK]
    waiting = gather_border(view, n)
    for k in range(waiting):
        g = view.border[ENTRY_WIDTH * k + 3]
        for i in range(3):
            v = view.border[ENTRY_WIDTH * k + i]
            view.changed[v] = clock
            if g >= 0:
                view.of_vertex[v] = g >> 2
    for k in range(m, n):
        free_cell(view, view.slot[k])
    for k in range(m):
        if k >= n:
            view.slot[k] = next_cell(view)
        t = view.slot[k]
        for i in range(4):
            v = view.fresh[4 * k + i]
            view.corner[4 * t + i] = v
            view.of_vertex[v] = t
            view.changed[v] = clock
        view.region[t] = view.fresh_region[k]
        view.tried[t] = -1
        view.score[t] = shape_of(
            view.xyz,
            view.fresh[4 * k],
            view.fresh[4 * k + 1],
            view.fresh[4 * k + 2],
            view.fresh[4 * k + 3],
        )
    for k in range(m):
        for f in range(4):
            waiting = join_face(view, 4 * view.slot[k] + f, waiting)
    # Whatever waits now has nothing beyond: the surface runs here from now on.
    for k in range(waiting):
        at = ENTRY_WIDTH * k
        h = view.border[at + 3]
        if h < 0:
            continue
        view.mate[h] = -1
        view.wall[h] = new_wall(view, view.border[at], view.border[at + 1], view.border[at + 2])
    return True

"""Improve the bad cells of a piece, one after the other."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .cavity import new_plan, refill
from .cells import (
    C_CLOCK,
    C_COME,
    C_DONE,
    C_EDGE,
    C_GONE,
    C_NEXT,
    C_THOROUGH,
    C_VERTICES,
    C_WISHES,
    FREE,
    FROZEN,
    N_GOAL,
    N_POOR,
    ON_CURVE,
    ON_FACE,
    Piece,
    view_of,
)
from .edges import edge_gain, plan_edge
from .faces import face_gain, plan_face
from .insertion import plan_contraction, plan_insertion
from .surface import turn
from .vertices import grant, smooth, wish

__all__ = ["Piece", "grant_wishes", "treat_cells", "wish_moves"]

#: Cells treated between two returns to the caller: less than 0.2 s.
SLICE = 1000


@njit(**HELPER)
def flip_gain(view, t, what):
    """Worst shape after a flip at cell t: of a face, or of edge i, j as 4 i + j + 4."""
    if what < 4:
        return face_gain(view, t, what)
    i = (what - 4) >> 2
    j = what & 3
    return edge_gain(view, t, i, j) if i < j else 0.0


@njit(**HELPER)
def plan_flip(view, t):
    """Plan the best flip at cell t; how many cells there will be, or -1."""
    best = 0.0
    what = -1
    for k in range(17):
        # At last the best one once more, for its tables.
        chosen = what if k == 16 else k
        if chosen < 0:
            return -1
        value = flip_gain(view, t, chosen)
        if value > best:
            best = value
            what = k
    if what < 4:
        return plan_face(view, t, what)
    return plan_edge(view, t, (what - 4) >> 2, what & 3)


@njit(**HELPER)
def is_hopeless(view, t):
    """Whether nothing has changed around cell t since it was treated in vain."""
    last = view.tried[t]
    newest = 0
    for f in range(4 * t, 4 * t + 4):
        newest = max(newest, view.changed[view.corner[f]])
    return last >= newest


@njit(**HELPER)
def carry_out(view, m):
    """Replace the cells of a plan by m others; False if there is no room."""
    come = view.count[C_COME]
    gone = view.count[C_GONE]
    if come >= 0:
        view.kind[come] = FREE
    if not refill(view, m):
        return False
    if view.count[C_EDGE] >= 0:
        turn(view)
    if come >= 0:
        view.count[C_VERTICES] = come + 1
    if gone >= 0:
        view.of_vertex[gone] = -1
        view.kind[gone] = FROZEN
    return True


@njit(**HELPER)
def treat(view, t):
    """Flip; else move the corners; else, if thorough and poor, take a vertex out or put one in."""
    new_plan(view)
    m = plan_flip(view, t)
    if m < 0:
        gained = False
        for f in range(4 * t, 4 * t + 4):
            if smooth(view, view.corner[f]):
                gained = True
                if view.score[t] > view.number[N_GOAL]:
                    return True
        if gained or view.count[C_THOROUGH] == 0 or view.score[t] > view.number[N_POOR]:
            return gained
        new_plan(view)
        m = plan_contraction(view, t)
        if m < 0:
            new_plan(view)
            m = plan_insertion(view, t)
        if m < 0:
            return False
    return carry_out(view, m)


@njit(**ENTRY)
def treat_cells(arrays, cells):
    """Treat the cells of a list in turn, from count[C_NEXT] on; whether there is more to do."""
    view = view_of(arrays)
    todo = pointer(cells)
    count = view.count
    pause = min(count[C_NEXT] + SLICE, cells.shape[0])
    while count[C_NEXT] < pause:
        t = todo[count[C_NEXT]]
        count[C_NEXT] += 1
        if view.corner[4 * t] < 0 or view.score[t] > view.number[N_GOAL] or is_hopeless(view, t):
            continue
        count[C_CLOCK] += 1
        if treat(view, t):
            count[C_DONE] += 1
        if view.corner[4 * t] >= 0:
            view.tried[t] = count[C_CLOCK]
    return count[C_NEXT] < cells.shape[0]


@njit(**ENTRY)
def wish_moves(arrays, cells, busy):
    """Note where the vertices on the surface of a list of cells had better be."""
    view = view_of(arrays)
    todo = pointer(cells)
    marks = pointer(busy)
    count = view.count
    pause = min(count[C_NEXT] + SLICE, cells.shape[0])
    while count[C_NEXT] < pause:
        t = todo[count[C_NEXT]]
        count[C_NEXT] += 1
        if view.corner[4 * t] < 0 or view.score[t] > view.number[N_GOAL]:
            continue
        for f in range(4 * t, 4 * t + 4):
            v = view.corner[f]
            kind = view.kind[v]
            if ON_FACE <= kind <= ON_CURVE and wish(view, v, marks):
                count[C_DONE] += 1
    return count[C_NEXT] < cells.shape[0]


@njit(**ENTRY)
def grant_wishes(arrays, granted):
    """Move all vertices to where their wishes are now; which of them did move."""
    view = view_of(arrays)
    moved = pointer(granted)
    view.count[C_CLOCK] += 1
    for k in range(view.count[C_WISHES]):
        if moved[k] != 0:
            moved[k] = grant(view, k)

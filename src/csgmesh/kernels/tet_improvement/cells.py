"""A piece of a mesh of tetrahedra under improvement: its layout, walks in it, a cavity refilled.

Corner i of cell t stands at 4 t + i, which is also the number of the face opposite to it. `mate` is
the same face seen from the other side, -1 at the end of the piece; `wall` the surface triangle that
the face is, -1 for none. A cell with corner -1 is free.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from ..pointers import HELPER, pointer

#: A piece, as arrays and as pointers. xyz, kind, of_vertex, changed: of vertices (coordinates,
#: FREE ... FROZEN, a cell there, when something last changed there). corner ... mark: of cells, see
#: above (`score` is the shape, `tried` when the cell was treated last). triangle, face, normal: the
#: surface's triangles, their faces, exact normals at their corners; limit: how far chords of a face
#: may stray. segment_begin, segment: neighbours along curves. star ... value: room of one step.
#: place: position and direction of a climb. wish, moves: vertices that want to slide, and whereto.
Piece = namedtuple(
    "Piece",
    "xyz kind of_vertex changed corner mate wall region score tried mark "
    "triangle face normal limit segment_begin segment "
    "star ring ring_cell spoke split span fresh fresh_region slot border "
    "link value slope place wish moves count number",
)
View = namedtuple(
    "View",
    "xyz kind of_vertex changed corner mate wall region score tried mark "
    "triangle face normal limit segment_begin segment "
    "star ring ring_cell spoke split span fresh fresh_region slot border "
    "link value slope place wish moves count number",
)

FREE = np.int64(0)
ON_FACE = np.int64(1)
ON_CURVE = np.int64(2)
FIXED = np.int64(3)
#: At the end of the piece, where not all of a vertex's cells are known.
FROZEN = np.int64(4)

# Places in `count`.
C_STAMP = 0  # of marks
C_CLOCK = 1  # of treatments
C_NEXT = 2  # the next entry of a list to look at
C_DONE = 3  # entries that were improved
C_TOP = 4  # cells in use, free ones among them
C_FREE = 5  # first free cell, -1 for none
C_ROOM = 6  # cells there is room for
C_VERTICES = 7  # vertices
C_VERTEX_ROOM = 8  # vertices there is room for
C_EDGE = 9  # what a plan turns: ends of an edge of the surface, and of the new one; -1 for none
C_NEW_WALL = 13  # twice three corners and a number
C_GONE = 21  # the vertex that a plan takes out, -1 for none
C_COME = 22  # the vertex that a plan puts in, -1 for none
C_OLD = 23  # cells that a plan takes out
C_RING = 24  # vertices of the ring
C_CLOSED = 25  # whether the ring is closed
C_CHAIN = 26  # where the ring's second chain begins, 0 for none
C_WALLS = 27  # two surface triangles at the ring's edge, -1 for none
C_WISHES = 29
C_THOROUGH = 30  # whether vertices may come and go

# Places in `number`.
N_GOAL = 0  # cells this good are left alone
N_EASY = 1  # a climb may end here
N_POOR = 2  # only for cells that are worse vertices come and go

#: Cells around a vertex, or in a cavity, at most; and faces that are matched.
WIDEST = 96
#: Vertices around an edge at most, and the row length of the tables of its triangulations.
LONGEST = 9
ROW = 12
#: Entry 4 i + j, of two bits: the third corner of the even permutation that begins with i, j.
EVEN = np.int64(0x120D8378)
#: An improvement must be by this factor.
GAIN = 1.0 + 1e-3


@njit(**HELPER)
def view_of(a):
    return View(
        pointer(a.xyz),
        pointer(a.kind),
        pointer(a.of_vertex),
        pointer(a.changed),
        pointer(a.corner),
        pointer(a.mate),
        pointer(a.wall),
        pointer(a.region),
        pointer(a.score),
        pointer(a.tried),
        pointer(a.mark),
        pointer(a.triangle),
        pointer(a.face),
        pointer(a.normal),
        pointer(a.limit),
        pointer(a.segment_begin),
        pointer(a.segment),
        pointer(a.star),
        pointer(a.ring),
        pointer(a.ring_cell),
        pointer(a.spoke),
        pointer(a.split),
        pointer(a.span),
        pointer(a.fresh),
        pointer(a.fresh_region),
        pointer(a.slot),
        pointer(a.border),
        pointer(a.link),
        pointer(a.value),
        pointer(a.slope),
        pointer(a.place),
        pointer(a.wish),
        pointer(a.moves),
        pointer(a.count),
        pointer(a.number),
    )


@njit(**HELPER)
def is_better(new, old):
    """Whether a shape is better by more than rounding."""
    return new > 0.0 and (old <= 0.0 or new > old * GAIN)


@njit(**HELPER)
def place_in(view, t, v):
    """Which corner of cell t vertex v is; 4 for none."""
    i = 0
    while i < 4 and view.corner[4 * t + i] != v:
        i += 1
    return i


@njit(**HELPER)
def gather_star(view, v):
    """List the cells around v; how many, or -1 if they are too many."""
    stamp = view.count[C_STAMP] + 1
    view.count[C_STAMP] = stamp
    t = view.of_vertex[v]
    view.star[0] = t
    view.mark[t] = stamp
    n = 1
    i = 0
    while i < n:
        t = view.star[i]
        for f in range(4 * t, 4 * t + 4):
            g = view.mate[f]
            if view.corner[f] != v and g >= 0 and view.mark[g >> 2] != stamp:
                if n == WIDEST:
                    return -1
                view.mark[g >> 2] = stamp
                view.star[n] = g >> 2
                n += 1
        i += 1
    return n


@njit(**HELPER)
def third(i, j):
    """The corner k for which (i, j, k, rest) is an even permutation of the corners."""
    return (EVEN >> (2 * (4 * i + j))) & 3


@njit(**HELPER)
def gather_ring(view, t, a, b):
    """Walk around edge a, b from cell t; the number of its cells, or -1 if they are too many.

    Cell k has vertices k and k + 1 of the ring and is positive as (a, b, k, k + 1); spoke k is the
    wall between cells k - 1 and k. An open ring has one vertex more than cells.
    """
    start = t
    i = place_in(view, t, a)
    j = place_in(view, t, b)
    back = third(i, j)
    view.count[C_CLOSED] = 1
    steps = 0
    while True:
        g = view.mate[4 * t + 6 - i - j - back]
        if g < 0:
            view.count[C_CLOSED] = 0
            break
        ahead = view.corner[4 * t + back]
        t = g >> 2
        i = place_in(view, t, a)
        j = place_in(view, t, b)
        back = 6 - i - j - place_in(view, t, ahead)
        steps += 1
        if t == start:
            break
        if steps == LONGEST:
            return -1
    start = t
    view.spoke[0] = view.wall[4 * t + 6 - i - j - back]
    n = 0
    while True:
        if n == LONGEST - 1:
            return -1
        ahead = view.corner[4 * t + 6 - i - j - back]
        view.ring[n] = view.corner[4 * t + back]
        view.ring_cell[n] = t
        n += 1
        view.ring[n] = ahead
        view.spoke[n] = view.wall[4 * t + back]
        g = view.mate[4 * t + back]
        if g < 0 or g >> 2 == start:
            break
        t = g >> 2
        i = place_in(view, t, a)
        j = place_in(view, t, b)
        back = place_in(view, t, ahead)
    view.count[C_RING] = n + 1 - view.count[C_CLOSED]
    return n

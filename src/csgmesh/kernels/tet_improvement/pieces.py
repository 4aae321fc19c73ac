"""Cut a piece around the bad cells out of a mesh of tetrahedra, and connect its cells."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .cells import (
    FIXED,
    FREE,
    FROZEN,
    gather_star,
    view_of,
)
from .shapes import shape_of

__all__ = ["choose_cells", "connect_cells", "fix_pinched", "score_cells"]


@njit(**ENTRY)
def score_cells(points, cells, scores, first):
    """Shapes of a slice of the cells from the first on; where it ended."""
    xyz = pointer(points)
    corner = pointer(cells)
    score = pointer(scores)
    end = min(first + 1_000_000, scores.shape[0])
    for t in range(first, end):
        score[t] = shape_of(
            xyz, corner[4 * t], corner[4 * t + 1], corner[4 * t + 2], corner[4 * t + 3]
        )
    return end


@njit(**HELPER)
def spread(corner, chosen, mark, n, inner, outer):
    """Choose cells with a vertex marked `inner` or less, and mark their other vertices `outer`."""
    for t in range(n):
        near = False
        for i in range(4 * t, 4 * t + 4):
            m = mark[corner[i]]
            if m > 0 and m <= inner:
                near = True
        if near:
            chosen[t] = 1
            for i in range(4 * t, 4 * t + 4):
                if mark[corner[i]] == 0:
                    mark[corner[i]] = outer


@njit(**ENTRY)
def choose_cells(cells, scores, goal, wide, marks, choices):
    """Choose the cells around those below the goal; if `wide`, those around these, too.

    Marks vertices of bad cells 1, their neighbours 2 if wide, and 3 those of chosen cells some of
    whose cells are not chosen.
    """
    corner = pointer(cells)
    score = pointer(scores)
    mark = pointer(marks)
    chosen = pointer(choices)
    n = scores.shape[0]
    for t in range(n):
        if score[t] <= goal:
            for i in range(4 * t, 4 * t + 4):
                mark[corner[i]] = 1
    if wide != 0:
        spread(corner, chosen, mark, n, 1, 2)
        spread(corner, chosen, mark, n, 2, 3)
    else:
        spread(corner, chosen, mark, n, 1, 3)


@njit(**HELPER)
def slot_of(corner, table, room, low, middle, high):
    """Where in the table the face of three sorted vertices is, or may be put."""
    key = (low * 73856093) ^ (middle * 19349663) ^ (high * 83492791)
    at = (key ^ (key >> 15)) & (room - 1)
    while table[at] >= 0:
        h = table[at]
        a = corner[(h & ~3) + ((h & 3) ^ 1)]
        b = corner[(h & ~3) + ((h & 3) ^ 2)]
        c = corner[(h & ~3) + ((h & 3) ^ 3)]
        if (
            min(a, min(b, c)) == low
            and max(a, max(b, c)) == high
            and a + b + c - low - high == middle
        ):
            break
        at = (at + 1) & (room - 1)
    return at


@njit(**ENTRY)
def connect_cells(corners, mates, walls, of_vertices, triangles, n_cells, hash_table):
    """Fill mates, walls and a cell of each vertex; all of them and the table -1 before.

    The table has a power of two of entries. Triangles that are no face of these cells are left out.
    """
    corner = pointer(corners)
    mate = pointer(mates)
    wall = pointer(walls)
    of_vertex = pointer(of_vertices)
    triangle = pointer(triangles)
    table = pointer(hash_table)
    room = hash_table.shape[0]
    for h in range(4 * n_cells):
        of_vertex[corner[h]] = h >> 2
        a = corner[(h & ~3) + ((h & 3) ^ 1)]
        b = corner[(h & ~3) + ((h & 3) ^ 2)]
        c = corner[(h & ~3) + ((h & 3) ^ 3)]
        low = min(a, min(b, c))
        high = max(a, max(b, c))
        at = slot_of(corner, table, room, low, a + b + c - low - high, high)
        if table[at] < 0:
            table[at] = h
        else:
            g = table[at]
            mate[h] = g
            mate[g] = h
    for w in range(triangles.shape[0] // 3):
        a = triangle[3 * w]
        b = triangle[3 * w + 1]
        c = triangle[3 * w + 2]
        low = min(a, min(b, c))
        high = max(a, max(b, c))
        h = table[slot_of(corner, table, room, low, a + b + c - low - high, high)]
        if h >= 0:
            wall[h] = w
            if mate[h] >= 0:
                wall[mate[h]] = w


@njit(**ENTRY)
def fix_pinched(arrays, n_cells, degrees):
    """Fix vertices whose cells do not all hang together by faces; freeze those at open faces.

    A face is open if it is no wall and has nothing beyond, or another region.
    """
    view = view_of(arrays)
    degree = pointer(degrees)
    for h in range(4 * n_cells):
        degree[view.corner[h]] += 1
        g = view.mate[h]
        if view.wall[h] < 0 and (g < 0 or view.region[g >> 2] != view.region[h >> 2]):
            for k in range(1, 4):
                view.kind[view.corner[(h & ~3) + ((h & 3) ^ k)]] = FROZEN
    for v in range(degrees.shape[0]):
        kind = view.kind[v]
        if kind > FREE and kind < FIXED and gather_star(view, v) != degree[v]:
            view.kind[v] = FIXED
        if kind == FREE and degree[v] == 0:
            view.kind[v] = FROZEN

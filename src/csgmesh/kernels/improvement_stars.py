"""Stars of vertices in a mesh under improvement, and how good they are.

Half-edge 3 t + e runs from corner e of triangle t to the next; `twin` is -1 on the outer boundary
and `line` the facet that an edge is, -1 for none. The quality of a triangle is the cotangent of its
smallest angle: the larger, the worse.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from .pointers import HELPER, pointer
from .predicates import orient2d

#: A mesh under improvement, as arrays and as pointers. kind: FREE, SLIDING or FIXED vertices;
#: around: the facets before and behind each sliding vertex; interval, curve: of each facet; size:
#: wanted edge length at each vertex; ring: corners of a star; log, past: what was done, to be
#: undone; crowd: vertices moved together; stamp, failed: when a vertex last moved, when a triangle
#: was last treated in vain; count, number: see below.
Arrays = namedtuple(
    "Arrays",
    "xy origin twin line region edge_of kind around interval curve curve_kind curve_data "
    "size ring log past crowd stamp failed count number",
)
Piece = namedtuple(
    "Piece",
    "xy origin twin line region edge_of kind around interval curve curve_kind curve_data "
    "size ring log past crowd stamp failed count number",
)

FREE = np.int64(0)
SLIDING = np.int64(1)
FIXED = np.int64(2)
FLAT = 1e30

# Places in `count`.
C_LOG = 0  # entries in the log
C_EFFORT = 1  # vertices tried in other places
C_NEXT = 2  # the next entry of the list to look at
C_DONE = 3  # how many entries were improved
C_CLOCK = 4  # treatments so far
C_SWEEPS = 5  # how often a crowd is gone through
C_ROUNDS = 6  # rounds of a search
C_LIMIT = 7  # effort allowed

# Places in `number`.
N_DEVIATION = 0  # distance of a facet from its curve that is always allowed
N_SHORTEST = 1  # shortest and longest edge, as shares of the size
N_LONGEST = 2
N_GOAL = 3  # triangles no worse than this need no treatment
N_EASY = 4  # stars no worse than this are left alone

#: Triangles in a star that can be moved in.
WIDEST = 24


@njit(**HELPER)
def piece_of(arrays):
    return Piece(
        pointer(arrays.xy),
        pointer(arrays.origin),
        pointer(arrays.twin),
        pointer(arrays.line),
        pointer(arrays.region),
        pointer(arrays.edge_of),
        pointer(arrays.kind),
        pointer(arrays.around),
        pointer(arrays.interval),
        pointer(arrays.curve),
        pointer(arrays.curve_kind),
        pointer(arrays.curve_data),
        pointer(arrays.size),
        pointer(arrays.ring),
        pointer(arrays.log),
        pointer(arrays.past),
        pointer(arrays.crowd),
        pointer(arrays.stamp),
        pointer(arrays.failed),
        pointer(arrays.count),
        pointer(arrays.number),
    )


@njit(**HELPER)
def after(h):
    return h + 1 if h % 3 < 2 else h - 2


@njit(**HELPER)
def before(h):
    return h - 1 if h % 3 > 0 else h + 2


@njit(**HELPER)
def cotangent(ax, ay, bx, by, cx, cy):
    """Cotangent of the smallest angle of a triangle; FLAT where it is not counterclockwise."""
    ux = bx - ax
    uy = by - ay
    vx = cx - ax
    vy = cy - ay
    area = ux * vy - uy * vx
    if area <= 0.0:
        return FLAT
    wx = cx - bx
    wy = cy - by
    u = ux * ux + uy * uy
    v = vx * vx + vy * vy
    w = wx * wx + wy * wy
    return (u + v + w - 2.0 * min(u, min(v, w))) / (2.0 * area)


@njit(**HELPER)
def triangle_quality(piece, h):
    """Cotangent of the smallest angle of the triangle of half-edge h."""
    a = 2 * piece.origin[h]
    b = 2 * piece.origin[after(h)]
    c = 2 * piece.origin[before(h)]
    xy = piece.xy
    return cotangent(xy[a], xy[a + 1], xy[b], xy[b + 1], xy[c], xy[c + 1])


@njit(**HELPER)
def first_of_star(piece, v):
    """The half-edge from v with which its star begins, clockwise-most where it is a fan."""
    start = piece.edge_of[v]
    h = start
    while True:
        g = piece.twin[h]
        if g < 0:
            return h
        h = after(g)
        if h == start:
            return h


@njit(**HELPER)
def gather_star(piece, v):
    """Write the edges opposite v into the ring, four numbers each; how many, 0 for too many."""
    start = first_of_star(piece, v)
    h = start
    n = 0
    xy = piece.xy
    while n < WIDEST:
        p = 2 * piece.origin[after(h)]
        q = 2 * piece.origin[before(h)]
        piece.ring[4 * n] = xy[p]
        piece.ring[4 * n + 1] = xy[p + 1]
        piece.ring[4 * n + 2] = xy[q]
        piece.ring[4 * n + 3] = xy[q + 1]
        n += 1
        h = piece.twin[before(h)]
        if h < 0 or h == start:
            return n
    return 0


@njit(**HELPER)
def worst_of_star(piece, v):
    """Worst quality of the triangles around v."""
    start = first_of_star(piece, v)
    h = start
    worst = 0.0
    while True:
        worst = max(worst, triangle_quality(piece, h))
        h = piece.twin[before(h)]
        if h < 0 or h == start:
            return worst


@njit(**HELPER)
def rate(ring, n, x, y, low, high, limit):
    """Quality of a star with its vertex at (x, y); FLAT beyond `limit` or the edge lengths."""
    worst = 0.0
    for i in range(n):
        px = ring[4 * i]
        py = ring[4 * i + 1]
        d = (px - x) * (px - x) + (py - y) * (py - y)
        if d < low or d > high:
            return FLAT
        worst = max(worst, cotangent(x, y, px, py, ring[4 * i + 2], ring[4 * i + 3]))
        if worst > limit:
            return FLAT
    d = (ring[4 * n - 2] - x) * (ring[4 * n - 2] - x)
    d += (ring[4 * n - 1] - y) * (ring[4 * n - 1] - y)
    return FLAT if d < low or d > high else worst


@njit(**HELPER)
def is_upright(ring, n, x, y):
    """Whether every triangle of a star is counterclockwise, exactly."""
    for i in range(n):
        if orient2d(x, y, ring[4 * i], ring[4 * i + 1], ring[4 * i + 2], ring[4 * i + 3]) <= 0.0:
            return False
    return True


@njit(**HELPER)
def edge_bounds(piece, v, n):
    """Squared edge lengths allowed around v: those of its size, and those it has."""
    x = piece.xy[2 * v]
    y = piece.xy[2 * v + 1]
    h = piece.size[v]
    low = (piece.number[N_SHORTEST] * h) ** 2
    high = (piece.number[N_LONGEST] * h) ** 2
    ring = piece.ring
    for i in range(0, 4 * n, 2):
        d = (ring[i] - x) * (ring[i] - x) + (ring[i + 1] - y) * (ring[i + 1] - y)
        low = min(low, d)
        high = max(high, d)
    return low, high


@njit(**HELPER)
def centre_of_star(ring, n, x, y, optimal):
    """Mean of the neighbours; or, if `optimal`, of the circumcentres weighted by area (ODT)."""
    sx = 0.0
    sy = 0.0
    total = 0.0
    for i in range(n):
        ux = ring[4 * i] - x
        uy = ring[4 * i + 1] - y
        vx = ring[4 * i + 2] - x
        vy = ring[4 * i + 3] - y
        area = ux * vy - uy * vx
        if optimal == 0:
            sx += ux + vx
            sy += uy + vy
            total += 2.0
        elif area > 0.0:
            u = ux * ux + uy * uy
            v = vx * vx + vy * vy
            # The circumcentre times twice the area: the division cancels.
            sx += 0.5 * (vy * u - uy * v)
            sy += 0.5 * (ux * v - vx * u)
            total += area
    if total <= 0.0:
        return x, y
    return x + sx / total, y + sy / total

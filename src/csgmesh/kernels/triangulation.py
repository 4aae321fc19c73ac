"""The triangulation in flat arrays, and the moves on it: walk, gather a cavity, fan it, flip.

Half-edge h = 4 t + e, e = 0, 1, 2, of triangle t (always passed as 4 t):

- ``origin[h]`` vertex it leaves, ``twin[h]`` the same edge seen from the other triangle,
- ``origin[4 t + 3]`` bit e set: edge e is a subsegment, whose number is ``sub[h]``,
- ``twin[4 t + 3]`` region of the triangle, -1 outside.

Ghost triangles close the outside; their third vertex is -1. An insertion first gathers its
cavity (Bowyer 1981, Watson 1981) and looks at it, then replaces it by a fan: nothing needs undoing
when the point turns out not to be wanted. The vertex inserted last into a triangle stands third.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from .pointers import HELPER
from .predicates import incircle, orient2d

#: Pointers to the triangulation and to the buffers of one insertion.
Net = namedtuple("Net", "xy origin twin sub stack cavity ring ring_from ring_sub")

NONE = np.int64(-1)

# What a kernel says when it returns to its shell.
DONE = np.int64(0)
ROOM = np.int64(1)
SLICE = np.int64(2)
BUDGET = np.int64(3)
DUPLICATE = np.int64(4)
CROSSING = np.int64(5)
ON_SEGMENT = np.int64(6)
COLLINEAR = np.int64(7)
STUCK = np.int64(8)
LEAK = np.int64(9)


@njit(**HELPER)
def following(h):
    """The next half-edge around the triangle of h."""
    return h - 2 if h & 3 == 2 else h + 1


@njit(**HELPER)
def preceding(h):
    """The half-edge before h around its triangle."""
    return h + 2 if h & 3 == 0 else h - 1


@njit(**HELPER)
def is_subsegment(origin, h):
    return origin[h | 3] >> (h & 3) & 1 != 0


@njit(**HELPER)
def orient_vertices(xy, a, b, c):
    return orient2d(xy[2 * a], xy[2 * a + 1], xy[2 * b], xy[2 * b + 1], xy[2 * c], xy[2 * c + 1])


@njit(**HELPER)
def orient_point(xy, a, b, x, y):
    return orient2d(xy[2 * a], xy[2 * a + 1], xy[2 * b], xy[2 * b + 1], x, y)


@njit(**HELPER)
def in_conflict(xy, origin, t, x, y):
    """Whether (x, y) lies inside the circumcircle of triangle t; for a ghost, outside its edge."""
    a = origin[t]
    b = origin[t + 1]
    c = origin[t + 2]
    if a | b | c >= 0:
        return (
            incircle(
                xy[2 * a], xy[2 * a + 1], xy[2 * b], xy[2 * b + 1], xy[2 * c], xy[2 * c + 1], x, y
            )
            > 0.0
        )
    if a < 0:
        u = b
        v = c
    elif b < 0:
        u = c
        v = a
    else:
        u = a
        v = b
    ux = xy[2 * u]
    uy = xy[2 * u + 1]
    vx = xy[2 * v]
    vy = xy[2 * v + 1]
    o = orient2d(ux, uy, vx, vy, x, y)
    if o != 0.0:
        return o > 0.0
    return (x - ux) * (x - vx) + (y - uy) * (y - vy) < 0.0


@njit(**HELPER)
def walk(xy, origin, twin, t, x, y, stops):
    """Visibility walk from triangle t to the one that holds (x, y).

    Returns the triangle; or -1 - h where subsegment h stands in the way and `stops` is not 0.
    """
    for e in range(3):
        if origin[t + e] < 0:
            t = twin[following(t + e)] & ~3
            break
    h = t
    if orient_point(xy, origin[h], origin[h + 1], x, y) < 0.0:
        if stops != 0 and is_subsegment(origin, h):
            return -1 - h
        h = twin[h]
    while True:
        ahead = following(h)
        behind = preceding(h)
        a = origin[h]
        b = origin[ahead]
        c = origin[behind]
        if a | b | c < 0:
            return h & ~3
        cx = xy[2 * c]
        cy = xy[2 * c + 1]
        if orient2d(xy[2 * b], xy[2 * b + 1], cx, cy, x, y) < 0.0:
            h = ahead
        elif orient2d(cx, cy, xy[2 * a], xy[2 * a + 1], x, y) < 0.0:
            h = behind
        else:
            return h & ~3
        if stops != 0 and is_subsegment(origin, h):
            return -1 - h
        h = twin[h]


@njit(**HELPER)
def gather(net, t, through, x, y, room):
    """Cavity of (x, y), from triangle t which is in it; subsegments other than `through` bound it.

    The edges of its outline come counter-clockwise into ``ring`` (seen from outside),
    ``ring_from`` (first vertex) and ``ring_sub`` (subsegment or -1), its triangles into ``cavity``.
    Returns the number of outline edges, always two more than triangles; -1 without room.
    """
    net.cavity[0] = t
    net.stack[0] = t + 2
    net.stack[1] = t + 1
    net.stack[2] = t
    n_ring = 0
    n_cavity = 1
    n_stack = 3
    while n_stack > 0:
        n_stack -= 1
        h = net.stack[n_stack]
        o = net.twin[h]
        fixed = is_subsegment(net.origin, h)
        if h == through or (not fixed and in_conflict(net.xy, net.origin, o & ~3, x, y)):
            if n_cavity + 4 > room:
                return -1
            net.cavity[n_cavity] = o & ~3
            n_cavity += 1
            net.stack[n_stack] = preceding(o)
            net.stack[n_stack + 1] = following(o)
            n_stack += 2
        else:
            net.ring[n_ring] = o
            net.ring_from[n_ring] = net.origin[h]
            net.ring_sub[n_ring] = net.sub[h] if fixed else -1
            n_ring += 1
    return n_ring


@njit(**HELPER)
def fan(net, n_triangles, p, n_ring, region):
    """Replace the gathered cavity by a fan around vertex p; ``cavity`` then lists its triangles.

    Triangle i of the fan is (first vertex of outline edge i, second, p). Returns the new number
    of triangles.
    """
    net.cavity[n_ring - 2] = 4 * n_triangles
    net.cavity[n_ring - 1] = 4 * n_triangles + 4
    before = net.cavity[n_ring - 1]
    t = net.cavity[0]
    a = net.ring_from[0]
    for i in range(n_ring):
        j = i + 1 if i + 1 < n_ring else 0
        after = net.cavity[j]
        b = net.ring_from[j]
        o = net.ring[i]
        s = net.ring_sub[i]
        net.origin[t] = a
        net.origin[t + 1] = b
        net.origin[t + 2] = p
        if s >= 0:
            net.origin[t + 3] = 1
            net.sub[t] = s
        else:
            net.origin[t + 3] = 0
        net.twin[t] = o
        net.twin[o] = t
        net.twin[t + 1] = after + 2
        net.twin[t + 2] = before + 1
        net.twin[t + 3] = region
        before = t
        t = after
        a = b
    return n_triangles + 2


@njit(**HELPER)
def set_subsegment(net, h, s):
    """Mark edge h, from both sides, as subsegment s."""
    o = net.twin[h]
    net.origin[h | 3] = net.origin[h | 3] | 1 << (h & 3)
    net.origin[o | 3] = net.origin[o | 3] | 1 << (o & 3)
    net.sub[h] = s
    net.sub[o] = s


@njit(**HELPER)
def clear_subsegment(net, h):
    """Make edge h an ordinary edge."""
    o = net.twin[h]
    net.origin[h | 3] = net.origin[h | 3] & ~(1 << (h & 3))
    net.origin[o | 3] = net.origin[o | 3] & ~(1 << (o & 3))


@njit(**HELPER)
def move_edge(net, from_h, to_h):
    """Let half-edge to_h take over the twin and the subsegment of from_h (not its origin)."""
    o = net.twin[from_h]
    net.twin[to_h] = o
    net.twin[o] = to_h
    if is_subsegment(net.origin, from_h):
        net.origin[to_h | 3] = net.origin[to_h | 3] | 1 << (to_h & 3)
        net.sub[to_h] = net.sub[from_h]
    else:
        net.origin[to_h | 3] = net.origin[to_h | 3] & ~(1 << (to_h & 3))


@njit(**HELPER)
def flip(net, h):
    """Turn the diagonal h = u→w of the quadrilateral n, u, o, w.

    Then h is u→o, following(h) is o→n, and of the other triangle (g the old twin of h) g is w→n,
    following(g) is n→o; n→u and o→w stay where they are.
    """
    g = net.twin[h]
    h1 = following(h)
    g1 = following(g)
    n = net.origin[preceding(h)]
    o = net.origin[preceding(g)]
    move_edge(net, g1, h)
    move_edge(net, h1, g)
    net.origin[h1] = o
    net.origin[g1] = n
    net.twin[h1] = g1
    net.twin[g1] = h1
    net.origin[h1 | 3] = net.origin[h1 | 3] & ~(1 << (h1 & 3))
    net.origin[g1 | 3] = net.origin[g1 | 3] & ~(1 << (g1 & 3))

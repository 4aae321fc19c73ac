"""Flips: the tetrahedra around a face or an edge replaced by others of positive volume.

A face between two tetrahedra makes room for an edge (2-3); the tetrahedra around an edge make room
for triangles across its ring and what is above and below them (3-2, 4-4 and larger; L. Freitag,
C. Ollivier-Gooch 1997), of which a dynamic programme finds the best (G. Klincsek 1980).
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from ..pointers import HELPER
from .net import orient_vertices, slot_of

#: Pointers to points, tetrahedra, stamps, empty slots; a tetrahedron of each vertex; edges that
#: stay; the star of a vertex, the ring of an edge with its tetrahedra and what lies beyond them;
#: worth and apex of the best triangles across a ring; and the counts of `insert_in_space`.
Flips = namedtuple(
    "Flips",
    "xyz vert nei mark free home stays n_stays star ring tets above below worth apex counts",
)

#: Rings of more vertices are left alone.
WIDEST = 16
NO = np.int64(0)
YES = np.int64(1)


@njit(**HELPER)
def place_of(a, b, n):
    """Where the edge a, b is looked for first in a table of n places, a power of two."""
    low = min(a, b)
    high = max(a, b)
    key = (low << 32 | high) * np.int64(0x1E3779B97F4A7C15)
    return (key >> 20) & (n - 1), low << 32 | high


@njit(**HELPER)
def does_stay(flips, a, b):
    """Whether the edge a, b is one of the surface, present or not."""
    at, key = place_of(a, b, flips.n_stays)
    while flips.stays[at] >= 0:
        if flips.stays[at] == key:
            return True
        at = (at + 1) & (flips.n_stays - 1)
    return False


@njit(**HELPER)
def sees(flips, a, b, c, d):
    """Whether a, b, c, d have a positive volume."""
    return orient_vertices(flips.xyz, a, b, c, d) > 0.0


@njit(**HELPER)
def pierces(flips, p, q, a, b, c):
    """Whether the segment p, q crosses the inside of the triangle a, b, c."""
    if a < 0:
        return False
    over = orient_vertices(flips.xyz, a, b, c, p)
    under = orient_vertices(flips.xyz, a, b, c, q)
    if not ((over > 0.0 and under < 0.0) or (over < 0.0 and under > 0.0)):
        return False
    x = orient_vertices(flips.xyz, p, q, a, b)
    y = orient_vertices(flips.xyz, p, q, b, c)
    z = orient_vertices(flips.xyz, p, q, c, a)
    return (x > 0.0 and y > 0.0 and z > 0.0) or (x < 0.0 and y < 0.0 and z < 0.0)


@njit(**HELPER)
def take_slot(flips):
    """An empty slot."""
    if flips.counts[7] > 0:
        flips.counts[7] -= 1
        return flips.free[flips.counts[7]]
    t = flips.counts[1]
    flips.counts[1] += 1
    flips.mark[t] = 0
    return t


@njit(**HELPER)
def give_slot(flips, t):
    flips.vert[4 * t] = -2
    flips.free[flips.counts[7]] = t
    flips.counts[7] += 1


@njit(**HELPER)
def join(flips, h, g):
    """Make h and g the two sides of one face."""
    flips.nei[h] = g
    flips.nei[g] = h


@njit(**HELPER)
def settle(flips, t):
    """Make t the home of its vertices."""
    for h in range(4 * t, 4 * t + 4):
        if flips.vert[h] >= 0:
            flips.home[flips.vert[h]] = t


@njit(**HELPER)
def has_ghost(flips, t):
    return flips.vert[4 * t + 3] < 0


@njit(**HELPER)
def flip_face(flips, h, a, b, c):
    """Replace a face by the edge between what lies on both sides of it, if there is room (2-3).

    The edge must not pierce the triangle a, b, c, if a >= 0. Returns whether it was done.
    """
    vert = flips.vert
    nei = flips.nei
    t = h >> 2
    i = h & 3
    u = nei[h] >> 2
    if has_ghost(flips, t) or has_ghost(flips, u):
        return False
    p = vert[h]
    q = vert[nei[h]]
    k0 = (i + 1) & 3
    k1 = (i + 2) & 3
    k2 = (i + 3) & 3
    v0 = vert[4 * t + k0]
    v1 = vert[4 * t + k1]
    v2 = vert[4 * t + k2]
    if does_stay(flips, v0, v1) and does_stay(flips, v1, v2) and does_stay(flips, v2, v0):
        return False
    # The corners k0, k1, k2, i are an odd permutation of 0, 1, 2, 3 where i is even.
    if i & 1 == 0:
        k1, k2 = k2, k1
        v1, v2 = v2, v1
    if not (sees(flips, q, v1, v2, p) and sees(flips, v0, q, v2, p) and sees(flips, v0, v1, q, p)):
        return False
    if pierces(flips, p, q, a, b, c):
        return False
    t0 = nei[4 * t + k0]
    t1 = nei[4 * t + k1]
    t2 = nei[4 * t + k2]
    u0 = nei[4 * u + slot_of(vert, u, v0)]
    u1 = nei[4 * u + slot_of(vert, u, v1)]
    u2 = nei[4 * u + slot_of(vert, u, v2)]
    w = take_slot(flips)
    # Corners (v0, v1, v2, p) with q in place of v0 in t, of v1 in u, of v2 in w.
    vert[4 * t], vert[4 * t + 1], vert[4 * t + 2], vert[4 * t + 3] = q, v1, v2, p
    vert[4 * u], vert[4 * u + 1], vert[4 * u + 2], vert[4 * u + 3] = v0, q, v2, p
    vert[4 * w], vert[4 * w + 1], vert[4 * w + 2], vert[4 * w + 3] = v0, v1, q, p
    join(flips, 4 * t, t0)
    join(flips, 4 * u + 1, t1)
    join(flips, 4 * w + 2, t2)
    join(flips, 4 * t + 3, u0)
    join(flips, 4 * u + 3, u1)
    join(flips, 4 * w + 3, u2)
    join(flips, 4 * t + 1, 4 * u)
    join(flips, 4 * u + 2, 4 * w + 1)
    join(flips, 4 * w, 4 * t + 2)
    settle(flips, t)
    settle(flips, u)
    settle(flips, w)
    return True


@njit(**HELPER)
def find_ring(flips, t, a, b):
    """The ring of the edge a, b of t, counterclockwise seen from b; its length.

    ring[k] and ring[k + 1] are the other corners of tets[k]; above[k] and below[k] are the faces
    seen from beyond, opposite to a and to b. 0 if the ring is too long or holds a ghost.
    """
    vert = flips.vert
    nei = flips.nei
    first = t
    ia = slot_of(vert, t, a)
    ib = slot_of(vert, t, b)
    r = NO
    while r in (ia, ib):
        r += 1
    s = 6 - ia - ib - r
    if not sees(flips, a, b, vert[4 * t + r], vert[4 * t + s]):
        r, s = s, r
    n = NO
    while True:
        if n >= WIDEST or has_ghost(flips, t):
            return NO
        flips.tets[n] = t
        flips.ring[n] = vert[4 * t + r]
        flips.above[n] = nei[4 * t + slot_of(vert, t, a)]
        flips.below[n] = nei[4 * t + slot_of(vert, t, b)]
        n += 1
        # Through the face a, b, s, beyond which s comes first.
        v = vert[4 * t + s]
        ahead = nei[4 * t + r]
        t = ahead >> 2
        if t == first:
            return n
        r = slot_of(vert, t, v)
        s = ahead & 3


@njit(**HELPER)
def shape_of(flips, a, b, c, d):
    """A measure of the shape of a tetrahedron; not positive if it has no volume."""
    xyz = flips.xyz
    volume = orient_vertices(xyz, a, b, c, d)
    if volume <= 0.0:
        return -1.0
    length = 0.0
    for k in range(3):
        x = xyz[3 * a + k]
        y = xyz[3 * b + k]
        z = xyz[3 * c + k]
        w = xyz[3 * d + k]
        length += (x - y) ** 2 + (x - z) ** 2 + (x - w) ** 2
        length += (y - z) ** 2 + (y - w) ** 2 + (z - w) ** 2
    return volume * volume / (length * length * length)


@njit(**HELPER)
def plan(flips, n, p, q, a, b, c):
    """Best triangles across the ring of p, q, without edges that pierce a, b, c; whether any."""
    ring = flips.ring
    worth = flips.worth
    apex = flips.apex
    for i in range(n - 1):
        worth[WIDEST * i + i + 1] = 1e300
    for width in range(2, n):
        for i in range(n - width):
            j = i + width
            best = -1.0
            if width == n - 1 or not pierces(flips, ring[i], ring[j], a, b, c):
                for m in range(i + 1, j):
                    value = min(worth[WIDEST * i + m], worth[WIDEST * m + j])
                    if value <= best:
                        continue
                    value = min(value, shape_of(flips, ring[i], ring[m], ring[j], q))
                    if value <= best:
                        continue
                    value = min(value, shape_of(flips, ring[i], ring[j], ring[m], p))
                    if value > best:
                        best = value
                        apex[WIDEST * i + j] = m
            worth[WIDEST * i + j] = best
    return worth[n - 1] > 0.0


@njit(**HELPER)
def rebuild(flips, n, p, q):
    """Replace the tetrahedra around the edge p, q by those of the plan."""
    vert = flips.vert
    ring = flips.ring
    for k in range(n):
        give_slot(flips, flips.tets[k])
    # Intervals of the ring still to be filled; the faces across their chord, above and below.
    todo = flips.tets
    todo[0] = n - 1
    todo[1] = flips.above[n - 1]
    todo[2] = flips.below[n - 1]
    height = 3
    while height > 0:
        height -= 3
        i = todo[height] // WIDEST
        j = todo[height] % WIDEST
        over = todo[height + 1]
        under = todo[height + 2]
        m = flips.apex[WIDEST * i + j]
        top = 4 * take_slot(flips)
        low = 4 * take_slot(flips)
        vert[top], vert[top + 1], vert[top + 2], vert[top + 3] = ring[i], ring[m], ring[j], q
        vert[low], vert[low + 1], vert[low + 2], vert[low + 3] = ring[i], ring[j], ring[m], p
        join(flips, top + 3, low + 3)
        join(flips, top + 1, over)
        join(flips, low + 2, under)
        settle(flips, top >> 2)
        settle(flips, low >> 2)
        if m == i + 1:
            join(flips, top + 2, flips.above[i])
            join(flips, low + 1, flips.below[i])
        else:
            todo[height] = WIDEST * i + m
            todo[height + 1] = top + 2
            todo[height + 2] = low + 1
            height += 3
        if j == m + 1:
            join(flips, top, flips.above[m])
            join(flips, low, flips.below[m])
        else:
            todo[height] = WIDEST * m + j
            todo[height + 1] = top
            todo[height + 2] = low
            height += 3


@njit(**HELPER)
def remove_edge(flips, t, p, q, a, b, c):
    """Remove the edge p, q of t, if it need not stay; new ones do not pierce a, b, c.

    Returns whether it was done.
    """
    if does_stay(flips, p, q):
        return False
    n = find_ring(flips, t, p, q)
    if n < 3 or not plan(flips, n, p, q, a, b, c):
        return False
    rebuild(flips, n, p, q)
    return True

"""Delaunay triangulation of points, by insertion in rounds along a Hilbert curve.

The rounds (BRIO: Amenta, Choi, Rote 2003) keep the cavities small whatever the input, the curve
keeps the walk from one point to the next short.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .pointers import ENTRY, HELPER, pointer
from .triangulation import (
    COLLINEAR,
    DONE,
    DUPLICATE,
    NONE,
    ROOM,
    SLICE,
    Net,
    fan,
    gather,
    orient_vertices,
    walk,
)

ORDER = np.int64(16)
NUMBER_BITS = np.int64(28)
ZERO = np.int64(0)
FIRST_SIZE = np.int64(4)


@njit(**HELPER)
def hilbert(x, y):
    """Distance along the Hilbert curve of the cell (x, y) of a 2^16 by 2^16 grid."""
    d = ZERO
    last = (1 << ORDER) - 1
    s = 1 << (ORDER - 1)
    while s > 0:
        rx = 1 if x & s > 0 else 0
        ry = 1 if y & s > 0 else 0
        d += s * s * (3 * rx ^ ry)
        if ry == 0:
            if rx == 1:
                x = last - x
                y = last - y
            x, y = y, x
        s >>= 1
    return d


@njit(**ENTRY)
def curve_keys(points, rounds, keys):
    """keys[i] = (insertion round, place on the Hilbert curve, i) of points[i] as one integer.

    Rounds, at most 8, are drawn by a fixed xorshift generator: each holds eight times as many
    points as the one before. The number i, of 28 bits, makes keys differ: their order, and with it
    every mesh, does not depend on how they are sorted.
    """
    xy = pointer(points)
    key = pointer(keys)
    n = keys.shape[0]
    x0 = xy[0]
    x1 = x0
    y0 = xy[1]
    y1 = y0
    for i in range(n):
        x = xy[2 * i]
        y = xy[2 * i + 1]
        x0 = min(x0, x)
        x1 = max(x1, x)
        y0 = min(y0, y)
        y1 = max(y1, y)
    width = max(x1 - x0, y1 - y0)
    scale = 65535.0 / width if width > 0.0 else 0.0
    state = np.uint64(88172645463325252)
    for i in range(n):
        state ^= state << np.uint64(13)
        state ^= state >> np.uint64(7)
        state ^= state << np.uint64(17)
        level = rounds
        draw = state >> np.uint64(20)
        while level > 0 and draw & np.uint64(7) == 0:
            level -= 1
            draw >>= np.uint64(3)
        place = hilbert(np.int64((xy[2 * i] - x0) * scale), np.int64((xy[2 * i + 1] - y0) * scale))
        key[i] = (level << 32 | place) << NUMBER_BITS | i


@njit(**HELPER)
def first_triangle(net, a, b, c):
    """One counter-clockwise triangle and its three ghosts."""
    net.origin[0] = a
    net.origin[1] = b
    net.origin[2] = c
    for t in range(0, 16, 4):
        net.origin[t + 3] = 0
        net.twin[t + 3] = -1
    for i in range(3):
        g = 4 * (i + 1)
        net.origin[g] = net.origin[(i + 1) % 3]
        net.origin[g + 1] = net.origin[i]
        net.origin[g + 2] = -1
        net.twin[i] = g
        net.twin[g] = i
        net.twin[g + 1] = 4 * ((i + 2) % 3 + 1) + 2
        net.twin[g + 2] = 4 * ((i + 1) % 3 + 1) + 1


@njit(**HELPER)
def seed(net, n, counts):
    """Choose three points that are not collinear, the first ones that will do."""
    xy = net.xy
    i = 1
    while i < n and xy[2 * i] == xy[0] and xy[2 * i + 1] == xy[1]:
        i += 1
    j = i + 1
    o = 0.0
    while j < n:
        o = orient_vertices(xy, ZERO, i, j)
        if o != 0.0:
            break
        j += 1
    if j >= n:
        return COLLINEAR
    if o > 0.0:
        first_triangle(net, ZERO, i, j)
    else:
        first_triangle(net, ZERO, j, i)
    counts[1] = FIRST_SIZE
    counts[2] = i
    counts[3] = j
    return DONE


@njit(**ENTRY)
def insert_points(points, origin, twin, sub, work, counts, until):
    """Insert points counts[0] … until - 1, in this order, into the Delaunay triangulation.

    counts: next point, triangles, second and third point of the first triangle, triangle to
    start walking from, the two duplicates found. Arrays hold 4 (2 n + 2) half-edges.
    """
    room = work.shape[1]
    net = Net(
        pointer(points),
        pointer(origin),
        pointer(twin),
        pointer(sub),
        pointer(work[0]),
        pointer(work[1]),
        pointer(work[2]),
        pointer(work[3]),
        pointer(work[4]),
    )
    xy = net.xy
    if counts[1] == 0:
        status = seed(net, until, counts)
        if status != DONE:
            return status
        counts[0] = 1
    n_triangles = counts[1]
    t = counts[4]
    p = counts[0]
    effort = 0
    status = DONE
    while p < until:
        if p == counts[2] or p == counts[3]:
            p += 1
            continue
        if effort > 400000:
            status = SLICE
            break
        x = xy[2 * p]
        y = xy[2 * p + 1]
        t = walk(xy, net.origin, net.twin, t, x, y, ZERO)
        for e in range(3):
            v = net.origin[t + e]
            if v >= 0 and xy[2 * v] == x and xy[2 * v + 1] == y:
                counts[5] = v
                status = DUPLICATE
        if status != DONE:
            break
        n_ring = gather(net, t, NONE, x, y, room)
        if n_ring < 0:
            status = ROOM
            break
        n_triangles = fan(net, n_triangles, p, n_ring, NONE)
        t = net.cavity[0]
        effort += n_ring
        p += 1
    counts[0] = p
    counts[1] = n_triangles
    counts[4] = t
    return status

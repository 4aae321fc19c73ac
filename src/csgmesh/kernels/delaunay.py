"""Delaunay triangulation of points, by insertion one after the other in a given order."""

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

ZERO = np.int64(0)
FIRST_SIZE = np.int64(4)


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

"""Fill the inside of a triangulated domain with given points, away from its boundary."""

from __future__ import annotations

import numpy as np
from numba import njit

from .pointers import ENTRY, HELPER, pointer
from .triangulation import (
    DONE,
    NONE,
    ROOM,
    SLICE,
    Net,
    fan,
    following,
    gather,
    orient_point,
    preceding,
)


@njit(**HELPER)
def stroll(net, t, x, y, seed):
    """Walk from triangle t to the one that holds (x, y), across subsegments.

    Beside subsegments the triangulation is not Delaunay, and a walk by fixed rules could go round
    in circles: the side to be tried first is drawn (Devillers, Pion, Teillaud 2002).
    """
    draw = seed
    h = t
    for e in range(3):
        if net.origin[t + e] < 0:
            h = net.twin[following(t + e)]
    entered = False
    while True:
        draw = (draw * 1103515245 + 12345) & 0x7FFFFFFF
        first = preceding(h) if draw >> 16 & 1 != 0 else following(h)
        second = following(h) if first == preceding(h) else preceding(h)
        if net.origin[h] | net.origin[first] | net.origin[second] < 0:
            return h & ~3
        if orient_point(net.xy, net.origin[first], net.origin[following(first)], x, y) < 0.0:
            h = net.twin[first]
        elif orient_point(net.xy, net.origin[second], net.origin[following(second)], x, y) < 0.0:
            h = net.twin[second]
        elif not entered and (
            orient_point(net.xy, net.origin[h], net.origin[following(h)], x, y) < 0.0
        ):
            h = net.twin[h]
        else:
            return h & ~3
        entered = True


@njit(**HELPER)
def squared_distance(xy, a, b, x, y):
    """Squared distance of (x, y) from the segment a–b."""
    ux = xy[2 * b] - xy[2 * a]
    uy = xy[2 * b + 1] - xy[2 * a + 1]
    px = x - xy[2 * a]
    py = y - xy[2 * a + 1]
    share = min(max((px * ux + py * uy) / (ux * ux + uy * uy), 0.0), 1.0)
    px -= share * ux
    py -= share * uy
    return px * px + py * py


@njit(**HELPER)
def is_free(net, n_ring, x, y, from_vertex, from_segment):
    """Whether (x, y) keeps its distances (squared) from vertices and subsegments around it."""
    xy = net.xy
    for i in range(n_ring):
        v = net.ring_from[i]
        if v < 0:
            return False
        dx = xy[2 * v] - x
        dy = xy[2 * v + 1] - y
        if dx * dx + dy * dy < from_vertex:
            return False
        if net.ring_sub[i] >= 0:
            w = net.ring_from[i + 1 if i + 1 < n_ring else 0]
            if squared_distance(xy, v, w, x, y) < from_segment:
                return False
    return True


@njit(**ENTRY)
def fill(points, origin, twin, sub, work, candidates, counts, distances):
    """Insert those candidates that lie inside, keep their distance and do not encroach.

    counts: points, triangles, next candidate, triangle to start from. distances: squared ones
    allowed from vertices and from subsegments. There must be room for all.
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
    given = pointer(candidates)
    n = candidates.shape[0] // 2
    p = counts[0]
    n_triangles = counts[1]
    i = counts[2]
    t = counts[3]
    effort = 0
    status = DONE
    while i < n:
        if effort > 400000:
            status = SLICE
            break
        x = given[2 * i]
        y = given[2 * i + 1]
        t = stroll(net, t, x, y, np.int64(i))
        effort += 3
        if net.twin[t + 3] >= 0:
            n_ring = gather(net, t, NONE, x, y, room)
            if n_ring < 0:
                status = ROOM
                break
            effort += n_ring
            if is_free(net, n_ring, x, y, distances[0], distances[1]):
                net.xy[2 * p] = x
                net.xy[2 * p + 1] = y
                n_triangles = fan(net, n_triangles, p, n_ring, net.twin[t + 3])
                p += 1
                t = net.cavity[0]
        i += 1
    counts[0] = p
    counts[1] = n_triangles
    counts[2] = i
    counts[3] = t
    return status

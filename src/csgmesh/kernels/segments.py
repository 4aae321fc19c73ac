"""Recover segments in a Delaunay triangulation, and flood the regions they bound."""

from __future__ import annotations

import numpy as np
from numba import njit

from .pointers import ENTRY, HELPER, pointer
from .predicates import incircle
from .triangulation import (
    CROSSING,
    DONE,
    LEAK,
    NONE,
    ON_SEGMENT,
    ROOM,
    SLICE,
    Net,
    flip,
    following,
    is_subsegment,
    orient_vertices,
    preceding,
    set_subsegment,
)

FOUND = np.int64(20)
CROSSED = np.int64(21)
TOUCHED = np.int64(22)
UNKNOWN = np.int64(-2)


@njit(**HELPER)
def look(net, h, b):
    """Turn around the origin a of h to the direction of b.

    Returns FOUND and the half-edge a→b; CROSSED and the edge opposite a that a–b crosses; or
    TOUCHED and the half-edge to a vertex that lies between a and b.
    """
    xy = net.xy
    a = net.origin[h]
    known = False
    right = 0.0
    while True:
        u = net.origin[following(h)]
        w = net.origin[preceding(h)]
        if u == b:
            return FOUND, h
        if u < 0 or w < 0:
            known = False
        else:
            if not known:
                right = orient_vertices(xy, a, u, b)
            left = orient_vertices(xy, a, w, b)
            if right == 0.0:
                ahead = (xy[2 * u] - xy[2 * a]) * (xy[2 * b] - xy[2 * a])
                ahead += (xy[2 * u + 1] - xy[2 * a + 1]) * (xy[2 * b + 1] - xy[2 * a + 1])
                if ahead > 0.0:
                    return TOUCHED, h
            if right > 0.0 and left < 0.0:
                return CROSSED, following(h)
            right = left
            known = True
        h = net.twin[preceding(h)]


@njit(**HELPER)
def survey(net, h, a, b, found):
    """Follow a–b across edge h to b, changing nothing; says what stands in the way, if anything."""
    while True:
        if is_subsegment(net.origin, h):
            found[0] = net.sub[h]
            return CROSSING
        g = net.twin[h]
        o = net.origin[preceding(g)]
        if o == b:
            return DONE
        side = orient_vertices(net.xy, a, b, o)
        if side == 0.0:
            found[0] = o
            return ON_SEGMENT
        h = preceding(g) if side < 0.0 else following(g)


@njit(**HELPER)
def lowers(net, a, b, n, u, o, w):
    """Whether turning u–w (u right, w left of a–b) into n–o brings the triangulation nearer a–b.

    Lift each vertex by its distance from the line a–b, a convex function: flips that lower the
    lifted surface can never cycle, are always possible where the surface has a ridge across
    a–b, and there is a ridge as long as an edge crosses a–b.
    """
    yn = orient_vertices(net.xy, a, b, n)
    yo = orient_vertices(net.xy, a, b, o)
    if (yn >= 0.0 and yo >= 0.0) or (yn <= 0.0 and yo <= 0.0):
        return True
    yu = -orient_vertices(net.xy, a, b, u)
    yw = orient_vertices(net.xy, a, b, w)
    # Where the diagonals meet, as a share of the way from u to w.
    on = orient_vertices(net.xy, n, o, u)
    ow = orient_vertices(net.xy, n, o, w)
    share = on / (on - ow)
    y = -yu + share * (yu + yw)
    now = yu + share * (yw - yu)
    after = abs(yn) + (y - yn) / (yo - yn) * (abs(yo) - abs(yn))
    return now > after


@njit(**HELPER)
def sweep(net, vertex_edge, h, a, b, forced, n_stack, room):
    """One pass along a–b from crossed edge h, turning what can be turned.

    The outlines of turned edges go on the stack, to be made Delaunay later. Returns the height of
    the stack, the number of edges turned, and whether room ran out.
    """
    turned = 0
    while True:
        if n_stack + 8 > room:
            return n_stack, turned, True
        g = net.twin[h]
        u = net.origin[h]
        w = net.origin[g]
        n = net.origin[preceding(h)]
        o = net.origin[preceding(g)]
        side = 0.0 if o == b else orient_vertices(net.xy, a, b, o)
        next_left = following(g)
        next_right = preceding(g)
        if (
            orient_vertices(net.xy, n, u, o) > 0.0
            and orient_vertices(net.xy, n, o, w) > 0.0
            and (forced != 0 or lowers(net, a, b, n, u, o, w))
        ):
            flip(net, h)
            turned += 1
            next_left = h
            vertex_edge[u] = h
            vertex_edge[w] = g
            vertex_edge[n] = preceding(h)
            vertex_edge[o] = preceding(g)
            net.stack[n_stack] = h
            net.stack[n_stack + 1] = preceding(h)
            net.stack[n_stack + 2] = g
            net.stack[n_stack + 3] = preceding(g)
            net.stack[n_stack + 4] = following(h)
            n_stack += 5
        if o == b:
            return n_stack, turned, False
        h = next_right if side < 0.0 else next_left


@njit(**HELPER)
def legalise(net, vertex_edge, n_stack, room):
    """Flip to constrained Delaunay whatever is on the stack; returns its height, 0 when done."""
    xy = net.xy
    while n_stack > 0:
        if n_stack + 8 > room:
            return n_stack
        n_stack -= 1
        h = net.stack[n_stack]
        if is_subsegment(net.origin, h):
            continue
        g = net.twin[h]
        u = net.origin[h]
        w = net.origin[g]
        n = net.origin[preceding(h)]
        o = net.origin[preceding(g)]
        if u | w | n | o < 0:
            continue
        if (
            incircle(
                xy[2 * n], xy[2 * n + 1], xy[2 * u], xy[2 * u + 1],
                xy[2 * w], xy[2 * w + 1], xy[2 * o], xy[2 * o + 1],
            )
            > 0.0
        ):  # fmt: skip
            flip(net, h)
            vertex_edge[u] = h
            vertex_edge[w] = g
            vertex_edge[n] = preceding(h)
            vertex_edge[o] = preceding(g)
            net.stack[n_stack] = h
            net.stack[n_stack + 1] = preceding(h)
            net.stack[n_stack + 2] = g
            net.stack[n_stack + 3] = preceding(g)
            n_stack += 4
    return n_stack


@njit(**HELPER)
def recover(net, vertex_edge, a, b, counts, room):
    """Make a–b an edge. Returns a status and the half-edge a→b.

    counts[2] is the height of the stack, counts[3] the effort so far, counts[4:6] what was met.
    """
    passes = 0
    forced = 0
    while True:
        state, h = look(net, vertex_edge[a], b)
        if state == FOUND:
            return DONE, h
        if state == TOUCHED:
            counts[4] = net.origin[following(h)]
            return ON_SEGMENT, h
        if passes == 0:
            state = survey(net, h, a, b, net.ring)
            if state != DONE:
                counts[4] = net.ring[0]
                return state, h
        n_stack, turned, full = sweep(net, vertex_edge, h, a, b, forced, counts[2], room)
        counts[2] = n_stack
        counts[3] += turned + 1
        if full:
            return ROOM, h
        # Rounding may hide the last ridges: then turn whatever can be turned.
        forced = 1 if turned == 0 else 0
        passes += 1


@njit(**ENTRY)
def recover_segments(points, origin, twin, sub, work, vertex_edge, ends, counts, n_triangles):
    """Make every subsegment (ends[2 k], ends[2 k + 1]) an edge, from k = counts[0] on.

    counts: next subsegment, first call (1) or not, height of the stack, effort, what was met.
    Statuses: CROSSING with counts[4] another subsegment that crosses or covers this one;
    ON_SEGMENT with counts[4] a vertex on it.
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
    edge_of = pointer(vertex_edge)
    end = pointer(ends)
    count = pointer(counts)
    if count[1] != 0:
        count[1] = 0
        for h in range(4 * n_triangles):
            if h & 3 != 3 and net.origin[h] >= 0:
                edge_of[net.origin[h]] = h
    n = ends.shape[0] // 2
    count[3] = 0
    while count[0] < n or count[2] > 0:
        if count[2] > 0 and count[5] == 0:
            count[2] = legalise(net, edge_of, count[2], room)
            if count[2] > 0:
                return ROOM
            continue
        if count[3] > 400000:
            return SLICE
        k = count[0]
        state, h = recover(net, edge_of, end[2 * k], end[2 * k + 1], count, room)
        # Nothing may be made Delaunay again in the middle of a recovery: that would undo it.
        count[5] = 1 if state == ROOM else 0
        if state != DONE:
            return state
        if is_subsegment(net.origin, h):
            count[4] = net.sub[h]
            return CROSSING
        set_subsegment(net, h, k)
        count[3] += 1
        count[0] = k + 1
    return DONE


@njit(**ENTRY)
def flood_regions(origin, twin, sub, ends, sides, counts, queue, n_triangles):
    """Give each triangle the region of the subsegments around it.

    sides[2 k], sides[2 k + 1] are the regions left and right of subsegment k. LEAK, with a
    subsegment in counts[0], when two regions run into each other.
    """
    here = pointer(origin)
    there = pointer(twin)
    number = pointer(sub)
    end = pointer(ends)
    side = pointer(sides)
    todo = pointer(queue)
    n = 0
    for t in range(0, 4 * n_triangles, 4):
        region = UNKNOWN
        if here[t] | here[t + 1] | here[t + 2] < 0:
            region = NONE
        for e in range(3):
            if is_subsegment(here, t + e):
                k = number[t + e]
                new = side[2 * k] if here[t + e] == end[2 * k] else side[2 * k + 1]
                if region != UNKNOWN and region != new:
                    counts[0] = k
                    return LEAK
                region = new
        there[t + 3] = region
        if region != UNKNOWN:
            todo[n] = t
            n += 1
    while n > 0:
        n -= 1
        t = todo[n]
        region = there[t + 3]
        for e in range(3):
            if not is_subsegment(here, t + e):
                o = there[t + e] & ~3
                if there[o + 3] == UNKNOWN:
                    there[o + 3] = region
                    todo[n] = o
                    n += 1
                elif there[o + 3] != region:
                    for f in range(3):
                        if is_subsegment(here, o + f):
                            counts[0] = number[o + f]
                        if is_subsegment(here, t + f):
                            counts[0] = number[t + f]
                    return LEAK
    return DONE

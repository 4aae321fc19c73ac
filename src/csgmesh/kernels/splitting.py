"""Split subsegments on their exact curves."""

from __future__ import annotations

import numpy as np
from numba import njit

from .aim import (
    BACKGROUND,
    C_BLOCKED,
    C_GIVEN_UP,
    C_POINTS,
    C_SUBSEGMENTS,
    C_TODO,
    C_TRIANGLES,
    C_WHERE,
    MANY_BLOCKED,
    N_COS2,
    N_SEGMENT,
    N_SIZE,
    N_TINY,
    ONE,
    badness,
)
from .background import background_size
from .curves import BOTH, split_place
from .pointers import HELPER
from .queue import push
from .triangulation import (
    DONE,
    NONE,
    ROOM,
    STUCK,
    clear_subsegment,
    fan,
    following,
    gather,
    in_conflict,
    orient_point,
    preceding,
    set_subsegment,
    walk,
)

# What `find_ends` and `open_cavity` may say instead of a half-edge or a number of edges.
CLEAR = np.int64(-1)
OCCUPIED = np.int64(-2)
CANNOT = np.int64(-2)
#: Cosine of 50 degrees, by which the curve of a subsegment turns at most.
WIDE = 0.6427876


@njit(**HELPER)
def lens(aim):
    """Cosine of how far an angle may fall short of 180 degrees within a subsegment's lens.

    Without a size that is twice the smallest angle, so that with the subsegment every vertex in the
    lens makes a skinny triangle, or the largest turn of a curve, so that the lens holds the curve.
    Splits are fewer than with the whole diametral circle (Chew 1993; Shewchuk 2002). With a size
    it is 90 degrees: the lens is that circle, which keeps edges as long as they are wanted.
    """
    if aim.graded != 0 or aim.number[N_SIZE] > 0.0:
        return 0.0
    return min(2.0 * aim.number[N_COS2] - 1.0, WIDE)


@njit(**HELPER)
def encroached(xy, a, b, x, y, edge):
    """Whether (x, y) lies inside the diametral lens of a–b; `edge` as `lens` says."""
    ax = xy[2 * a] - x
    ay = xy[2 * a + 1] - y
    bx = xy[2 * b] - x
    by = xy[2 * b + 1] - y
    dot = ax * bx + ay * by
    return dot < 0.0 and dot * dot > edge * edge * (ax * ax + ay * ay) * (bx * bx + by * by)


@njit(**HELPER)
def squared_length(xy, a, b):
    dx = xy[2 * b] - xy[2 * a]
    dy = xy[2 * b + 1] - xy[2 * a + 1]
    return dx * dx + dy * dy


@njit(**HELPER)
def can_split(subs, k):
    return subs.segment[k] >= 0


@njit(**HELPER)
def want_split(net, subs, aim, h):
    """Put the subsegment of half-edge h on the stack; False if it cannot be split further."""
    if not can_split(subs, net.sub[h]):
        return False
    n = aim.count[C_TODO]
    aim.todo[3 * n] = h
    aim.todo[3 * n + 1] = net.origin[h]
    aim.todo[3 * n + 2] = net.origin[following(h)]
    aim.count[C_TODO] = n + 1
    return True


@njit(**HELPER)
def is_poor(net, aim, h, v):
    """Whether the subsegment of h is encroached upon by v, on its side, or too long."""
    a = net.origin[h]
    b = net.origin[following(h)]
    if net.twin[h | 3] >= 0 and v >= 0:
        if encroached(net.xy, a, b, net.xy[2 * v], net.xy[2 * v + 1], lens(aim)):
            return True
        if aim.graded != 0:
            size = 0.5 * (aim.size[a] + aim.size[b])
            h2 = size * size
        else:
            h2 = aim.number[N_SIZE]
        return h2 > 0.0 and squared_length(net.xy, a, b) > aim.number[N_SEGMENT] * h2
    return False


@njit(**HELPER)
def queue_fan(net, aim, q, n_ring):
    """Look at the triangles of a new fan."""
    for i in range(n_ring):
        t = net.cavity[i]
        b, _ = badness(net.xy, net.origin, net.twin, aim, t)
        if b >= 0:
            push(q, b, t, net.origin[t + 2])


@njit(**HELPER)
def give_up_split(net, subs, aim, h, k):
    """Subsegment k cannot be split: remember that."""
    set_subsegment(net, h, k)
    subs.segment[k] = -1 - subs.segment[k]
    aim.count[C_GIVEN_UP] = aim.count[C_GIVEN_UP] + 1
    aim.count[C_WHERE] = k
    return DONE


@njit(**HELPER)
def yield_to(net, subs, aim, h, k, blocking):
    """Split subsegment `blocking` first, which stands between subsegment k and its curve."""
    set_subsegment(net, h, k)
    aim.count[C_BLOCKED] = aim.count[C_BLOCKED] + 1
    aim.count[C_WHERE] = k
    if aim.count[C_BLOCKED] > MANY_BLOCKED or not can_split(subs, net.sub[blocking]):
        return STUCK
    want_split(net, subs, aim, h)
    want_split(net, subs, aim, blocking)
    return DONE


@njit(**HELPER)
def halve(xy, subs, aim, k, a, b, p, t):
    """Subsegment k from a to b becomes a–p and p–b; returns the number of the second."""
    new = aim.count[C_SUBSEGMENTS]
    aim.count[C_SUBSEGMENTS] = new + 1
    apex = subs.apex[k]
    subs.ends[2 * new] = p
    subs.ends[2 * new + 1] = b
    subs.ends[2 * k + 1] = p
    subs.segment[new] = subs.segment[k]
    subs.interval[2 * new] = t
    subs.interval[2 * new + 1] = subs.interval[2 * k + 1]
    subs.interval[2 * k + 1] = t
    if apex == BOTH:
        subs.apex[k] = a
        subs.apex[new] = b
        aim.apex_of[2 * p] = a
        aim.apex_of[2 * p + 1] = b
    else:
        subs.apex[new] = apex
        aim.apex_of[2 * p] = apex
        aim.apex_of[2 * p + 1] = -1
    if aim.graded == BACKGROUND:
        x, y = xy[2 * p], xy[2 * p + 1]
        aim.size[p], aim.home[p] = background_size(aim.ground, aim.home[a], x, y)
    elif aim.graded != 0:
        aim.size[p] = 0.5 * (aim.size[a] + aim.size[b])
    return new


@njit(**HELPER)
def find_ends(net, a, b, n_ring, x, y):
    """Places of a and b in the cavity's outline, and what is wrong with the outline.

    The third value is CLEAR; OCCUPIED where (x, y) already is a vertex or a or b is missing; or a
    half-edge of a subsegment that (x, y) lies beyond.
    """
    xy = net.xy
    at_a = NONE
    at_b = NONE
    for i in range(n_ring):
        v = net.ring_from[i]
        if v == a:
            at_a = i
        if v == b:
            at_b = i
        if v >= 0:
            if xy[2 * v] == x and xy[2 * v + 1] == y:
                return at_a, at_b, OCCUPIED
            w = net.ring_from[i + 1 if i + 1 < n_ring else 0]
            if net.ring_sub[i] >= 0 and w >= 0 and orient_point(xy, v, w, x, y) <= 0.0:
                return at_a, at_b, net.twin[net.ring[i]]
    return at_a, at_b, OCCUPIED if at_a < 0 or at_b < 0 else CLEAR


@njit(**HELPER)
def open_cavity(net, h, a, b, x, y, room):
    """Gather the cavity of (x, y), which is to replace subsegment h = a→b, just cleared.

    It starts on the point's side of a–b, which it may cross. Returns the number of outline edges;
    -1 without room, CANNOT, or -10 - g where subsegment g stands in the way.
    """
    side = orient_point(net.xy, a, b, x, y)
    if side == 0.0:
        return gather(net, h & ~3, h, x, y, room)
    near = (h if side > 0.0 else net.twin[h]) & ~3
    start = near
    if net.origin[near] | net.origin[near + 1] | net.origin[near + 2] >= 0:
        start = walk(net.xy, net.origin, net.twin, near, x, y, ONE)
        if start < 0:
            return -10 - (-1 - start)
    if not in_conflict(net.xy, net.origin, near, x, y):
        return CANNOT
    return gather(net, start, NONE, x, y, room)


@njit(**HELPER)
def close_cavity(net, subs, aim, q, h, k, at_a, at_b, n_ring, t):
    """Fan the cavity around the new vertex, with a–p and p–b as subsegments."""
    a = net.ring_from[at_a]
    b = net.ring_from[at_b]
    p = aim.count[C_POINTS]
    right = net.twin[net.twin[h] | 3]
    left = net.twin[h | 3]
    aim.count[C_TRIANGLES] = fan(net, aim.count[C_TRIANGLES], p, n_ring, left)
    i = at_a
    while i != at_b:
        net.twin[net.cavity[i] + 3] = right
        i = i + 1 if i + 1 < n_ring else 0
    new = halve(net.xy, subs, aim, k, a, b, p, t)
    set_subsegment(net, net.cavity[at_a] + 2, k)
    set_subsegment(net, net.cavity[at_b] + 2, new)
    aim.count[C_POINTS] = p + 1
    for i in range(n_ring):
        f = net.cavity[i]
        if net.ring_sub[i] >= 0 and is_poor(net, aim, f, p):
            want_split(net, subs, aim, f)
    for i in (at_a, at_b):
        f = net.cavity[i] + 2
        o = net.twin[f]
        if is_poor(net, aim, f, net.origin[preceding(f)]):
            want_split(net, subs, aim, f)
        elif is_poor(net, aim, o, net.origin[preceding(o)]):
            want_split(net, subs, aim, o)
    queue_fan(net, aim, q, n_ring)


@njit(**HELPER)
def split(net, subs, aim, q, h, room):
    """Split the subsegment of half-edge h on its curve. Returns a status."""
    xy = net.xy
    k = net.sub[h]
    if net.origin[h] != subs.ends[2 * k]:
        h = net.twin[h]
    a = net.origin[h]
    b = net.origin[following(h)]
    x, y, t = split_place(xy, subs, k, aim.radius)
    p = aim.count[C_POINTS]
    xy[2 * p] = x
    xy[2 * p + 1] = y
    clear_subsegment(net, h)
    if min(squared_length(xy, a, p), squared_length(xy, b, p)) <= aim.number[N_TINY]:
        return give_up_split(net, subs, aim, h, k)
    n_ring = open_cavity(net, h, a, b, x, y, room)
    if n_ring == -1:
        set_subsegment(net, h, k)
        return ROOM
    if n_ring == CANNOT:
        return give_up_split(net, subs, aim, h, k)
    if n_ring < 0:
        return yield_to(net, subs, aim, h, k, -10 - n_ring)
    at_a, at_b, wrong = find_ends(net, a, b, n_ring, x, y)
    if wrong == OCCUPIED:
        return give_up_split(net, subs, aim, h, k)
    if wrong >= 0:
        return yield_to(net, subs, aim, h, k, wrong)
    aim.count[C_BLOCKED] = 0
    close_cavity(net, subs, aim, q, h, k, at_a, at_b, n_ring, t)
    return DONE

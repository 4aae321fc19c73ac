"""Delaunay refinement of a constrained Delaunay triangulation.

Bad triangles, shortest edge first, get a vertex at their off-centre (Üngör 2004), unless that
encroaches upon a subsegment, which is then split on its exact curve instead (Ruppert 1995).
"""

from __future__ import annotations

from collections import namedtuple
from math import hypot

import numpy as np
from numba import njit

from .curves import BOTH, Subsegments, split_place
from .pointers import ENTRY, HELPER, pointer
from .queue import Queue, bucket, pop, push
from .triangulation import (
    BUDGET,
    DONE,
    NONE,
    ROOM,
    SLICE,
    STUCK,
    Net,
    clear_subsegment,
    fan,
    following,
    gather,
    in_conflict,
    is_subsegment,
    orient_point,
    preceding,
    set_subsegment,
    walk,
)

#: What refinement knows of the wanted mesh. apex_of, radius: up to two apexes on whose segments a
#: vertex lies, radius of an apex's protected shell. size: wanted edge length at each vertex when `graded`.
Aim = namedtuple("Aim", "apex_of radius size graded number todo count")

# Places in `number`.
N_COS2 = 0  # squared cosine of the smallest angle
N_OFF = 1  # distance of the off-centre from its edge, as a share of the edge
N_CIRCLE = 2  # squared circumradius allowed, as a share of the squared size
N_SEGMENT = 3  # squared length of a subsegment allowed, as a share of the squared size
N_SIZE = 4  # squared size where it is uniform, 0 without
N_SCALE = 5  # 1 / squared diagonal
N_TINY = 6  # squared length below which nothing is split

# Places in `count`.
C_POINTS = 0
C_TRIANGLES = 1
C_SUBSEGMENTS = 2
C_TODO = 3  # height of the stack of subsegments to split
C_FIRST = 4  # the next triangle to look at for the first time, in half-edges
C_LIMIT = 5  # points allowed
C_BLOCKED = 6  # splits in a row that another subsegment stood in the way of
C_GIVEN_UP = 7  # triangles left bad because nothing could be split further
C_WHERE = 8  # subsegment that could not be split

ONE = np.int64(1)
ALL_SEEN = np.int64(2**62)
MANY_BLOCKED = 1000
#: Two vertices on segments of one apex are on a common shell if their distances agree this well.
SAME_SHELL = 1e-4


@njit(**HELPER)
def wanted(aim, a, b, c):
    """Squared size at a triangle of vertices a, b, c; 0 without one."""
    if aim.graded != 0:
        h = (aim.size[a] + aim.size[b] + aim.size[c]) / 3.0
        return h * h
    return aim.number[N_SIZE]


@njit(**HELPER)
def same_shell(xy, aim, apex, u, v):
    """Whether u and v lie on a common protected shell of an apex."""
    du = hypot(xy[2 * u] - xy[2 * apex], xy[2 * u + 1] - xy[2 * apex + 1])
    dv = hypot(xy[2 * v] - xy[2 * apex], xy[2 * v + 1] - xy[2 * apex + 1])
    far = max(du, dv)
    return abs(du - dv) <= SAME_SHELL * far and far <= aim.radius[apex] * (1.0 + SAME_SHELL)


@njit(**HELPER)
def excused(xy, aim, u, v):
    """Whether u and v lie on a common shell of an apex of both: then their edge cannot grow."""
    for i in range(2):
        apex = aim.apex_of[2 * u + i]
        if apex >= 0 and (aim.apex_of[2 * v] == apex or aim.apex_of[2 * v + 1] == apex):
            if same_shell(xy, aim, apex, u, v):
                return True
    return False


@njit(**HELPER)
def badness(xy, origin, twin, aim, t):
    """Bucket of a bad triangle, -1 of a good one; and whether it is bad by its angle."""
    if twin[t + 3] < 0:
        return -1, False
    a = origin[t]
    b = origin[t + 1]
    c = origin[t + 2]
    abx = xy[2 * b] - xy[2 * a]
    aby = xy[2 * b + 1] - xy[2 * a + 1]
    bcx = xy[2 * c] - xy[2 * b]
    bcy = xy[2 * c + 1] - xy[2 * b + 1]
    cax = xy[2 * a] - xy[2 * c]
    cay = xy[2 * a + 1] - xy[2 * c + 1]
    ab = abx * abx + aby * aby
    bc = bcx * bcx + bcy * bcy
    ca = cax * cax + cay * cay
    if ab <= bc and ab <= ca:
        dot = bcx * cax + bcy * cay
        shortest = ab
        product = bc * ca
        u = a
        v = b
    elif bc <= ca:
        dot = abx * cax + aby * cay
        shortest = bc
        product = ab * ca
        u = b
        v = c
    else:
        dot = abx * bcx + aby * bcy
        shortest = ca
        product = ab * bc
        u = c
        v = a
    if shortest <= aim.number[N_TINY]:
        return -1, False
    skinny = dot * dot > aim.number[N_COS2] * product
    if skinny and excused(xy, aim, u, v):
        skinny = False
    if not skinny:
        h2 = wanted(aim, a, b, c)
        if h2 <= 0.0:
            return -1, False
        area2 = abx * bcy - aby * bcx
        if ab * bc * ca <= 4.0 * aim.number[N_CIRCLE] * h2 * area2 * area2:
            return -1, False
    return bucket(shortest * aim.number[N_SCALE]), skinny


@njit(**HELPER)
def steiner_place(xy, origin, t, off):
    """Off-centre of triangle t for off > 0, or its circumcentre where that is nearer."""
    a = origin[t]
    b = origin[t + 1]
    c = origin[t + 2]
    ox = xy[2 * a]
    oy = xy[2 * a + 1]
    bx = xy[2 * b] - ox
    by = xy[2 * b + 1] - oy
    cx = xy[2 * c] - ox
    cy = xy[2 * c + 1] - oy
    ex = cx - bx
    ey = cy - by
    bb = bx * bx + by * by
    cc = cx * cx + cy * cy
    ee = ex * ex + ey * ey
    scale = 0.5 / (bx * cy - cx * by)
    dx = (cy * bb - by * cc) * scale
    dy = (bx * cc - cx * bb) * scale
    if off > 0.0:
        if bb < cc and bb < ee:
            fx = 0.5 * bx - off * by
            fy = 0.5 * by + off * bx
            if fx * fx + fy * fy < dx * dx + dy * dy:
                dx = fx
                dy = fy
        elif cc < ee:
            fx = 0.5 * cx + off * cy
            fy = 0.5 * cy - off * cx
            if fx * fx + fy * fy < dx * dx + dy * dy:
                dx = fx
                dy = fy
        else:
            fx = 0.5 * ex - off * ey
            fy = 0.5 * ey + off * ex
            if fx * fx + fy * fy < (dx - bx) * (dx - bx) + (dy - by) * (dy - by):
                dx = bx + fx
                dy = by + fy
    return ox + dx, oy + dy


@njit(**HELPER)
def encroached(xy, a, b, x, y):
    """Whether (x, y) lies inside the diametral circle of a–b."""
    return (xy[2 * a] - x) * (xy[2 * b] - x) + (xy[2 * a + 1] - y) * (xy[2 * b + 1] - y) < 0.0


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
        if encroached(net.xy, a, b, net.xy[2 * v], net.xy[2 * v + 1]):
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
        b, skinny = badness(net.xy, net.origin, net.twin, aim, t)
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
def halve(net, subs, aim, h, k, a, b, p, t):
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
    if aim.graded != 0:
        aim.size[p] = 0.5 * (aim.size[a] + aim.size[b])
    return new


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
    side = orient_point(xy, a, b, x, y)
    through = h if side == 0.0 else NONE
    near = h if side >= 0.0 else net.twin[h]
    start = near & ~3
    if side != 0.0:
        if net.origin[start] | net.origin[start + 1] | net.origin[start + 2] >= 0:
            start = walk(xy, net.origin, net.twin, start, x, y, ONE)
            if start < 0:
                return yield_to(net, subs, aim, h, k, -1 - start)
        if not in_conflict(xy, net.origin, near & ~3, x, y):
            return give_up_split(net, subs, aim, h, k)
    n_ring = gather(net, start, through, x, y, room)
    if n_ring < 0:
        set_subsegment(net, h, k)
        return ROOM
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
                return give_up_split(net, subs, aim, h, k)
            w = net.ring_from[i + 1 if i + 1 < n_ring else 0]
            if net.ring_sub[i] >= 0 and w >= 0 and orient_point(xy, v, w, x, y) <= 0.0:
                return yield_to(net, subs, aim, h, k, net.twin[net.ring[i]])
    if at_a < 0 or at_b < 0:
        return give_up_split(net, subs, aim, h, k)
    aim.count[C_BLOCKED] = 0
    right = net.twin[net.twin[h] | 3]
    left = net.twin[h | 3]
    aim.count[C_TRIANGLES] = fan(net, aim.count[C_TRIANGLES], p, n_ring, left)
    i = at_a
    while i != at_b:
        net.twin[net.cavity[i] + 3] = right
        i = i + 1 if i + 1 < n_ring else 0
    new = halve(net, subs, aim, h, k, a, b, p, t)
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
    return DONE


@njit(**HELPER)
def refused(net, subs, aim, n_ring, x, y):
    """Whether (x, y) encroaches upon subsegments of the cavity's outline.

    Those that can be split go on the stack. Returns 0 (no), 1 (yes), 2 (none can be split).
    """
    answer = 0
    for i in range(n_ring):
        if net.ring_sub[i] >= 0:
            o = net.ring[i]
            if encroached(net.xy, net.origin[o], net.origin[following(o)], x, y):
                if want_split(net, subs, aim, net.twin[o]):
                    answer = 1
                elif answer == 0:
                    answer = 2
    return answer


@njit(**HELPER)
def interpolated(net, aim, t, x, y):
    """Size at (x, y), linear over triangle t."""
    xy = net.xy
    a = net.origin[t]
    b = net.origin[t + 1]
    c = net.origin[t + 2]
    bx = xy[2 * b] - xy[2 * a]
    by = xy[2 * b + 1] - xy[2 * a + 1]
    cx = xy[2 * c] - xy[2 * a]
    cy = xy[2 * c + 1] - xy[2 * a + 1]
    px = x - xy[2 * a]
    py = y - xy[2 * a + 1]
    area = bx * cy - by * cx
    v = min(max((px * cy - py * cx) / area, 0.0), 1.0)
    w = min(max((bx * py - by * px) / area, 0.0), 1.0 - v)
    return (1.0 - v - w) * aim.size[a] + v * aim.size[b] + w * aim.size[c]


@njit(**HELPER)
def improve(net, subs, aim, q, t, stamp, b, room):
    """Deal with bad triangle t of bucket b. Returns a status."""
    xy = net.xy
    bad, skinny = badness(xy, net.origin, net.twin, aim, t)
    if bad < 0:
        return DONE
    x, y = steiner_place(xy, net.origin, t, aim.number[N_OFF] if skinny else 0.0)
    at = walk(xy, net.origin, net.twin, t, x, y, ONE)
    if at < 0:
        if want_split(net, subs, aim, -1 - at):
            push(q, b, t, stamp)
        else:
            aim.count[C_GIVEN_UP] = aim.count[C_GIVEN_UP] + 1
        return DONE
    n_ring = gather(net, at, NONE, x, y, room)
    if n_ring < 0:
        push(q, b, t, stamp)
        return ROOM
    answer = refused(net, subs, aim, n_ring, x, y)
    if answer == 1:
        push(q, b, t, stamp)
        return DONE
    for e in range(3):
        v = net.origin[at + e]
        if xy[2 * v] == x and xy[2 * v + 1] == y:
            answer = 2
    if answer == 2:
        aim.count[C_GIVEN_UP] = aim.count[C_GIVEN_UP] + 1
        return DONE
    p = aim.count[C_POINTS]
    xy[2 * p] = x
    xy[2 * p + 1] = y
    aim.apex_of[2 * p] = -1
    aim.apex_of[2 * p + 1] = -1
    if aim.graded != 0:
        aim.size[p] = interpolated(net, aim, at, x, y)
    aim.count[C_TRIANGLES] = fan(
        net, aim.count[C_TRIANGLES], p, n_ring, net.twin[at + 3]
    )
    aim.count[C_POINTS] = p + 1
    queue_fan(net, aim, q, n_ring)
    return DONE


@njit(**HELPER)
def look_at_all(net, subs, aim, q, room_queue, room_todo):
    """First look at every triangle and subsegment. Returns DONE or ROOM."""
    t = aim.count[C_FIRST]
    while t < 4 * aim.count[C_TRIANGLES]:
        if q.state[1] + 8 > room_queue or aim.count[C_TODO] + 8 > room_todo:
            aim.count[C_FIRST] = t
            return ROOM
        if net.twin[t + 3] >= 0:
            b, skinny = badness(net.xy, net.origin, net.twin, aim, t)
            if b >= 0:
                push(q, b, t, net.origin[t + 2])
            for e in range(3):
                h = t + e
                if is_subsegment(net.origin, h) and is_poor(
                    net, aim, h, net.origin[preceding(h)]
                ):
                    want_split(net, subs, aim, h)
        t += 4
    aim.count[C_FIRST] = ALL_SEEN
    return DONE


@njit(**HELPER)
def is_current(net, h, a, b):
    return (
        net.origin[h] == a and net.origin[following(h)] == b and is_subsegment(net.origin, h)
    )


@njit(**HELPER)
def run(net, subs, aim, q, rooms):
    """Refine until nothing is bad, or room, budget or the slice of time is used up.

    rooms: points, triangles, subsegments, queue entries, stack of subsegments, cavity.
    """
    status = look_at_all(net, subs, aim, q, rooms[3], rooms[4])
    effort = 0
    while status == DONE:
        cavity = 2 * rooms[5]
        if (
            aim.count[C_POINTS] + 1 > rooms[0]
            or aim.count[C_TRIANGLES] + 2 > rooms[1]
            or aim.count[C_SUBSEGMENTS] + 1 > rooms[2]
            or q.state[1] + cavity > rooms[3]
            or aim.count[C_TODO] + cavity > rooms[4]
        ):
            return ROOM
        if aim.count[C_POINTS] >= aim.count[C_LIMIT]:
            return BUDGET
        if effort > 100000:
            return SLICE
        effort += 1
        n = aim.count[C_TODO]
        if n > 0:
            aim.count[C_TODO] = n - 1
            h = aim.todo[3 * n - 3]
            if is_current(net, h, aim.todo[3 * n - 2], aim.todo[3 * n - 1]) and can_split(
                subs, net.sub[h]
            ):
                status = split(net, subs, aim, q, h, rooms[5])
                if status == ROOM:
                    aim.count[C_TODO] = n
        elif q.state[3] > 0:
            b, t, stamp = pop(q)
            if net.origin[t + 2] == stamp:
                status = improve(net, subs, aim, q, t, stamp, b, rooms[5])
        else:
            return DONE
    return status


@njit(**ENTRY)
def refine(
    points, origin, twin, sub, work,
    ends, segment, interval, apex, segment_ends, segment_curve, curve_kind, curve_data,
    buckets, items, state,
    apex_of, radius, size, graded, number, todo, count, rooms,
):  # fmt: skip
    """Refine what the arrays hold (see `Net`, `Subsegments`, `Queue`, `Aim`); returns a status."""
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
    subs = Subsegments(
        pointer(ends),
        pointer(segment),
        pointer(interval),
        pointer(apex),
        pointer(segment_ends),
        pointer(segment_curve),
        pointer(curve_kind),
        pointer(curve_data),
    )
    q = Queue(pointer(buckets[0]), pointer(buckets[1]), pointer(items), pointer(state))
    aim = Aim(
        pointer(apex_of),
        pointer(radius),
        pointer(size),
        graded,
        pointer(number),
        pointer(todo),
        pointer(count),
    )
    return run(net, subs, aim, q, pointer(rooms))

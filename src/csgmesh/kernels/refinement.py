"""Delaunay refinement of a constrained Delaunay triangulation.

Bad triangles, shortest edge first, get a vertex at their off-centre (Üngör 2004), unless that
encroaches upon a subsegment, which is then split on its exact curve instead (Ruppert 1995).
"""

from __future__ import annotations

from numba import njit

from .aim import (
    ALL_SEEN,
    BACKGROUND,
    C_FIRST,
    C_GIVEN_UP,
    C_LIMIT,
    C_POINTS,
    C_REGULAR,
    C_SUBSEGMENTS,
    C_TODO,
    C_TRIANGLES,
    ONE,
    Aim,
    badness,
    steiner_place,
)
from .background import Background, background_size, interpolated
from .curves import Subsegments
from .pointers import ENTRY, HELPER, pointer
from .queue import Queue, pop, push
from .splitting import can_split, encroached, is_poor, lens, queue_fan, split, want_split
from .triangulation import (
    BUDGET,
    DONE,
    NONE,
    ROOM,
    SLICE,
    Net,
    fan,
    following,
    gather,
    is_subsegment,
    preceding,
    walk,
)


@njit(**HELPER)
def refused(net, subs, aim, n_ring, x, y):
    """Whether (x, y) encroaches upon subsegments of the cavity's outline.

    Those that can be split go on the stack. Returns 0 (no), 1 (yes), 2 (none can be split).
    """
    answer = 0
    edge = lens(aim)
    for i in range(n_ring):
        if net.ring_sub[i] >= 0:
            o = net.ring[i]
            a = net.origin[o]
            b = net.origin[following(o)]
            if encroached(net.xy, a, b, x, y, edge):
                if want_split(net, subs, aim, net.twin[o]):
                    answer = 1
                elif answer == 0:
                    answer = 2
    return answer


@njit(**HELPER)
def improve(net, subs, aim, q, t, stamp, b, room):
    """Deal with bad triangle t of bucket b. Returns a status."""
    xy = net.xy
    bad, skinny = badness(xy, net.origin, net.twin, aim, t)
    if bad < 0:
        return DONE
    x, y, near = steiner_place(xy, net.origin, aim, t, skinny)
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
    if aim.graded == BACKGROUND:
        aim.size[p], aim.home[p] = background_size(aim.ground, aim.home[near], x, y)
    elif aim.graded != 0:
        aim.size[p] = interpolated(xy, net.origin, aim.size, at, x, y)
    aim.count[C_TRIANGLES] = fan(net, aim.count[C_TRIANGLES], p, n_ring, net.twin[at + 3])
    aim.count[C_POINTS] = p + 1
    queue_fan(net, aim, q, n_ring)
    return DONE


@njit(**HELPER)
def look_at_all(net, subs, aim, q, room_queue, room_todo):
    """First look at every triangle and subsegment. Returns DONE or ROOM."""
    t = aim.count[C_FIRST]
    until = 4 * min(aim.count[C_TRIANGLES], aim.count[C_REGULAR])
    while t < until:
        if q.state[1] + 8 > room_queue or aim.count[C_TODO] + 8 > room_todo:
            aim.count[C_FIRST] = t
            return ROOM
        if net.twin[t + 3] >= 0:
            b, _ = badness(net.xy, net.origin, net.twin, aim, t)
            if b >= 0:
                push(q, b, t, net.origin[t + 2])
            for e in range(3):
                h = t + e
                if is_subsegment(net.origin, h) and is_poor(net, aim, h, net.origin[preceding(h)]):
                    want_split(net, subs, aim, h)
        t += 4
    aim.count[C_FIRST] = ALL_SEEN
    return DONE


@njit(**HELPER)
def is_current(net, h, a, b):
    return net.origin[h] == a and net.origin[following(h)] == b and is_subsegment(net.origin, h)


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
    home, ground_points, ground_origin, ground_twin, ground_size,
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
        pointer(home),
        Background(
            pointer(ground_points),
            pointer(ground_origin),
            pointer(ground_twin),
            pointer(ground_size),
        ),
    )
    return run(net, subs, aim, q, pointer(rooms))

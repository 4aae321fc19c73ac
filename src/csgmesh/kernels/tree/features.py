"""Which features of a domain pass near which leaves, and which leaves they want smaller.

A feature is a straight piece of a boundary, or a point. It is near a leaf if it meets the leaf's
box grown by a share of its size on all sides, and by how far the exact curve may be from the piece.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .morton import DEPTH, gathered, holder


@njit(**HELPER)
def is_near(ends, f, x, y, w, h, share, slack):
    """Whether feature f meets a box, grown by a share of its size and by the slack."""
    ex = (0.5 + share) * w + slack
    ey = (0.5 + share) * h + slack
    dx = 0.5 * (ends[4 * f + 2] - ends[4 * f])
    dy = 0.5 * (ends[4 * f + 3] - ends[4 * f + 1])
    mx = 0.5 * (ends[4 * f + 2] + ends[4 * f]) - (x + 0.5 * w)
    my = 0.5 * (ends[4 * f + 3] + ends[4 * f + 1]) - (y + 0.5 * h)
    if abs(mx) > ex + abs(dx) or abs(my) > ey + abs(dy):
        return False
    return abs(mx * dy - my * dx) <= ex * abs(dy) + ey * abs(dx)


@njit(**ENTRY)
def hand_down(
    key, level, box, active, offset, item, first, marked, ends, slack, share, new, leaf, place, out
):
    """Hand the features of leaves on to their children.

    leaf, place, out: the leaves with features now, where their lists begin, and the lists; `leaf`
    takes from its far end the leaves that have none any more. new: how many leaves have features,
    how long their lists are, where in `leaf` those without begin.
    """
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    old = pointer(active)
    start = pointer(offset)
    items = pointer(item)
    moved = pointer(first)
    mark = pointer(marked)
    end = pointer(ends)
    bow = pointer(slack)
    to = pointer(leaf)
    begin = pointer(place)
    listed = pointer(out)
    n = 0
    m = 0
    bare = leaf.shape[0]
    for a in range(active.shape[0]):
        i = moved[old[a]]
        for c in range(4 if mark[old[a]] != 0 else 1):
            before = m
            if mark[old[a]] == 0:
                for k in range(start[a], start[a + 1]):
                    listed[m] = items[k]
                    m += 1
            else:
                size = 1 << (DEPTH - levels[i + c])
                x = at[0] + gathered(keys[i + c]) * at[2]
                y = at[1] + gathered(keys[i + c] >> 1) * at[3]
                for k in range(start[a], start[a + 1]):
                    f = items[k]
                    if is_near(end, f, x, y, size * at[2], size * at[3], share, bow[f]):
                        listed[m] = f
                        m += 1
            if m > before:
                to[n] = i + c
                begin[n] = before
                n += 1
            else:
                bare -= 1
                to[bare] = i + c
    begin[n] = m
    new[0] = n
    new[1] = m
    new[2] = bare


@njit(**HELPER)
def clip(ends, f, x, y, w, h, out, o):
    """The part of feature f in a box, to out[o : o + 4]; False if there is none."""
    ax = ends[4 * f]
    ay = ends[4 * f + 1]
    dx = ends[4 * f + 2] - ax
    dy = ends[4 * f + 3] - ay
    low = 0.0
    high = 1.0
    for k in range(2):
        p = ax if k == 0 else ay
        d = dx if k == 0 else dy
        lo = x if k == 0 else y
        hi = x + w if k == 0 else y + h
        if d == 0.0:
            if p < lo or p > hi:
                return False
        else:
            s = (lo - p) / d
            t = (hi - p) / d
            low = max(low, min(s, t))
            high = min(high, max(s, t))
    if low > high:
        return False
    out[o] = ax + low * dx
    out[o + 1] = ay + low * dy
    out[o + 2] = ax + high * dx
    out[o + 3] = ay + high * dy
    return True


@njit(**HELPER)
def nearest_on(part, o, x, y):
    """Share of the way along part[o : o + 4] to the point nearest (x, y)."""
    dx = part[o + 2] - part[o]
    dy = part[o + 3] - part[o + 1]
    square = dx * dx + dy * dy
    if square == 0.0:
        return 0.0
    return min(max(((x - part[o]) * dx + (y - part[o + 1]) * dy) / square, 0.0), 1.0)


@njit(**HELPER)
def gap(part, way):
    """Distance of two parts that do not cross; way: the vector from the first to the second."""
    best = 1e300
    for o in range(0, 8, 4):
        for e in range(0, 4, 2):
            x = part[o + e]
            y = part[o + e + 1]
            s = nearest_on(part, 4 - o, x, y)
            dx = part[4 - o] + s * (part[6 - o] - part[4 - o]) - x
            dy = part[5 - o] + s * (part[7 - o] - part[5 - o]) - y
            square = dx * dx + dy * dy
            if square < best:
                best = square
                way[0] = dx if o == 0 else -dx
                way[1] = dy if o == 0 else -dy
    return sqrt(best)


@njit(**HELPER)
def faces_inside(ends, sides, f, wx, wy):
    """Whether a step (wx, wy) away from feature f leads into the domain."""
    dx = ends[4 * f + 2] - ends[4 * f]
    dy = ends[4 * f + 3] - ends[4 * f + 1]
    turn = dx * wy - dy * wx
    if turn == 0.0:
        return sides[2 * f] >= 0 or sides[2 * f + 1] >= 0
    return sides[2 * f] >= 0 if turn > 0.0 else sides[2 * f + 1] >= 0


@njit(**HELPER)
def shared(vertex, f, g):
    """A vertex that two features have in common, -1 for none."""
    a = vertex[2 * f]
    b = vertex[2 * f + 1]
    if a == vertex[2 * g] or a == vertex[2 * g + 1]:
        return a
    if b == vertex[2 * g] or b == vertex[2 * g + 1]:
        return b
    return -1


@njit(**HELPER)
def is_crowded(f, g, x, y, w, h, ends, vertex, xy, sides, share, part, way):
    """Whether features f and g are nearer to each other, near a leaf, than it is large."""
    side = max(w, h)
    v = shared(vertex, f, g)
    if v >= 0:
        if vertex[2 * f] + vertex[2 * f + 1] == vertex[2 * g] + vertex[2 * g + 1]:
            return False
        dx = x + 0.5 * w - xy[2 * v]
        dy = y + 0.5 * h - xy[2 * v + 1]
        if dx * dx + dy * dy < 6.0 * side * side:
            return False
    if not clip(ends, f, x - 0.5 * w, y - 0.5 * h, 2.0 * w, 2.0 * h, part, 0):
        return False
    if not clip(ends, g, x - 0.5 * w, y - 0.5 * h, 2.0 * w, 2.0 * h, part, 4):
        return False
    distance = gap(part, way)
    if distance >= share * side or distance == 0.0:
        return False
    return faces_inside(ends, sides, f, way[0], way[1]) and faces_inside(
        ends, sides, g, -way[0], -way[1]
    )


@njit(**ENTRY)
def mark_features(
    key,
    level,
    box,
    active,
    offset,
    item,
    is_new,
    ends,
    vertex,
    xy,
    sides,
    wanted,
    share,
    room,
    mark,
):
    """Mark new leaves larger than a feature near them wants, or than a gap between two of them.

    room: 10 numbers to work with. share: of a leaf's size that a gap may not fall below.
    """
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    leaf = pointer(active)
    start = pointer(offset)
    items = pointer(item)
    new = pointer(is_new)
    end = pointer(ends)
    corner = pointer(vertex)
    point = pointer(xy)
    side = pointer(sides)
    want = pointer(wanted)
    part = pointer(room)
    way = pointer(room[8:])
    out = pointer(mark)
    for a in range(active.shape[0]):
        i = leaf[a]
        if new[i] == 0 or out[i] != 0:
            continue
        size = 1 << (DEPTH - levels[i])
        w = size * at[2]
        h = size * at[3]
        x = at[0] + gathered(keys[i]) * at[2]
        y = at[1] + gathered(keys[i] >> 1) * at[3]
        large = False
        for k in range(start[a], start[a + 1]):
            if max(w, h) > want[items[k]]:
                large = True
                break
        k = start[a]
        while k < start[a + 1] and not large:
            for j in range(k + 1, start[a + 1]):
                if is_crowded(
                    items[k], items[j], x, y, w, h, end, corner, point, side, share, part, way
                ):
                    large = True
                    break
            k += 1
        if large:
            out[i] = 1


@njit(**ENTRY)
def pair_pieces(key, level, box, ends, counts, share, stack, piece, leaf):
    """Pairs of straight pieces and leaves near them, by descent from the root.

    counts: next piece, pairs so far. Returns 1 when there is no more room, else 0.
    """
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    end = pointer(ends)
    todo = pointer(stack)
    of = pointer(piece)
    out = pointer(leaf)
    n = key.shape[0]
    f = counts[0]
    m = counts[1]
    while f < ends.shape[0] // 4:
        before = m
        todo[0] = 0
        todo[1] = 0
        todo[2] = 0
        height = 1
        while height > 0:
            height -= 1
            k = todo[3 * height]
            deep = todo[3 * height + 1]
            i = todo[3 * height + 2]
            size = 1 << (DEPTH - deep)
            x = at[0] + gathered(k) * at[2]
            y = at[1] + gathered(k >> 1) * at[3]
            if not is_near(end, f, x, y, size * at[2], size * at[3], share, 0.0):
                continue
            if levels[i] == deep:
                if m >= leaf.shape[0]:
                    counts[0] = f
                    counts[1] = before
                    return 1
                of[m] = f
                out[m] = i
                m += 1
                continue
            step = 1 << (2 * (DEPTH - deep - 1))
            for c in range(4):
                todo[3 * height] = k + c * step
                todo[3 * height + 1] = deep + 1
                i = holder(keys, n, k + c * step, i)
                todo[3 * height + 2] = i
                height += 1
        f += 1
    counts[0] = f
    counts[1] = m
    return 0

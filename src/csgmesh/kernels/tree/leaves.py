"""Leaves of a linear quadtree: split (as those of an octree are), balanced, found."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .morton import DEPTH, gathered, holder, is_inside, key_of


@njit(**ENTRY)
def split_leaves(key, level, marked, new_key, new_level, is_new, first, dim, deepest):
    """Replace leaves marked 1 by their four or eight children; all others are copied.

    dim, deepest: 2 or 3, and the levels below the root that its keys have bits for.
    is_new: 1 for children, and for leaves marked 2, which are to be looked at once more.
    first: new number of each old leaf, or of its first child.
    """
    keys = pointer(key)
    levels = pointer(level)
    mark = pointer(marked)
    out = pointer(new_key)
    out_level = pointer(new_level)
    new = pointer(is_new)
    at = pointer(first)
    n = 0
    for i in range(key.shape[0]):
        k = keys[i]
        deep = levels[i]
        at[i] = n
        if mark[i] & 1 == 0:
            out[n] = k
            out_level[n] = deep
            new[n] = mark[i] >> 1
            n += 1
        else:
            step = 1 << (dim * (deepest - deep - 1))
            for c in range(1 << dim):
                out[n + c] = k + c * step
                out_level[n + c] = deep + 1
                new[n + c] = 1
            n += 1 << dim
    return n


@njit(**HELPER)
def mark_around(keys, levels, mark, n, i, width, corners):
    """Mark the leaves near leaf i that are more than twice its size; how many.

    Leaf i is marked 2 if one of them will still be too large when it has been split.
    """
    wanted = levels[i] - 1
    size = 1 << (DEPTH - wanted)
    x = gathered(keys[i]) & ~(size - 1)
    y = gathered(keys[i] >> 1) & ~(size - 1)
    found = 0
    for dy in range(-1, 2):
        for dx in range(-1, 2):
            if dx == 0 and dy == 0:
                continue
            if corners == 0 and dx != 0 and dy != 0:
                continue
            for k in range(1, width + 1):
                u = x + k * dx * size
                v = y + k * dy * size
                if not is_inside(u, v):
                    break
                j = holder(keys, n, key_of(u, v), i)
                if levels[j] < wanted:
                    if mark[j] & 1 == 0:
                        mark[j] = mark[j] | 1
                        found += 1
                    if levels[j] < wanted - 1:
                        mark[i] = mark[i] | 2
    return found


@njit(**ENTRY)
def mark_unbalanced(key, level, is_new, marked, begin, end, width, corners):
    """Mark leaves more than twice as large as a new leaf near them; how many.

    Near is `width` leaves of twice the new leaf's size. The children of one parent ask for the
    same, so that one of them asks for all.
    """
    keys = pointer(key)
    levels = pointer(level)
    new = pointer(is_new)
    mark = pointer(marked)
    n = key.shape[0]
    found = 0
    for i in range(begin, end):
        deep = levels[i]
        if new[i] == 0 or deep < 2:
            continue
        shift = 2 * (DEPTH - deep + 1)
        if i > 0 and levels[i - 1] == deep and (keys[i - 1] >> shift) == (keys[i] >> shift):
            continue
        found += mark_around(keys, levels, mark, n, i, width, corners)
    return found


@njit(**ENTRY)
def places(key, level, box, out):
    """Lower left corners and sides of leaves, (n, 4): x, y, width, height.

    box: lower left corner and size of a unit place, by coordinate.
    """
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    to = pointer(out)
    for i in range(key.shape[0]):
        size = 1 << (DEPTH - levels[i])
        to[4 * i] = at[0] + gathered(keys[i]) * at[2]
        to[4 * i + 1] = at[1] + gathered(keys[i] >> 1) * at[3]
        to[4 * i + 2] = size * at[2]
        to[4 * i + 3] = size * at[3]


@njit(**ENTRY)
def find_leaves(key, points, box, out):
    """Number of the leaf that holds each point, -1 outside the root."""
    keys = pointer(key)
    xy = pointer(points)
    at = pointer(box)
    to = pointer(out)
    n = key.shape[0]
    near = 0
    for i in range(out.shape[0]):
        u = (xy[2 * i] - at[0]) / at[2]
        v = (xy[2 * i + 1] - at[1]) / at[3]
        if u >= 0.0 and v >= 0.0 and u < 1 << DEPTH and v < 1 << DEPTH:
            near = holder(keys, n, key_of(int(u), int(v)), near)
            to[i] = near
        else:
            to[i] = -1


@njit(**ENTRY)
def adjoining(key, level, i, out):
    """Leaves that share a side or a corner with leaf i, in order; how many."""
    keys = pointer(key)
    levels = pointer(level)
    to = pointer(out)
    n = key.shape[0]
    size = 1 << (DEPTH - levels[i])
    x = gathered(keys[i])
    y = gathered(keys[i] >> 1)
    found = 0
    side = 0
    while side < 4:
        # Along each side from corner to corner, leaf by leaf.
        at = -1
        last = size
        while at <= last and found < out.shape[0]:
            u = x + (at if side < 2 else (-1 if side == 2 else size))
            v = y + (at if side >= 2 else (-1 if side == 0 else size))
            if not is_inside(u, v):
                at += 1 if at < 0 else size
                continue
            j = holder(keys, n, key_of(u, v), i)
            known = False
            for k in range(found):
                if to[k] == j:
                    known = True
            if not known:
                to[found] = j
                found += 1
            far = 1 << (DEPTH - levels[j])
            start = gathered(keys[j]) - x if side < 2 else gathered(keys[j] >> 1) - y
            at = start + far
            if at > last:
                break
        side += 1
    return found

"""Centres and corners of leaves near triangles, by one descent with all triangles.

A node hands to each child the triangles whose boxes come near it, so that a leaf meets few, and a
point is done with as soon as one of them is near. Centres and corners count as near within `share`
times their leaf's side; corners, by the largest leaf around them.
"""

from __future__ import annotations

from collections import namedtuple

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .morton import holder
from .octants import DEEP, gathered_thrice
from .triangle_distance import square_distance

#: Numbers a frame of the descent: key, next child, begin and end of its triangles.
FRAME = 4

#: Pointers: the tree's place and unit, triangles (9 coordinates each), their boxes (6), the numbers
#: that nodes hold one behind the other, corners of leaves, the largest leaf around each corner, and
#: marks of centres and corners.
Search = namedtuple("Search", "at triangle bounds held corner largest near_centre near_corner")


@njit(**ENTRY)
def largest_leaves(level, leaf_corner, out):
    """The first of the largest leaves around each corner."""
    levels = pointer(level)
    corner = pointer(leaf_corner)
    to = pointer(out)
    for j in range(out.shape[0]):
        to[j] = -1
    for i in range(level.shape[0]):
        for c in range(8):
            j = corner[8 * i + c]
            if to[j] < 0 or levels[i] < levels[to[j]]:
                to[j] = i


@njit(**HELPER)
def box_triangles(to, begin, n):
    """Write the boxes of n triangles, and hold them all."""
    tri = to.triangle
    for t in range(n):
        to.held[t] = t
        o = 9 * (begin + t)
        for d in range(3):
            to.bounds[6 * t + d] = min(tri[o + d], tri[o + 3 + d], tri[o + 6 + d])
            to.bounds[6 * t + 3 + d] = max(tri[o + d], tri[o + 3 + d], tri[o + 6 + d])


@njit(**HELPER)
def hand_on(to, first, last, lx, ly, lz, wide):
    """Hold, behind first to last, those of these whose boxes meet a cube; where they end."""
    held = to.held
    box = to.bounds
    hx = lx + wide
    hy = ly + wide
    hz = lz + wide
    end = last
    for s in range(first, last):
        t = held[s]
        b = 6 * t
        meets = (
            (box[b] <= hx)
            & (box[b + 3] >= lx)
            & (box[b + 1] <= hy)
            & (box[b + 4] >= ly)
            & (box[b + 2] <= hz)
            & (box[b + 5] >= lz)
        )
        held[end] = t
        end += int(meets)
    return end


@njit(**HELPER)
def is_near(to, begin, first, last, x, y, z, reach):
    """Whether one of the triangles held from first to last is nearer to a point than `reach`."""
    box = to.bounds
    lx = x - reach
    ly = y - reach
    lz = z - reach
    hx = x + reach
    hy = y + reach
    hz = z + reach
    for s in range(first, last):
        t = to.held[s]
        b = 6 * t
        meets = (
            (box[b] < hx)
            & (box[b + 3] > lx)
            & (box[b + 1] < hy)
            & (box[b + 4] > ly)
            & (box[b + 2] < hz)
            & (box[b + 5] > lz)
        )
        if meets and square_distance(to.triangle, begin + t, x, y, z) < reach * reach:
            return True
    return False


@njit(**HELPER)
def mark_leaf(to, begin, first, last, i, x, y, z, size, share):
    """Mark the centre of leaf i, and those of its corners for which it is the one that counts."""
    unit = to.at[3]
    side = size * unit
    cx = to.at[0] + (x + 0.5 * size) * unit
    cy = to.at[1] + (y + 0.5 * size) * unit
    cz = to.at[2] + (z + 0.5 * size) * unit
    reach = share * side
    if to.near_centre[i] == 0 and is_near(to, begin, first, last, cx, cy, cz, reach):
        to.near_centre[i] = 1
    for c in range(8):
        j = to.corner[8 * i + c]
        if to.largest[j] != i or to.near_corner[j] != 0:
            continue
        px = cx + ((c & 1) - 0.5) * side
        py = cy + (((c >> 1) & 1) - 0.5) * side
        pz = cz + ((c >> 2) - 0.5) * side
        if is_near(to, begin, first, last, px, py, pz, reach):
            to.near_corner[j] = 1


@njit(**HELPER)
def descend(keys, levels, n, to, frame, begin, share):
    """Visit the leaves that triangles come near, from the root's frame on."""
    unit = to.at[3]
    leaf = 0
    deep = 0
    while deep >= 0:
        f = FRAME * deep
        c = frame[f + 1]
        if c == 8:
            deep -= 1
            continue
        frame[f + 1] = c + 1
        size = 1 << (DEEP - deep - 1)
        k = frame[f] + (c << (3 * (DEEP - deep - 1)))
        x = gathered_thrice(k)
        y = gathered_thrice(k >> 1)
        z = gathered_thrice(k >> 2)
        leaf = holder(keys, n, k, leaf)
        is_leaf = levels[leaf] <= deep + 1
        # Leaves further down are at most half as large.
        reach = share * size * unit * (1.0 if is_leaf else 0.5)
        lx = to.at[0] + x * unit - reach
        ly = to.at[1] + y * unit - reach
        lz = to.at[2] + z * unit - reach
        first = frame[f + 3]
        last = hand_on(to, frame[f + 2], first, lx, ly, lz, size * unit + 2.0 * reach)
        if last == first:
            continue
        if is_leaf:
            mark_leaf(to, begin, first, last, leaf, x, y, z, size, share)
            continue
        deep += 1
        f = FRAME * deep
        frame[f] = k
        frame[f + 1] = 0
        frame[f + 2] = first
        frame[f + 3] = last


@njit(**ENTRY)
def mark_near_triangles(
    key,
    level,
    box,
    triangles,
    begin,
    end,
    share,
    leaf_corner,
    largest,
    frames,
    bounds,
    lists,
    near_centre,
    near_corner,
):
    """Mark centres and corners of leaves nearer to triangles than `share` of the leaf's side.

    triangles: (m, 9) coordinates, of which those from begin to end count. largest: see
    `largest_leaves`. frames: scratch for four numbers a level; bounds: for six a triangle; lists:
    for one a triangle and level.
    """
    to = Search(
        pointer(box),
        pointer(triangles),
        pointer(bounds),
        pointer(lists),
        pointer(leaf_corner),
        pointer(largest),
        pointer(near_centre),
        pointer(near_corner),
    )
    levels = pointer(level)
    frame = pointer(frames)
    box_triangles(to, begin, end - begin)
    if levels[0] == 0:
        mark_leaf(to, begin, 0, end - begin, 0, 0, 0, 0, 1 << DEEP, share)
        return
    frame[0] = 0
    frame[1] = 0
    frame[2] = 0
    frame[3] = end - begin
    descend(pointer(key), levels, key.shape[0], to, frame, begin, share)

"""Leaves of a linear octree: balanced, found; the companions in space of `leaves`."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .morton import holder

#: Levels below the root: three times as many bits fit into a key.
DEEP = 20


@njit(**HELPER)
def spread_thrice(x):
    """Bits of x moved apart to every third place."""
    x = (x | (x << 32)) & 0x1F00000000FFFF
    x = (x | (x << 16)) & 0x1F0000FF0000FF
    x = (x | (x << 8)) & 0x100F00F00F00F00F
    x = (x | (x << 4)) & 0x10C30C30C30C30C3
    return (x | (x << 2)) & 0x1249249249249249


@njit(**HELPER)
def gathered_thrice(k):
    """Every third bit of k, moved together: undoes `spread_thrice`."""
    k &= 0x1249249249249249
    k = (k | (k >> 2)) & 0x10C30C30C30C30C3
    k = (k | (k >> 4)) & 0x100F00F00F00F00F
    k = (k | (k >> 8)) & 0x1F0000FF0000FF
    k = (k | (k >> 16)) & 0x1F00000000FFFF
    return (k | (k >> 32)) & 0x00000000001FFFFF


@njit(**HELPER)
def octant_key(x, y, z):
    """Morton key of a place in space."""
    return spread_thrice(x) | (spread_thrice(y) << 1) | (spread_thrice(z) << 2)


@njit(**HELPER)
def is_within(x, y, z):
    """Whether a place lies in the root."""
    return ((x | y | z) >> DEEP) == 0


@njit(**HELPER)
def mark_octants_around(keys, levels, mark, n, i, width, corners):
    """Mark the leaves near leaf i that are more than twice its size; how many."""
    wanted = levels[i] - 1
    size = 1 << (DEEP - wanted)
    x = gathered_thrice(keys[i]) & ~(size - 1)
    y = gathered_thrice(keys[i] >> 1) & ~(size - 1)
    z = gathered_thrice(keys[i] >> 2) & ~(size - 1)
    found = 0
    for dz in range(-1, 2):
        for dy in range(-1, 2):
            for dx in range(-1, 2):
                if dx == 0 and dy == 0 and dz == 0:
                    continue
                if corners == 0 and abs(dx) + abs(dy) + abs(dz) > 1:
                    continue
                for k in range(1, width + 1):
                    u = x + k * dx * size
                    v = y + k * dy * size
                    w = z + k * dz * size
                    if not is_within(u, v, w):
                        break
                    j = holder(keys, n, octant_key(u, v, w), i)
                    if levels[j] < wanted:
                        if mark[j] & 1 == 0:
                            mark[j] = mark[j] | 1
                            found += 1
                        if levels[j] < wanted - 1:
                            mark[i] = mark[i] | 2
    return found


@njit(**ENTRY)
def mark_unbalanced_octants(key, level, is_new, marked, begin, end, width, corners):
    """Mark leaves more than twice as large as a new leaf near them; how many."""
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
        shift = 3 * (DEEP - deep + 1)
        if i > 0 and levels[i - 1] == deep and (keys[i - 1] >> shift) == (keys[i] >> shift):
            continue
        found += mark_octants_around(keys, levels, mark, n, i, width, corners)
    return found


@njit(**ENTRY)
def octant_places(key, level, box, out):
    """Lower corners and sides of leaves, (n, 6)."""
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    to = pointer(out)
    for i in range(key.shape[0]):
        size = 1 << (DEEP - levels[i])
        for d in range(3):
            to[6 * i + d] = at[d] + gathered_thrice(keys[i] >> d) * at[3 + d]
            to[6 * i + 3 + d] = size * at[3 + d]


@njit(**ENTRY)
def find_octants(key, points, box, out):
    """Number of the leaf that holds each point, -1 outside the root."""
    keys = pointer(key)
    xyz = pointer(points)
    at = pointer(box)
    to = pointer(out)
    n = key.shape[0]
    near = 0
    top = 1 << DEEP
    for i in range(out.shape[0]):
        u = (xyz[3 * i] - at[0]) / at[3]
        v = (xyz[3 * i + 1] - at[1]) / at[4]
        w = (xyz[3 * i + 2] - at[2]) / at[5]
        if u >= 0.0 and v >= 0.0 and w >= 0.0 and u < top and v < top and w < top:
            near = holder(keys, n, octant_key(int(u), int(v), int(w)), near)
            to[i] = near
        else:
            to[i] = -1


@njit(**ENTRY)
def pair_boxes(key, level, bounds, counts, stack, item, leaf):
    """Pairs of items and the leaves that their boxes meet, by descent from the root.

    bounds: lowest and highest place of each item, (m, 6), cut to the root. counts: next item, pairs
    so far. Returns 1 when there is no more room, else 0.
    """
    keys = pointer(key)
    levels = pointer(level)
    box = pointer(bounds)
    todo = pointer(stack)
    of = pointer(item)
    out = pointer(leaf)
    n = key.shape[0]
    m = counts[1]
    near = 0
    for f in range(counts[0], bounds.shape[0] // 6):
        before = m
        todo[0] = 0
        todo[1] = 0
        height = 1
        while height > 0:
            height -= 1
            k = todo[2 * height]
            deep = todo[2 * height + 1]
            near = holder(keys, n, k, near)
            if levels[near] <= deep:
                if m == leaf.shape[0]:
                    counts[0] = f
                    counts[1] = before
                    return 1
                of[m] = f
                out[m] = near
                m += 1
                continue
            half = 1 << (DEEP - deep - 1)
            x = gathered_thrice(k)
            y = gathered_thrice(k >> 1)
            z = gathered_thrice(k >> 2)
            for c in range(8):
                u = x + (c & 1) * half
                v = y + ((c >> 1) & 1) * half
                w = z + (c >> 2) * half
                if (
                    box[6 * f] < u + half
                    and box[6 * f + 3] >= u
                    and box[6 * f + 1] < v + half
                    and box[6 * f + 4] >= v
                    and box[6 * f + 2] < w + half
                    and box[6 * f + 5] >= w
                ):
                    todo[2 * height] = k + (c << (3 * (DEEP - deep - 1)))
                    todo[2 * height + 1] = deep + 1
                    height += 1
    counts[0] = bounds.shape[0] // 6
    counts[1] = m
    return 0


@njit(**ENTRY)
def spread_sizes(key, level, box, value, source, growth, backwards):
    """One pass of sizes over the leaves: each takes over the source of a neighbour if that is less.

    The size at a leaf is its source's value and growth times the distance of the two centres,
    beyond half the source's side. Returns how many leaves changed.
    """
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    own = pointer(value)
    src = pointer(source)
    n = key.shape[0]
    changed = 0
    for t in range(n):
        i = n - 1 - t if backwards != 0 else t
        size = 1 << (DEEP - levels[i])
        x = gathered_thrice(keys[i])
        y = gathered_thrice(keys[i] >> 1)
        z = gathered_thrice(keys[i] >> 2)
        for d in range(6):
            step = size if d & 1 else -1
            u = x + (step if d >> 1 == 0 else 0)
            v = y + (step if d >> 1 == 1 else 0)
            w = z + (step if d >> 1 == 2 else 0)
            if not is_within(u, v, w):
                continue
            j = holder(keys, n, octant_key(u, v, w), i)
            if levels[j] > levels[i]:
                continue
            a = reached(keys, levels, at, own, i, src[j], growth)
            if a < reached(keys, levels, at, own, i, src[i], growth):
                src[i] = src[j]
                changed += 1
                continue
            b = reached(keys, levels, at, own, j, src[i], growth)
            if b < reached(keys, levels, at, own, j, src[j], growth):
                src[j] = src[i]
                changed += 1
    return changed


@njit(**HELPER)
def reached(keys, levels, box, value, i, s, growth):
    """Size at the centre of leaf i by source s."""
    if i == s:
        return value[i]
    half = 0.5 * (1 << (DEEP - levels[i]))
    other = 0.5 * (1 << (DEEP - levels[s]))
    square = 0.0
    for d in range(3):
        a = (gathered_thrice(keys[i] >> d) + half - gathered_thrice(keys[s] >> d) - other) * box[
            3 + d
        ]
        square += a * a
    away = square**0.5 - other * box[3]
    return value[s] + growth * max(away, 0.0)


@njit(**ENTRY)
def sizes_at(key, level, points, box, value, source, is_free, growth, out):
    """Sizes at points by the sources of the leaves around them; infinite where a leaf is free."""
    keys = pointer(key)
    levels = pointer(level)
    xyz = pointer(points)
    at = pointer(box)
    own = pointer(value)
    src = pointer(source)
    free = pointer(is_free)
    to = pointer(out)
    n = key.shape[0]
    near = 0
    top = (1 << DEEP) - 1
    for i in range(out.shape[0]):
        u = int(min(max((xyz[3 * i] - at[0]) / at[3], 0.0), top))
        v = int(min(max((xyz[3 * i + 1] - at[1]) / at[4], 0.0), top))
        w = int(min(max((xyz[3 * i + 2] - at[2]) / at[5], 0.0), top))
        near = holder(keys, n, octant_key(u, v, w), near)
        s = src[near]
        if s == near:
            to[i] = 1e300 if free[near] != 0 else own[near]
            continue
        half = 0.5 * (1 << (DEEP - levels[s]))
        square = 0.0
        for d in range(3):
            a = xyz[3 * i + d] - at[d] - (gathered_thrice(keys[s] >> d) + half) * at[3 + d]
            square += a * a
        to[i] = own[s] + growth * max(square**0.5 - half * at[3], 0.0)

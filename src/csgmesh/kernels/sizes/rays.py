"""Where rays first meet a triangle of a boundary.

The triangles hang in a complete binary tree of boxes: node k has the children 2 k and 2 k + 1, leaf
j holds the triangles j * PER_LEAF and following.
"""

from __future__ import annotations

from math import inf

from numba import njit

from ..pointers import ENTRY, HELPER, pointer, scratch

PER_LEAF = 4
#: Shares of an edge by which a ray may miss a triangle: none slips through between two.
SLACK = 1e-9


@njit(**HELPER)
def entry(box, k, place, way, i, least, reach):
    """Where along ray i node k is entered, infinite where it is missed or beyond reach."""
    # A face that the ray starts from is behind it: its long facets, all in one plane, do not count.
    near = least
    far = reach
    for a in range(3):
        p = place[3 * i + a]
        w = way[3 * i + a]
        low = box[6 * k + a]
        high = box[6 * k + 3 + a]
        if w == 0.0:
            if p < low or p > high:
                return inf
            continue
        one = (low - p) / w
        two = (high - p) / w
        near = max(near, min(one, two))
        far = min(far, max(one, two))
    return near if near <= far else inf


@njit(**HELPER)
def meeting(corner, t, place, way, i):
    """Distance along ray i at which it meets triangle t, infinite if it does not.

    T. Möller, B. Trumbore, J. Graphics Tools 2 (1997).
    """
    o = 9 * t
    ax = corner[o + 3] - corner[o]
    ay = corner[o + 4] - corner[o + 1]
    az = corner[o + 5] - corner[o + 2]
    bx = corner[o + 6] - corner[o]
    by = corner[o + 7] - corner[o + 1]
    bz = corner[o + 8] - corner[o + 2]
    wx = way[3 * i]
    wy = way[3 * i + 1]
    wz = way[3 * i + 2]
    px = wy * bz - wz * by
    py = wz * bx - wx * bz
    pz = wx * by - wy * bx
    det = ax * px + ay * py + az * pz
    if det == 0.0:
        return inf
    sx = place[3 * i] - corner[o]
    sy = place[3 * i + 1] - corner[o + 1]
    sz = place[3 * i + 2] - corner[o + 2]
    u = (sx * px + sy * py + sz * pz) / det
    if u < -SLACK or u > 1.0 + SLACK:
        return inf
    qx = sy * az - sz * ay
    qy = sz * ax - sx * az
    qz = sx * ay - sy * ax
    v = (wx * qx + wy * qy + wz * qz) / det
    if v < -SLACK or u + v > 1.0 + SLACK:
        return inf
    return (bx * qx + by * qy + bz * qz) / det


@njit(**ENTRY)
def first_met(triangles, boxes, places, ways, least, found, which):
    """First triangle which[i] on ray i that is further than `least`, at distance found[i].

    triangles: (m, 9) in the order of the tree, boxes: (2 n_leaves, 6); `found` comes with the
    lengths of the rays, `which` with -1.
    """
    corner = pointer(triangles)
    box = pointer(boxes)
    place = pointer(places)
    way = pointer(ways)
    reach = pointer(found)
    met = pointer(which)
    n_leaves = boxes.shape[0] // 12
    stack = scratch(256)
    for i in range(found.shape[0]):
        stack[0] = 1.0
        stack[1] = entry(box, 1, place, way, i, least, reach[i])
        height = 1
        while height > 0:
            height -= 1
            if stack[2 * height + 1] >= reach[i]:
                continue
            k = int(stack[2 * height])
            if k >= n_leaves:
                first = (k - n_leaves) * PER_LEAF
                for t in range(first, first + PER_LEAF):
                    d = meeting(corner, t, place, way, i)
                    if least < d < reach[i]:
                        reach[i] = d
                        met[i] = t
                continue
            left = entry(box, 2 * k, place, way, i, least, reach[i])
            right = entry(box, 2 * k + 1, place, way, i, least, reach[i])
            # The nearer child is looked at first, so it goes on top.
            last = 2 * k + (1 if right < left else 0)
            for child in (4 * k + 1 - last, last):
                b = right if child == 2 * k + 1 else left
                if b < reach[i]:
                    stack[2 * height] = float(child)
                    stack[2 * height + 1] = b
                    height += 1

"""What triangles of a boundary ask of the leaves of an octree that they meet."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .morton import holder
from .octants import DEEP, gathered_thrice
from .triangle_distance import square_distance

#: Half the diagonal of a cube of side 1: no further from its centre is what it meets.
HALF_DIAGONAL = 0.8660254037844387


@njit(**HELPER)
def meets_octant(box, low, x, y, z, size, reach):
    """Whether a box in places, low[6], meets a cube grown by `reach`."""
    return (
        box[low] <= x + size + reach
        and box[low + 3] >= x - reach
        and box[low + 1] <= y + size + reach
        and box[low + 4] >= y - reach
        and box[low + 2] <= z + size + reach
        and box[low + 5] >= z - reach
    )


@njit(**ENTRY)
def demand_sizes(
    key, level, box, triangles, places, wanted, done, begin, end, share, stack, marked, value
):
    """What triangles want of the leaves that they meet.

    With share > 0, mark leaves wider than `share` times what a triangle wants, and note in `done`
    the triangles that are content. With share = 0, lower `value` to what is wanted of each leaf.
    triangles: (m, 9) coordinates; places: (m, 6) their boxes in units of places.
    """
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    tri = pointer(triangles)
    bounds = pointer(places)
    want = pointer(wanted)
    content = pointer(done)
    todo = pointer(stack)
    mark = pointer(marked)
    out = pointer(value)
    n = key.shape[0]
    unit = at[3]
    near = 0
    for t in range(begin, end):
        if share > 0.0 and content[t] != 0:
            continue
        happy = 1
        todo[0] = 0
        todo[1] = 0
        height = 1
        while height > 0:
            height -= 1
            k = todo[2 * height]
            deep = todo[2 * height + 1]
            near = holder(keys, n, k, near)
            size = 1 << (DEEP - deep)
            x = gathered_thrice(k)
            y = gathered_thrice(k >> 1)
            z = gathered_thrice(k >> 2)
            if levels[near] <= deep:
                if share > 0.0 and size * unit <= share * want[t]:
                    continue
                if share == 0.0 and out[near] <= want[t]:
                    continue
                cx = at[0] + (x + 0.5 * size) * unit
                cy = at[1] + (y + 0.5 * size) * unit
                cz = at[2] + (z + 0.5 * size) * unit
                reach = HALF_DIAGONAL * size * unit
                if square_distance(tri, t, cx, cy, cz) <= reach * reach:
                    if share > 0.0:
                        mark[near] = 1
                        happy = 0
                    else:
                        out[near] = want[t]
                continue
            half = size >> 1
            for c in range(8):
                u = x + (c & 1) * half
                v = y + ((c >> 1) & 1) * half
                w = z + (c >> 2) * half
                if meets_octant(bounds, 6 * t, u, v, w, half, 0.0):
                    todo[2 * height] = k + (c << (3 * (DEEP - deep - 1)))
                    todo[2 * height + 1] = deep + 1
                    height += 1
        content[t] = happy

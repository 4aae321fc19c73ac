"""Cells of a rectilinear grid: which lie inside, which are cleaned away, and their arrays.

Grids come padded with one layer of outer cells, z fastest, as flat arrays. A cell holds one more
than the number of its region, 0 outside.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER
from ..tree.triangle_distance import square_distance

#: Cells looked at between two returns to the caller.
SLICE = 3_000_000

#: Corners of a hexahedron as steps along x, y and z.
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    np.int64,
)


@njit(**HELPER)
def first_above(line, value):
    """Number of the first entry of a sorted line that is not below a value."""
    low = 0
    high = line.shape[0]
    while low < high:
        middle = (low + high) // 2
        if line[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


@njit(**ENTRY)
def measure_depths(
    triangles, normal, is_bent, is_outer, x, y, z, reach, near, depth, between, start
):
    """Distances of cells' middles from facets within reach, from facet `start` on; the next one.

    `near` (cells) is set by all facets, `depth` holds squared distances from bent outer ones,
    `between` from interfaces.
    """
    sy = z.shape[0] + 2
    sx = (y.shape[0] + 2) * sy
    square_reach = reach * reach
    work = 0
    for f in range(start, triangles.shape[0]):
        if work > SLICE:
            return f
        t = triangles[f]
        i0 = first_above(x, min(t[0], t[3], t[6]) - reach)
        i1 = first_above(x, max(t[0], t[3], t[6]) + reach)
        j0 = first_above(y, min(t[1], t[4], t[7]) - reach)
        j1 = first_above(y, max(t[1], t[4], t[7]) + reach)
        k0 = first_above(z, min(t[2], t[5], t[8]) - reach)
        k1 = first_above(z, max(t[2], t[5], t[8]) + reach)
        for i in range(i0, i1):
            off_x = (x[i] - t[0]) * normal[f, 0]
            for j in range(j0, j1):
                off_y = off_x + (y[j] - t[1]) * normal[f, 1]
                row = (i + 1) * sx + (j + 1) * sy + 1
                work += k1 - k0 + 1
                for k in range(k0, k1):
                    if abs(off_y + (z[k] - t[2]) * normal[f, 2]) > reach:
                        continue
                    c = row + k
                    if is_bent[f] or not is_outer[f]:
                        square = square_distance(t, 0, x[i], y[j], z[k])
                        if square > square_reach:
                            continue
                        if not is_outer[f]:
                            between[c] = min(between[c], square)
                        else:
                            depth[c] = min(depth[c], square)
                    near[c] = 1
    return triangles.shape[0]


@njit(**ENTRY)
def spread_regions(nx, ny, nz, near, cells):
    """Cells far from all facets get what the cell before them along z has."""
    sy = nz + 2
    for i in range(1, nx + 1):
        for j in range(1, ny + 1):
            row = (i * (ny + 2) + j) * sy
            for c in range(row + 1, row + nz + 1):
                if near[c] == 0:
                    cells[c] = cells[c - 1]


@njit(**HELPER)
def pattern(cells, region, p, sx, sy):
    """Which of the eight cells from `p` on have a region, or any for region 0, as bits."""
    code = 0
    bit = 0
    for a in range(2):
        for b in range(2):
            for c in range(2):
                r = cells[p + a * sx + b * sy + c]
                if (r == region) if region > 0 else (r > 0):
                    code |= 1 << bit
                bit += 1
    return code


@njit(**HELPER)
def neighbour_region(cells, c, sx, sy, own):
    """A region next to a cell other than its own, 0 if there is none."""
    best = 0
    for step in (1, -1, sy, -sy, sx, -sx):
        r = cells[c + step]
        if r != own and r > best:
            best = r
    return best


@njit(**HELPER)
def is_within(r, region):
    return r == region if region > 0 else r > 0


@njit(**ENTRY)
def clean_cells(cells, region, loose, is_loose, depth, broken, shape, around, fill):
    """One round of cleaning of the cells of a region against all others; how many changed.

    For region 0 the cells inside are cleaned against those outside. Cells with at most two
    neighbours are taken away, pits with five or more filled; then cells are filled, or later
    removed, where the eight at a point make no disk. Only loose cells change; `depth` is signed.
    """
    sy = shape[2]
    sx = shape[1] * sy
    changed = 0
    for n in range(loose.shape[0]):
        c = loose[n]
        count = 0
        for step in (1, -1, sy, -sy, sx, -sx):
            if is_within(cells[c + step], region):
                count += 1
        around[n] = count
    for n in range(loose.shape[0]):
        c = loose[n]
        own = is_within(cells[c], region)
        if own and around[n] <= 2:
            cells[c] = 0 if region == 0 else neighbour_region(cells, c, sx, sy, region)
            changed += 1
        elif not own and around[n] >= 5 and depth[n] > -0.25:
            cells[c] = region if region > 0 else neighbour_region(cells, c, sx, sy, 0)
            changed += 1
    for n in range(loose.shape[0]):
        for corner in range(8):
            p = loose[n] - (corner >> 2) * sx - ((corner >> 1) & 1) * sy - (corner & 1)
            code = pattern(cells, region, p, sx, sy)
            if not broken[code]:
                continue
            best = -1
            mends = False
            least = 1e300
            for bit in range(8):
                q = p + (bit >> 2) * sx + ((bit >> 1) & 1) * sy + (bit & 1)
                at = is_loose[q]
                if at < 0 or ((code >> bit) & 1) == fill:
                    continue
                good = not broken[code ^ (1 << bit)]
                far = abs(depth[at])
                if (good and not mends) or (good == mends and far < least):
                    best = q
                    mends = good
                    least = far
            if best < 0:
                continue
            if fill == 1:
                r = region if region > 0 else neighbour_region(cells, best, sx, sy, 0)
            else:
                r = 0 if region == 0 else neighbour_region(cells, best, sx, sy, region)
            if r != cells[best]:
                cells[best] = r
                changed += 1
    return changed


@njit(**ENTRY)
def list_sides(cells, owns, nx, ny, nz, owner, way, writes):
    """Sides of cells towards another region that theirs owns, (axis, up) as 2 axis + up."""
    sy = nz + 2
    sx = (ny + 2) * sy
    n = 0
    for i in range(1, nx + 1):
        for j in range(1, ny + 1):
            row = i * sx + j * sy
            for c in range(row + 1, row + nz + 1):
                r = cells[c]
                if r == 0:
                    continue
                for w in range(6):
                    step = sx if w < 2 else (sy if w < 4 else 1)
                    s = cells[c + step] if w & 1 else cells[c - step]
                    if s != r and owns[r, s]:
                        if writes:
                            owner[n] = c
                            way[n] = w
                        n += 1
    return n


@njit(**ENTRY)
def spread_levels(cells, level, queue, filled, sx, sy, layers):
    """Number cells by layers from those in a queue, through corners; how many there are."""
    at = 0
    while at < filled:
        c = queue[at]
        at += 1
        if level[c] == layers:
            continue
        for a in range(-1, 2):
            for b in range(-1, 2):
                for d in range(-1, 2):
                    q = c + a * sx + b * sy + d
                    if cells[q] > 0 and level[q] == 0:
                        level[q] = level[c] + 1
                        queue[filled] = q
                        filled += 1
    return filled


@njit(**ENTRY)
def fill_deep(cells, level, x, y, z, place, state, points, hexes, region, start):
    """Write points and cells without a level; `state` holds the next point and cell."""
    ny = y.shape[0] - 1
    nz = z.shape[0] - 1
    sy = nz + 2
    sx = (ny + 2) * sy
    py = z.shape[0]
    px = y.shape[0] * py
    point = state[0]
    cell = state[1]
    first = cell
    for i in range(start, x.shape[0] - 1):
        if cell - first > SLICE:
            state[0] = point
            state[1] = cell
            return i
        for j in range(ny):
            row = (i + 1) * sx + (j + 1) * sy + 1
            for k in range(nz):
                c = row + k
                if cells[c] == 0 or level[c] > 0:
                    continue
                for corner in range(8):
                    a = i + CORNERS[corner, 0]
                    b = j + CORNERS[corner, 1]
                    d = k + CORNERS[corner, 2]
                    p = a * px + b * py + d
                    if place[p] < 0:
                        place[p] = point
                        points[point, 0] = x[a]
                        points[point, 1] = y[b]
                        points[point, 2] = z[d]
                        point += 1
                    hexes[cell, corner] = place[p]
                region[cell] = cells[c] - 1
                cell += 1
    state[0] = point
    state[1] = cell
    return x.shape[0] - 1

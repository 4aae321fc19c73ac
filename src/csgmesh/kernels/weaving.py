"""Write the triangles between the rows of a lattice straight into a triangulation.

Rows consist of runs (see `lattice`); the points of two adjacent rows, in the order of u, make a
strip: any three in a row are the corners of triangle u, u that of the middle one. A strip between
two runs is a stretch of such triangles from ``low`` to ``high``.
"""

from __future__ import annotations

from collections import namedtuple

import numpy as np
from numba import njit

from .pointers import ENTRY, HELPER, pointer
from .triangulation import DONE, NONE, SLICE, following, preceding

#: Runs: row, first and last u, place of the first point among all points; how many.
Rows = namedtuple("Rows", "row first last place n")

DOWN = np.int64(-1)
UP = np.int64(1)
# Whether an edge of the outline was found in the triangulation around it.
MISSING = np.int64(10)
SEEN = np.int64(8)


@njit(**ENTRY)
def number_lattice(runs, n_runs, below, above, offset, vertex):
    """Tell the points whose six triangles are all there from those on the outline.

    vertex[i] becomes the number among the former, or -1 - the number among the latter, row by
    row. below, above: first run of the adjacent rows that may touch a run. offset: place of each
    run's first point. Returns both counts.
    """
    row = pointer(runs[0])
    first = pointer(runs[1])
    last = pointer(runs[2])
    under = pointer(below)
    over = pointer(above)
    place = pointer(offset)
    number = pointer(vertex)
    inner = np.int64(0)
    outer = np.int64(0)
    for i in range(n_runs):
        u = first[i]
        p = under[i]
        while p < n_runs and row[p] == row[i] - 1 and first[p] <= last[i]:
            q = over[i]
            while q < n_runs and row[q] == row[i] + 1 and first[q] <= last[i]:
                low = max(first[i] + 2, first[p] + 1, first[q] + 1)
                high = min(last[i] - 2, last[p] - 1, last[q] - 1)
                if low <= high:
                    while u < low:
                        number[place[i] + (u - first[i]) // 2] = -1 - outer
                        outer += 1
                        u += 2
                    while u <= high:
                        number[place[i] + (u - first[i]) // 2] = inner
                        inner += 1
                        u += 2
                q += 1
            p += 1
        while u <= last[i]:
            number[place[i] + (u - first[i]) // 2] = -1 - outer
            outer += 1
            u += 2
    return inner, outer


@njit(**HELPER)
def put_edge(edges, n, a, b, h):
    """List an edge of the outline: places of its ends, half-edge counted within the lattice."""
    edges[3 * n] = a
    edges[3 * n + 1] = b
    edges[3 * n + 2] = h
    return n + 1


@njit(**HELPER)
def at(rows, i, u):
    """Place of point u of run i among all points."""
    return rows.place[i] + (u - rows.first[i]) // 2


@njit(**HELPER)
def put_ends(edges, n, rows, p, i, low, high, base):
    """List the left and the right end of the strip between runs p and i above it."""
    if (low ^ rows.row[i]) & 1 == 0:
        n = put_edge(edges, n, at(rows, i, low), at(rows, p, low - 1), 4 * base + 2)
    else:
        n = put_edge(edges, n, at(rows, i, low - 1), at(rows, p, low), 4 * base + 2)
    h = 4 * (base + high - low)
    if (high ^ rows.row[i]) & 1 == 0:
        return put_edge(edges, n, at(rows, p, high + 1), at(rows, i, high), h + 1)
    return put_edge(edges, n, at(rows, p, high), at(rows, i, high + 1), h)


@njit(**HELPER)
def put_bases(edges, n, rows, r, q, beyond, low, high, base, side):
    """List those edges on run r of a strip's triangles that no strip on the other side shares.

    q: first run that may touch r in row `beyond`, on the other side. side: -1 if the strip lies
    above r, 1 if below.
    """
    u = low + ((low ^ beyond) & 1)
    while u <= high:
        while q < rows.n and rows.row[q] == beyond and min(rows.last[r], rows.last[q]) < u:
            q += 1
        if q < rows.n and rows.row[q] == beyond and max(rows.first[r], rows.first[q]) <= u:
            end = min(rows.last[r], rows.last[q]) + 1
            u = end + ((end ^ beyond) & 1)
        else:
            h = 4 * (base + u - low) + (0 if side < 0 else 1)
            n = put_edge(edges, n, at(rows, r, u + side), at(rows, r, u - side), h)
            u += 2
    return n


@njit(**ENTRY)
def list_strips(runs, n_runs, below, above, offset, strips, first_strip, edges):
    """List the strips between runs, and the outline of all their triangles.

    strips: rows (lower run, upper run, low, high, number of the first triangle, its edge in
    `edges`), as many columns as there can be; first_strip: of each run as the upper one. Returns
    the numbers of strips, triangles and outline edges.
    """
    rows = Rows(
        pointer(runs[0]),
        pointer(runs[1]),
        pointer(runs[2]),
        pointer(offset),
        n_runs,
    )
    under = pointer(below)
    over = pointer(above)
    start = pointer(first_strip)
    edge = pointer(edges)
    strip = pointer(strips)
    n_strips = np.int64(0)
    n_triangles = np.int64(0)
    n_edges = np.int64(0)
    for i in range(n_runs):
        start[i] = n_strips
        p = under[i]
        while p < n_runs and rows.row[p] == rows.row[i] - 1 and rows.first[p] <= rows.last[i]:
            low = max(rows.first[p], rows.first[i])
            high = min(rows.last[p], rows.last[i])
            if low <= high:
                k = 6 * n_strips
                strip[k] = p
                strip[k + 1] = i
                strip[k + 2] = low
                strip[k + 3] = high
                strip[k + 4] = n_triangles
                strip[k + 5] = n_edges
                n_strips += 1
                n_edges = put_ends(edge, n_edges, rows, p, i, low, high, n_triangles)
                n_edges = put_bases(
                    edge, n_edges, rows, p, under[p], rows.row[p] - 1, low, high, n_triangles, DOWN
                )
                n_edges = put_bases(
                    edge, n_edges, rows, i, over[i], rows.row[i] + 1, low, high, n_triangles, UP
                )
                n_triangles += high - low + 1
            p += 1
    start[n_runs] = n_strips
    return n_strips, n_triangles, n_edges


@njit(**HELPER)
def half_edge(here, there, h, b):
    """The half-edge to b out of the origin of h, or -1."""
    first = h
    while here[following(h)] != b:
        h = there[preceding(h)]
        if h == first:
            return NONE
    return h


@njit(**ENTRY)
def find_hole(origin, twin, n_triangles, edges, n_edges, edge_of, outside, regions, hole, found):
    """The triangles inside an outline, which are to be replaced.

    edges: (vertex, vertex, half-edge of the lattice) each, counter-clockwise. edge_of: scratch by
    vertex. outside[k]: half-edge on the other side of outline edge k; regions[k]: region inside.
    Lists the triangles in `hole`, their number in found[0]; MISSING where found[1] is not an edge.
    """
    here = pointer(origin)
    there = pointer(twin)
    edge = pointer(edges)
    some = pointer(edge_of)
    other = pointer(outside)
    region = pointer(regions)
    out = pointer(hole)
    for h in range(4 * n_triangles):
        if h & 3 != 3 and here[h] >= 0:
            some[here[h]] = h
    for k in range(n_edges):
        h = half_edge(here, there, some[edge[3 * k]], edge[3 * k + 1])
        if h < 0:
            found[1] = k
            return MISSING
        other[k] = there[h]
        region[k] = there[h | 3]
        here[h | 3] = here[h | 3] | 1 << (h & 3)
        some[edge[3 * k]] = h
    n = np.int64(0)
    for k in range(n_edges):
        t = there[other[k]] & ~3
        if here[t + 3] & SEEN == 0:
            here[t + 3] = here[t + 3] | SEEN
            out[n] = t
            n += 1
    i = np.int64(0)
    while i < n:
        t = out[i]
        i += 1
        for e in range(3):
            o = there[t + e] & ~3
            if here[t + 3] >> e & 1 == 0 and here[o + 3] & SEEN == 0:
                here[o + 3] = here[o + 3] | SEEN
                out[n] = o
                n += 1
    found[0] = n
    return DONE


@njit(**HELPER)
def slot(hole, n_hole, base, c):
    """Where triangle c of the lattice goes: into the hole first, then behind all others."""
    return hole[c] if c < n_hole else base + 4 * c


@njit(**HELPER)
def place_points(xy, rows, line, number, ring, n_ring, i):
    """Final vertex numbers of run i's points, and coordinates of the new ones."""
    x = line[4 * i]
    y = line[4 * i + 1]
    dx = line[4 * i + 2]
    dy = line[4 * i + 3]
    k = rows.place[i]
    for u in range(rows.first[i], rows.last[i] + 1, 2):
        v = number[k]
        if v < 0:
            number[k] = ring[-1 - v]
        else:
            number[k] = n_ring + v
            xy[2 * (n_ring + v)] = x + u * dx
            xy[2 * (n_ring + v) + 1] = y + u * dy
        k += 1


@njit(**ENTRY)
def place_lattice(points, runs, n_runs, offset, lines, vertex, ring, n_ring):
    """Coordinates of the lattice's points, and the numbers of all of them as vertices.

    lines: origin of u and half step of each run. ring: vertices on the outline, which are there
    already; n_ring: how many vertices there are.
    """
    rows = Rows(
        pointer(runs[0]),
        pointer(runs[1]),
        pointer(runs[2]),
        pointer(offset),
        n_runs,
    )
    for i in range(n_runs):
        place_points(
            pointer(points), rows, pointer(lines), pointer(vertex), pointer(ring), n_ring, i
        )


@njit(**HELPER)
def weave_strip(here, there, rows, number, hole, n_hole, behind, strip, k, region):
    """Write the triangles of strip k, joined to one another."""
    p = strip[6 * k]
    i = strip[6 * k + 1]
    low = strip[6 * k + 2]
    c = strip[6 * k + 4]
    parity = rows.row[i] & 1
    before = NONE
    for u in range(low, strip[6 * k + 3] + 1):
        t = slot(hole, n_hole, behind, c)
        c += 1
        if u & 1 == parity:
            here[t] = number[at(rows, p, u - 1)]
            here[t + 1] = number[at(rows, p, u + 1)]
            here[t + 2] = number[at(rows, i, u)]
            after = t + 1
        else:
            here[t] = number[at(rows, p, u)]
            here[t + 1] = number[at(rows, i, u + 1)]
            here[t + 2] = number[at(rows, i, u - 1)]
            after = t
        here[t + 3] = 0
        there[t + 3] = region
        if before >= 0:
            there[t + 2] = before
            there[before] = t + 2
        before = after


@njit(**HELPER)
def join_strips(there, rows, hole, n_hole, behind, strip, k, j):
    """Join strip k to strip j below it."""
    low = max(strip[6 * k + 2], strip[6 * j + 2])
    low += (low ^ rows.row[strip[6 * k + 1]]) & 1
    upper = strip[6 * k + 4] - strip[6 * k + 2]
    lower = strip[6 * j + 4] - strip[6 * j + 2]
    for u in range(low, min(strip[6 * k + 3], strip[6 * j + 3]) + 1, 2):
        t = slot(hole, n_hole, behind, upper + u)
        o = slot(hole, n_hole, behind, lower + u) + 1
        there[t] = o
        there[o] = t


@njit(**ENTRY)
def weave(
    origin, twin, n_triangles, runs, n_runs, offset, vertex,
    strips, n_strips, first_strip, edges, n_edges, outside, regions, hole, counts,
):  # fmt: skip
    """Write the triangles of all strips, and join them to what surrounds them.

    The first of them go into the n_hole = counts[1] triangles of `hole`, the others behind the
    n_triangles there are. counts[0]: next strip. Returns SLICE until all is done.
    """
    rows = Rows(
        pointer(runs[0]),
        pointer(runs[1]),
        pointer(runs[2]),
        pointer(offset),
        n_runs,
    )
    here = pointer(origin)
    there = pointer(twin)
    strip = pointer(strips)
    start = pointer(first_strip)
    free = pointer(hole)
    number = pointer(vertex)
    n_hole = counts[1]
    behind = 4 * (n_triangles - n_hole)
    effort = 0
    for k in range(counts[0], n_strips):
        if effort > 5000000:
            counts[0] = k
            return SLICE
        effort += strip[6 * k + 3] - strip[6 * k + 2] + 10
        region = regions[strip[6 * k + 5]]
        weave_strip(here, there, rows, number, free, n_hole, behind, strip, k, region)
        p = strip[6 * k]
        for j in range(start[p], start[p + 1]):
            join_strips(there, rows, free, n_hole, behind, strip, k, j)
    edge = pointer(edges)
    other = pointer(outside)
    for k in range(n_edges):
        h = edge[3 * k + 2]
        h = slot(free, n_hole, behind, h >> 2) + (h & 3)
        there[h] = other[k]
        there[other[k]] = h
    return DONE

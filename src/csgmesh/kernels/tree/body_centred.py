"""Body-centred lattices on the leaves of an octree: corners and centres, and tetrahedra of them.

A leaf's centre and corners count as near a surface within `share` times its side; a corner is near
if it is so for one of the leaves around it. With a share above 0.433 no surface passes between a
centre and a corner of one leaf that are both not near: each lies further from it than half their
distance. So what is joined by such pairs lies on one side.
"""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .morton import holder
from .octants import DEEP, gathered_thrice, is_within, octant_key

#: Neighbours that are no leaf of the same size: outside the root or larger; smaller.
NONE = -1
FINER = -2


@njit(**ENTRY)
def number_corners(key, level, table, number, leaf_corner, corner):
    """Number the corners of all leaves as they are first met; how many.

    table, number: scratch, a power of two of entries, table filled with -1. leaf_corner: (n, 8),
    x fastest. corner: (most, 3) places.
    """
    keys = pointer(key)
    levels = pointer(level)
    known = pointer(table)
    numbers = pointer(number)
    out = pointer(leaf_corner)
    place = pointer(corner)
    last = table.shape[0] - 1
    m = 0
    for i in range(key.shape[0]):
        size = 1 << (DEEP - levels[i])
        for c in range(8):
            x = gathered_thrice(keys[i]) + (c & 1) * size
            y = gathered_thrice(keys[i] >> 1) + ((c >> 1) & 1) * size
            z = gathered_thrice(keys[i] >> 2) + (c >> 2) * size
            wanted = x | (y << 21) | (z << 42)
            at = ((wanted * 0x9E3779B97F4A7C1) >> 23) & last
            while known[at] >= 0 and known[at] != wanted:
                at = (at + 1) & last
            if known[at] < 0:
                known[at] = wanted
                numbers[at] = m
                place[3 * m] = x
                place[3 * m + 1] = y
                place[3 * m + 2] = z
                m += 1
            out[8 * i + c] = numbers[at]
    return m


@njit(**HELPER)
def root_of(parent, i):
    """Representative of i, halving the path to it."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(**ENTRY)
def join_leaves(leaf_corner, near_centre, near_corner, parent):
    """Join centres (first) and corners (then) of one leaf that are not near; lowest number leads.

    Afterwards parent leads straight to the representative.
    """
    corner = pointer(leaf_corner)
    centre_flag = pointer(near_centre)
    corner_flag = pointer(near_corner)
    lead = pointer(parent)
    n = near_centre.shape[0]
    for i in range(parent.shape[0]):
        lead[i] = i
    for i in range(n):
        if centre_flag[i] != 0:
            continue
        for c in range(8):
            j = corner[8 * i + c]
            if corner_flag[j] == 0:
                a = root_of(lead, i)
                b = root_of(lead, n + j)
                if a < b:
                    lead[b] = a
                else:
                    lead[a] = b
    for i in range(parent.shape[0]):
        lead[i] = root_of(lead, i)


@njit(**HELPER)
def side_of_edge(tri, o, p, q, x, y, tail_first):
    """+1 where (x, y), displaced by (e, e²), lies left of an edge seen from above, -1 right."""
    if not tail_first:
        p, q = q, p
    dx = tri[o + q] - tri[o + p]
    dy = tri[o + q + 1] - tri[o + p + 1]
    value = dx * (y - tri[o + p + 1]) - dy * (x - tri[o + p])
    if value == 0.0:
        value = -dy
    if value == 0.0:
        value = dx
    sign = 1 if value > 0.0 else (-1 if value < 0.0 else 0)
    return sign if tail_first else -sign


@njit(**ENTRY)
def wind_around(triangles, number, first, last, begin, end, points, out):
    """Add to the winding numbers of a closed surface around points, by rays upwards.

    triangles: (m, 9) coordinates; number: (m, 3) points, so that both triangles of an edge see it
    from the same end. first, last: those that may lie above a point are among first to last.
    """
    tri = pointer(triangles)
    name = pointer(number)
    xyz = pointer(points)
    turns = pointer(out)
    start = pointer(first)
    stop = pointer(last)
    for i in range(begin, end):
        x = xyz[3 * i]
        y = xyz[3 * i + 1]
        z = xyz[3 * i + 2]
        for t in range(start[i], stop[i]):
            o = 9 * t
            if tri[o] < x and tri[o + 3] < x and tri[o + 6] < x:
                continue
            if tri[o] > x and tri[o + 3] > x and tri[o + 6] > x:
                continue
            if tri[o + 1] < y and tri[o + 4] < y and tri[o + 7] < y:
                continue
            if tri[o + 1] > y and tri[o + 4] > y and tri[o + 7] > y:
                continue
            if tri[o + 2] < z and tri[o + 5] < z and tri[o + 8] < z:
                continue
            a = side_of_edge(tri, o, 0, 3, x, y, name[3 * t] < name[3 * t + 1])
            b = side_of_edge(tri, o, 3, 6, x, y, name[3 * t + 1] < name[3 * t + 2])
            c = side_of_edge(tri, o, 6, 0, x, y, name[3 * t + 2] < name[3 * t])
            if a == 0 or a != b or b != c:
                continue
            ux = tri[o + 3] - tri[o]
            uy = tri[o + 4] - tri[o + 1]
            uz = tri[o + 5] - tri[o + 2]
            vx = tri[o + 6] - tri[o]
            vy = tri[o + 7] - tri[o + 1]
            vz = tri[o + 8] - tri[o + 2]
            nx = uy * vz - uz * vy
            ny = uz * vx - ux * vz
            nz = ux * vy - uy * vx
            above = (tri[o] - x) * nx + (tri[o + 1] - y) * ny + (tri[o + 2] - z) * nz
            if (above >= 0.0) == (nz > 0.0):
                turns[i] += a


@njit(**ENTRY)
def list_lattice(key, level, box, leaf_corner, corner, inside, centre_number, corner_number, out):
    """Number the centres and corners inside, leaf by leaf, and write where they are; how many.

    inside: by centres and then corners. Numbers are -1 for those outside.
    """
    keys = pointer(key)
    levels = pointer(level)
    at = pointer(box)
    corners = pointer(leaf_corner)
    place = pointer(corner)
    flag = pointer(inside)
    of_centre = pointer(centre_number)
    of_corner = pointer(corner_number)
    to = pointer(out)
    n = key.shape[0]
    m = 0
    for j in range(corner_number.shape[0]):
        of_corner[j] = -1
    for i in range(n):
        half = 0.5 * (1 << (DEEP - levels[i]))
        of_centre[i] = -1
        if flag[i] != 0:
            of_centre[i] = m
            for d in range(3):
                to[3 * m + d] = at[d] + (gathered_thrice(keys[i] >> d) + half) * at[3 + d]
            m += 1
        for c in range(8):
            j = corners[8 * i + c]
            if flag[n + j] != 0 and of_corner[j] < 0:
                of_corner[j] = m
                for d in range(3):
                    to[3 * m + d] = at[d] + place[3 * j + d] * at[3 + d]
                m += 1
    return m


@njit(**ENTRY)
def beside(key, level, begin, end, out):
    """Leaves of the same size across each side, (n, 6): -x, +x, -y, ...; else NONE or FINER."""
    keys = pointer(key)
    levels = pointer(level)
    to = pointer(out)
    n = key.shape[0]
    for i in range(begin, end):
        size = 1 << (DEEP - levels[i])
        x = gathered_thrice(keys[i])
        y = gathered_thrice(keys[i] >> 1)
        z = gathered_thrice(keys[i] >> 2)
        for d in range(6):
            step = size if d & 1 else -size
            u = x + (step if d >> 1 == 0 else 0)
            v = y + (step if d >> 1 == 1 else 0)
            w = z + (step if d >> 1 == 2 else 0)
            found = NONE
            if is_within(u, v, w):
                j = holder(keys, n, octant_key(u, v, w), i)
                if levels[j] == levels[i]:
                    found = j
                elif levels[j] > levels[i]:
                    found = FINER
            to[6 * i + d] = found


@njit(**ENTRY)
def keep_tetrahedra(next_to, leaf_corner, centre_number, corner_number, begin, end, m, out):
    """Write the regular tetrahedra of leaves `begin` to `end` that are strictly Delaunay.

    Each has the centres of two leaves and an edge of the side between them. It is kept if the four
    leaves around the edge are equal, none beyond the edge's ends is smaller, and the far corners of
    its four neighbours are inside: then its circumsphere holds no point of the lattice nor, where
    near means 0.559 of a side or more, of the surface. Returns how many there are then.
    """
    beside_of = pointer(next_to)
    corner = pointer(leaf_corner)
    of_centre = pointer(centre_number)
    of_corner = pointer(corner_number)
    to = pointer(out)
    for i in range(begin, end):
        if of_centre[i] < 0:
            continue
        for d in range(3):
            j = beside_of[6 * i + 2 * d + 1]
            if j < 0 or of_centre[j] < 0:
                continue
            # The side's corners, counterclockwise seen from leaf j: along e, then along f.
            e = (d + 1) % 3
            f = (d + 2) % 3
            low = 1 << d
            a = of_corner[corner[8 * i + low]]
            b = of_corner[corner[8 * i + low + (1 << e)]]
            g = of_corner[corner[8 * i + low + (1 << e) + (1 << f)]]
            h = of_corner[corner[8 * i + low + (1 << f)]]
            if a < 0 or b < 0 or g < 0 or h < 0:
                continue
            for k in range(4):
                # Sides of the face in turn: at low f, high e, high f, low e.
                across = f if k & 1 == 0 else e
                along = e if k & 1 == 0 else f
                way = 2 * across + (1 if k == 1 or k == 2 else 0)
                p = beside_of[6 * i + way]
                q = beside_of[6 * j + way]
                if p < 0 or q < 0 or of_centre[p] < 0 or of_centre[q] < 0:
                    continue
                if (
                    beside_of[6 * i + 2 * along] == FINER
                    or beside_of[6 * i + 2 * along + 1] == FINER
                    or beside_of[6 * j + 2 * along] == FINER
                    or beside_of[6 * j + 2 * along + 1] == FINER
                ):
                    continue
                tail = a if k == 0 else (b if k == 1 else (g if k == 2 else h))
                head = b if k == 0 else (g if k == 1 else (h if k == 2 else a))
                to[4 * m] = of_centre[i]
                to[4 * m + 1] = tail
                to[4 * m + 2] = head
                to[4 * m + 3] = of_centre[j]
                m += 1
    return m

"""Recovery of triangles: flips until they are faces of tetrahedra.

First the edges of a triangle, by flips of the faces and edges that each one crosses, seen from its
ends; then the triangle, by removal of the edges that pierce it, none of whose successors may do so.
Sources: P. L. George, F. Hecht, E. Saltel, "Automatic mesh generator with specified boundary",
Computer Methods in Applied Mechanics and Engineering 92 (1991); H. Si, "TetGen, a Delaunay-based
quality tetrahedral mesh generator", ACM Transactions on Mathematical Software 41 (2015).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .flips import Flips, find_ring, flip_face, has_ghost, place_of, remove_edge
from .net import DONE, ROOM, SLICE, TETS, orient_vertices, slot_of
from .stars import face_of, star

NONE = np.int64(-1)
#: Flips that an edge or a triangle may take.
MOST_FLIPS = 60
#: Slots that recovering one triangle may fill.
MOST_SLOTS = 4096
#: Triangles after which a kernel returns to its shell.
TURN = 1000


@njit(**HELPER)
def star_of(flips, v, room):
    flips.counts[8] += 2
    return star(
        flips.vert, flips.nei, flips.mark, flips.star, room, flips.home[v], v, flips.counts[8]
    )


@njit(**HELPER)
def tet_with(flips, a, b, room):
    """A tetrahedron that has the edge a, b, or -1."""
    n = star_of(flips, a, room)
    for s in range(n):
        t = flips.star[s]
        for h in range(4 * t, 4 * t + 4):
            if flips.vert[h] == b:
                return t
    return NONE


@njit(**HELPER)
def side_of(flips, t, k, b):
    """The sign of t with vertex b in place of corner k."""
    vert = flips.vert
    h = 4 * t
    return orient_vertices(
        flips.xyz,
        b if k == 0 else vert[h],
        b if k == 1 else vert[h + 1],
        b if k == 2 else vert[h + 2],
        b if k == 3 else vert[h + 3],
    )


@njit(**HELPER)
def clear_way(flips, a, b, room):
    """One flip of what the way from a to b crosses first; whether there was one."""
    vert = flips.vert
    n = star_of(flips, a, room)
    for s in range(n):
        t = flips.star[s]
        if has_ghost(flips, t):
            continue
        i = slot_of(vert, t, a)
        on = 0
        at = NONE
        is_ahead = True
        for turn in range(1, 4):
            k = (i + turn) & 3
            o = side_of(flips, t, k, b)
            if o < 0.0:
                is_ahead = False
                break
            if o == 0.0:
                on += 1
                at = k
        if not is_ahead or on > 1:
            continue
        if on == 1:
            # The way runs in the face opposite to this corner and crosses the edge of the others.
            j = (i + 1) & 3
            while j == at:
                j = (j + 1) & 3
            k = 6 - i - at - j
            return remove_edge(flips, t, vert[4 * t + j], vert[4 * t + k], NONE, NONE, NONE)
        if flip_face(flips, 4 * t + i, NONE, NONE, NONE):
            return True
        for turn in range(1, 4):
            j = (i + turn) & 3
            k = (i + turn % 3 + 1) & 3
            if remove_edge(flips, t, vert[4 * t + j], vert[4 * t + k], NONE, NONE, NONE):
                return True
        return False
    return False


@njit(**HELPER)
def recover_edge(flips, a, b, room):
    """Flip until a, b is an edge; a tetrahedron that has it, or -1."""
    for _ in range(MOST_FLIPS):
        t = tet_with(flips, a, b, room)
        if t >= 0:
            return t
        if not clear_way(flips, a, b, room) and not clear_way(flips, b, a, room):
            return NONE
    return NONE


@njit(**HELPER)
def free_edge(flips, t, p, q, a, b, c):
    """Remove an edge that pierces a, b, c, if need be after flips of faces around it."""
    while True:
        if remove_edge(flips, t, p, q, a, b, c):
            return True
        n = find_ring(flips, t, p, q)
        was_flipped = False
        for k in range(n):
            t = flips.tets[k]
            # The face p, q, ring[k + 1], opposite to ring[k].
            if flip_face(flips, 4 * t + slot_of(flips.vert, t, flips.ring[k]), a, b, c):
                was_flipped = True
                break
        if not was_flipped:
            return False
        # The flip has left p, q in the two tetrahedra that keep the ring's other corners.
        t = NONE
        for k in range(n):
            u = flips.tets[k]
            has_p = False
            has_q = False
            for h in range(4 * u, 4 * u + 4):
                has_p = has_p or flips.vert[h] == p
                has_q = has_q or flips.vert[h] == q
            if has_p and has_q:
                t = u
                break
        if t < 0:
            return False


@njit(**HELPER)
def clear_triangle(flips, a, b, c, room):
    """Remove one edge that pierces a, b, c; whether there was one that could be removed."""
    for _ in range(3):
        t = tet_with(flips, a, b, room)
        n = find_ring(flips, t, a, b) if t >= 0 else np.int64(0)
        for k in range(n):
            u = flips.tets[k]
            p = flips.ring[k]
            q = flips.ring[k + 1 if k + 1 < n else 0]
            if (
                orient_vertices(flips.xyz, a, b, p, c) > 0.0
                and orient_vertices(flips.xyz, a, b, c, q) > 0.0
            ):
                if free_edge(flips, u, p, q, a, b, c):
                    return True
                break
        a, b, c = b, c, a
    return False


@njit(**HELPER)
def face_at(flips, t, a, b, c):
    """Whether a, b, c is a face around the edge a, b of t."""
    is_there = False
    for k in range(find_ring(flips, t, a, b)):
        is_there = is_there or face_of(flips.vert, flips.tets[k], a, b, c) >= 0
    return is_there


@njit(**HELPER)
def recover_triangle(flips, a, b, c, room):
    if recover_edge(flips, a, b, room) < 0:
        return False
    if recover_edge(flips, b, c, room) < 0:
        return False
    if recover_edge(flips, c, a, room) < 0:
        return False
    for _ in range(MOST_FLIPS):
        t = tet_with(flips, a, b, room)
        if t < 0:
            return False
        if face_at(flips, t, a, b, c):
            return True
        if not clear_triangle(flips, a, b, c, room):
            return False
    return False


@njit(**ENTRY)
def recover_triangles(
    points,
    verts,
    neis,
    marks,
    frees,
    homes,
    stays,
    work,
    ring,
    apex,
    worth,
    counts,
    triangles,
    state,
):
    """Flip until triangles are faces, as far as that goes.

    ring: four rows of int64 scratch. state: next triangle, recovered ones.
    """
    room = work.shape[1]
    slots = marks.shape[0]
    flips = Flips(
        pointer(points),
        pointer(verts),
        pointer(neis),
        pointer(marks),
        pointer(frees),
        pointer(homes),
        pointer(stays),
        np.int64(stays.shape[0]),
        pointer(work[0]),
        pointer(ring[0]),
        pointer(ring[1]),
        pointer(ring[2]),
        pointer(ring[3]),
        pointer(worth),
        pointer(apex),
        pointer(counts),
    )
    corner = pointer(triangles)
    until = min(state[0] + TURN, triangles.shape[0] // 3)
    for i in range(state[0], until):
        state[0] = i
        if counts[1] + MOST_SLOTS > slots:
            return TETS
        a = corner[3 * i]
        b = corner[3 * i + 1]
        c = corner[3 * i + 2]
        if (
            star_of(flips, a, room) < 0
            or star_of(flips, b, room) < 0
            or star_of(flips, c, room) < 0
        ):
            return ROOM
        if recover_triangle(flips, a, b, c, room):
            state[1] += 1
    state[0] = until
    return SLICE if until < triangles.shape[0] // 3 else DONE


@njit(**ENTRY)
def mark_edges(edges, stays):
    """Enter edges (2 k,) into a table of a power of two of places, all -1."""
    end = pointer(edges)
    table = pointer(stays)
    n = np.int64(stays.shape[0])
    for i in range(edges.shape[0] // 2):
        at, key = place_of(end[2 * i], end[2 * i + 1], n)
        while table[at] >= 0 and table[at] != key:
            at = (at + 1) & (n - 1)
        table[at] = key

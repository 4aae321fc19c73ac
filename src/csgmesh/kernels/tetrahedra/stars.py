"""The tetrahedra around vertices, and faces found among them."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .net import slot_of

NOWHERE = np.int64(-1)


@njit(**ENTRY)
def vertex_homes(verts, homes, n_tets):
    """home[v] = a tetrahedron of vertex v, -1 if it has none."""
    vert = pointer(verts)
    home = pointer(homes)
    for v in range(homes.shape[0]):
        home[v] = -1
    for t in range(n_tets):
        if vert[4 * t] == -2:
            continue
        for h in range(4 * t, 4 * t + 4):
            if vert[h] >= 0:
                home[vert[h]] = t


@njit(**HELPER)
def star(vert, nei, mark, cavity, room, t, v, stamp):
    """All tetrahedra around v, from t which is one of them, into `cavity`; how many.

    -1 if there are more than `room`.
    """
    cavity[0] = t
    mark[t] = stamp
    n = np.int64(1)
    i = 0
    while i < n:
        t = cavity[i]
        i += 1
        for h in range(4 * t, 4 * t + 4):
            if vert[h] == v:
                continue
            u = nei[h] >> 2
            if mark[u] != stamp:
                if n >= room:
                    return NOWHERE
                mark[u] = stamp
                cavity[n] = u
                n += 1
    return n


@njit(**HELPER)
def face_of(vert, t, a, b, c):
    """Corner of t opposite to the face a, b, c; -1 if it has no such face."""
    odd = NOWHERE
    found = 0
    for h in range(4 * t, 4 * t + 4):
        v = vert[h]
        if v in (a, b, c):
            found += 1
        else:
            odd = h
    return odd if found == 3 else NOWHERE


@njit(**HELPER)
def cell_with(vert, nei, mark, cavity, room, t, v, w, stamp):
    """A tetrahedron of v, from t which is one, that has w, too; -1 for none, -2 for no room."""
    cavity[0] = t
    mark[t] = stamp
    n = np.int64(1)
    i = 0
    while i < n:
        t = cavity[i]
        i += 1
        h = 4 * t
        if vert[h] == w or vert[h + 1] == w or vert[h + 2] == w or vert[h + 3] == w:
            return t
        for h in range(4 * t, 4 * t + 4):
            if vert[h] == v:
                continue
            u = nei[h] >> 2
            if mark[u] != stamp:
                if n >= room:
                    return NOWHERE - 1
                mark[u] = stamp
                cavity[n] = u
                n += 1
    return NOWHERE


@njit(**HELPER)
def face_around(vert, nei, t, a, b, c):
    """Corner opposite to the face a, b, c in a tetrahedron around edge a, b; -1 for none.

    t is one of them. Each is left by the face that its last corner lies in.
    """
    i = slot_of(vert, t, a)
    j = slot_of(vert, t, b)
    k = np.int64(0)
    while k in (i, j):
        k += 1
    back = 4 * t + k
    ahead = 4 * t + 6 - i - j - k
    if vert[back] == c:
        return ahead
    first = t
    while vert[ahead] != c:
        last = vert[ahead]
        ahead = nei[back]
        t = ahead >> 2
        if t == first:
            return NOWHERE
        back = 4 * t + slot_of(vert, t, last)
    return back


@njit(**ENTRY)
def find_faces(verts, neis, marks, homes, triangles, faces, work, counts):
    """faces[i] = corner opposite to triangle i in a tetrahedron that has it, -1 if none has.

    counts: next triangle, last stamp. Returns 1 if a star is larger than work.
    """
    vert = pointer(verts)
    nei = pointer(neis)
    mark = pointer(marks)
    home = pointer(homes)
    corner = pointer(triangles)
    face = pointer(faces)
    cavity = pointer(work[0])
    room = work.shape[1]
    for i in range(counts[0], faces.shape[0]):
        a = corner[3 * i]
        b = corner[3 * i + 1]
        c = corner[3 * i + 2]
        face[i] = -1
        if home[a] < 0 or home[b] < 0 or home[c] < 0:
            continue
        counts[1] += 2
        t = cell_with(vert, nei, mark, cavity, room, home[a], a, b, counts[1])
        if t < NOWHERE:
            counts[0] = i
            return 1
        if t >= 0:
            face[i] = face_around(vert, nei, t, a, b, c)
    counts[0] = faces.shape[0]
    return 0

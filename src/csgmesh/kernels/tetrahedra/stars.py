"""The tetrahedra around vertices, and faces found among them."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer

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
    last = NOWHERE
    n = np.int64(0)
    for i in range(counts[0], faces.shape[0]):
        a = corner[3 * i]
        b = corner[3 * i + 1]
        c = corner[3 * i + 2]
        face[i] = -1
        if home[a] < 0 or home[b] < 0 or home[c] < 0:
            continue
        if a != last:
            counts[1] += 2
            n = star(vert, nei, mark, cavity, room, home[a], a, counts[1])
            if n < 0:
                counts[0] = i
                return 1
            last = a
        for s in range(n):
            h = face_of(vert, cavity[s], a, b, c)
            if h >= 0:
                face[i] = h
                break
    counts[0] = faces.shape[0]
    return 0

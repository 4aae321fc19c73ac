"""Regions of tetrahedra, flooded inside walls."""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from .net import orient_vertices

#: Not reached yet.
UNKNOWN = np.int64(-2)


@njit(**HELPER)
def put(region, stack, n, t, wanted):
    """Give t a region; the new height of the stack, or -1 if it has another one."""
    have = region[t]
    if have == UNKNOWN:
        region[t] = wanted
        stack[n] = t
        return n + 1
    return n if have == wanted else np.int64(-1)


@njit(**ENTRY)
def flood_space(
    points, verts, neis, walls, triangles, faces, stops, sides, regions, stack_, n_tets
):
    """Regions of all tetrahedra from what lies behind and in front of each wall.

    walls[h]: whether face h is one. faces[i]: where triangle i is; sides (k, 2) what lies behind
    and in front of it. stops: more walls, which say nothing. Ghosts lie outside; -2 stays where
    no triangle leads. Returns -1, or a triangle at which regions disagree,
    or -2 - t for a tetrahedron that is reached from two regions.
    """
    xyz = pointer(points)
    vert = pointer(verts)
    nei = pointer(neis)
    wall = pointer(walls)
    corner = pointer(triangles)
    face = pointer(faces)
    stop = pointer(stops)
    side = pointer(sides)
    region = pointer(regions)
    stack = pointer(stack_)
    n = np.int64(0)
    for t in range(n_tets):
        region[t] = UNKNOWN
        for h in range(4 * t, 4 * t + 4):
            wall[h] = 0
    for i in range(faces.shape[0]):
        wall[face[i]] = 1
        wall[nei[face[i]]] = 1
    for i in range(stops.shape[0]):
        wall[stop[i]] = 1
        wall[nei[stop[i]]] = 1
    for i in range(faces.shape[0]):
        for turn in range(2):
            h = face[i] if turn == 0 else nei[face[i]]
            is_behind = False
            v = vert[h]
            if v >= 0:
                o = orient_vertices(xyz, corner[3 * i], corner[3 * i + 1], corner[3 * i + 2], v)
                is_behind = o < 0.0
            wanted = side[2 * i] if is_behind else side[2 * i + 1]
            n = put(region, stack, n, h >> 2, wanted)
            if n < 0:
                return i
            while n > 0:
                n -= 1
                t = stack[n]
                for g in range(4 * t, 4 * t + 4):
                    if wall[g] == 0:
                        n = put(region, stack, n, nei[g] >> 2, region[t])
                        if n < 0:
                            return -2 - t
    for t in range(n_tets):
        if vert[4 * t] != -2 and vert[4 * t + 3] < 0 and region[t] >= 0:
            return -2 - t
    return -1

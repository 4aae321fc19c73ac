"""Vertices of hexahedra to the mean of their neighbours, before any is optimised."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY
from .relaxing import AROUND

#: Vertices looked at between two returns to the caller.
SLICE = 500_000


@njit(**ENTRY)
def list_stars(hexes, cursor, star):
    """8 cell + corner of all cells around each vertex; `cursor` holds where each star begins."""
    for c in range(hexes.shape[0]):
        for k in range(8):
            v = hexes[c, k]
            star[cursor[v]] = 8 * c + k
            cursor[v] += 1


@njit(**ENTRY)
def average_in_cells(points, hexes, star, begin, vertices, start):
    """Each vertex from `start` on to the mean of its neighbours along edges; the next one."""
    last = min(start + SLICE, vertices.shape[0])
    for at in range(start, last):
        v = vertices[at]
        x = 0.0
        y = 0.0
        z = 0.0
        n = 3 * (begin[v + 1] - begin[v])
        for s in range(begin[v], begin[v + 1]):
            c = star[s] // 8
            for j in range(3):
                u = hexes[c, AROUND[star[s] % 8, j]]
                x += points[u, 0]
                y += points[u, 1]
                z += points[u, 2]
        if n > 0:
            points[v, 0] = x / n
            points[v, 1] = y / n
            points[v, 2] = z / n
    return last


@njit(**ENTRY)
def average_along(points, vertices, begin, neighbours, share, out):
    """Each vertex, by a share, towards the mean of its listed neighbours."""
    for at in range(vertices.shape[0]):
        v = vertices[at]
        n = begin[at + 1] - begin[at]
        for d in range(3):
            mean = 0.0
            for s in range(begin[at], begin[at + 1]):
                mean += points[neighbours[s], d]
            out[at, d] = points[v, d]
            if n > 0:
                out[at, d] += share * (mean / n - points[v, d])

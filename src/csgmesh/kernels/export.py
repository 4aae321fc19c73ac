"""Triangles of the domain out of the triangulation."""

from __future__ import annotations

from numba import njit

from .pointers import ENTRY, pointer


@njit(**ENTRY)
def mark_used(origin, twin, n_triangles, used):
    """Mark the vertices of triangles with a region; returns the number of these triangles."""
    here = pointer(origin)
    there = pointer(twin)
    mark = pointer(used)
    n = 0
    for t in range(0, 4 * n_triangles, 4):
        if there[t + 3] >= 0:
            for e in range(3):
                mark[here[t + e]] = 1
            n += 1
    return n


@njit(**ENTRY)
def extract(origin, twin, n_triangles, number, cells, regions):
    """List the triangles with a region, their vertices v as number[v]."""
    here = pointer(origin)
    there = pointer(twin)
    new = pointer(number)
    cell = pointer(cells)
    region = pointer(regions)
    n = 0
    for t in range(0, 4 * n_triangles, 4):
        if there[t + 3] >= 0:
            for e in range(3):
                cell[3 * n + e] = new[here[t + e]]
            region[n] = there[t + 3]
            n += 1

"""Triangles of the domain out of the triangulation."""

from __future__ import annotations

from numba import njit

from .pointers import ENTRY, pointer


@njit(**ENTRY)
def extract(origin, twin, n_triangles, cells, regions, used):
    """List the triangles with a region, mark their vertices; returns their number."""
    here = pointer(origin)
    there = pointer(twin)
    cell = pointer(cells)
    region = pointer(regions)
    mark = pointer(used)
    n = 0
    for t in range(0, 4 * n_triangles, 4):
        if there[t + 3] >= 0:
            for e in range(3):
                cell[3 * n + e] = here[t + e]
                mark[here[t + e]] = 1
            region[n] = there[t + 3]
            n += 1
    return n

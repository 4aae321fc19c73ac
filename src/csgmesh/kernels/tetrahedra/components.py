"""Components of tetrahedra that hang together at vertices."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, HELPER, pointer


@njit(**HELPER)
def root_of(part, v):
    while part[v] != v:
        part[v] = part[part[v]]
        v = part[v]
    return v


@njit(**ENTRY)
def tetra_components(tets, parts):
    """parts[v] = the lowest vertex of the component of vertex v."""
    corner = pointer(tets)
    part = pointer(parts)
    for v in range(parts.shape[0]):
        part[v] = v
    for t in range(tets.shape[0] // 4):
        a = root_of(part, corner[4 * t])
        for h in range(4 * t + 1, 4 * t + 4):
            b = root_of(part, corner[h])
            if b < a:
                part[a] = b
                a = b
            else:
                part[b] = a
    for v in range(parts.shape[0]):
        part[v] = root_of(part, v)

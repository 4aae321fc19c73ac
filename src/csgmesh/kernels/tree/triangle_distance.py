"""Distance of a point from a triangle in space (Ericson, Real-Time Collision Detection, 2005)."""

from __future__ import annotations

from numba import njit

from ..pointers import HELPER


@njit(**HELPER)
def square_distance(corner, t, x, y, z):
    """Square of the distance of (x, y, z) from the triangle with coordinates corner[9 t:]."""
    o = 9 * t
    abx = corner[o + 3] - corner[o]
    aby = corner[o + 4] - corner[o + 1]
    abz = corner[o + 5] - corner[o + 2]
    acx = corner[o + 6] - corner[o]
    acy = corner[o + 7] - corner[o + 1]
    acz = corner[o + 8] - corner[o + 2]
    apx = x - corner[o]
    apy = y - corner[o + 1]
    apz = z - corner[o + 2]
    d1 = abx * apx + aby * apy + abz * apz
    d2 = acx * apx + acy * apy + acz * apz
    ab2 = abx * abx + aby * aby + abz * abz
    ac2 = acx * acx + acy * acy + acz * acz
    abac = abx * acx + aby * acy + abz * acz
    d3 = d1 - ab2
    d4 = d2 - abac
    d5 = d1 - abac
    d6 = d2 - ac2
    vc = d1 * d4 - d3 * d2
    vb = d5 * d2 - d1 * d6
    va = d3 * d6 - d5 * d4
    v = 0.0
    w = 0.0
    if d1 <= 0.0 and d2 <= 0.0:
        v = 0.0
    elif d3 >= 0.0 and d4 <= d3:
        v = 1.0
    elif d6 >= 0.0 and d5 <= d6:
        w = 1.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3)
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6)
    elif va <= 0.0 and d4 >= d3 and d5 >= d6:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v = 1.0 - w
    else:
        whole = va + vb + vc
        v = vb / whole
        w = vc / whole
    dx = apx - v * abx - w * acx
    dy = apy - v * aby - w * acy
    dz = apz - v * abz - w * acz
    return dx * dx + dy * dy + dz * dz

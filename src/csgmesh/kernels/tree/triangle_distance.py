"""Distance of a point from a triangle in space (Ericson, Real-Time Collision Detection, 2005)."""

from __future__ import annotations

from numba import njit

from ..pointers import HELPER


@njit(**HELPER)
def nearest_weights(corner, t, x, y, z):
    """Where the triangle with coordinates corner[9 t:] is nearest: shares v, w of its two sides."""
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
    if d1 <= 0.0 and d2 <= 0.0:
        return 0.0, 0.0
    if d3 >= 0.0 and d4 <= d3:
        return 1.0, 0.0
    if d6 >= 0.0 and d5 <= d6:
        return 0.0, 1.0
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return d1 / (d1 - d3), 0.0
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return 0.0, d2 / (d2 - d6)
    if va <= 0.0 and d4 >= d3 and d5 >= d6:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return 1.0 - w, w
    whole = va + vb + vc
    return vb / whole, vc / whole


@njit(**HELPER)
def square_distance(corner, t, x, y, z):
    """Square of the distance of (x, y, z) from the triangle with coordinates corner[9 t:]."""
    v, w = nearest_weights(corner, t, x, y, z)
    square = 0.0
    for d in range(3):
        a = corner[9 * t + d]
        way = v * (corner[9 * t + 3 + d] - a) + w * (corner[9 * t + 6 + d] - a)
        left = (x if d == 0 else (y if d == 1 else z)) - a - way
        square += left * left
    return square

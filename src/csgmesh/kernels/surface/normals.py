"""Feet and normals of many points."""

from __future__ import annotations

from numba import njit

from ..pointers import ENTRY, pointer
from .exact import on_surface


@njit(**ENTRY)
def surface_feet(code, number, which, points, feet, normals, start, stop):
    """Feet of points on their surfaces and the outward unit normals there."""
    codes = pointer(code)
    numbers = pointer(number)
    for k in range(start, stop):
        x, y, z, nx, ny, nz = on_surface(
            codes, numbers, which[k], points[k, 0], points[k, 1], points[k, 2]
        )
        feet[k, 0] = x
        feet[k, 1] = y
        feet[k, 2] = z
        normals[k, 0] = nx
        normals[k, 1] = ny
        normals[k, 2] = nz

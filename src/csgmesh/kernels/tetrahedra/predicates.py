"""Exact signs of orientation and in-sphere determinants, behind a filter.

The filter is stage A of J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast
robust geometric predicates", Discrete & Computational Geometry 18 (1997), with his permanent
bounded by products of lengths: that of a 3 by 3 matrix is at most 6 / 3^1.5 = 1.155 times the
product of the lengths of its rows (Carlen, Lieb, Loss 2006). The stages behind it are in `exact`.

The proofs need every operation rounded on its own: no fastmath, no contraction to FMA.
"""

from __future__ import annotations

from numba import njit
from numba.extending import intrinsic

from ..pointers import HELPER, JIT_IS_OFF
from . import exact
from .linking import call_by_name

#: (7 * 1.155 * 2^-53)^2 = 8.1e-31, and (16 * 4 * 1.155 * 2^-53)^2 = 6.8e-29.
ORIENT_FILTER = 1e-30
SPHERE_FILTER = 8e-29


@intrinsic
def _orient3d_adaptive(typing, ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    return call_by_name(exact.ORIENT3D, 12)


@intrinsic
def _insphere_adaptive(typing, ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, ex, ey, ez):
    return call_by_name(exact.INSPHERE, 15)


if JIT_IS_OFF:
    _orient3d_adaptive = exact.orient3d_adaptive
    _insphere_adaptive = exact.insphere_adaptive


@njit(**HELPER)
def orient3d(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Six times the volume of a, b, c, d, with an exact sign.

    Positive when a, b, c run counterclockwise seen from d, as corners of a cell do.
    """
    bx_ = bx - ax
    by_ = by - ay
    bz_ = bz - az
    cx_ = cx - ax
    cy_ = cy - ay
    cz_ = cz - az
    dx_ = dx - ax
    dy_ = dy - ay
    dz_ = dz - az
    det = (
        bx_ * (cy_ * dz_ - cz_ * dy_)
        + by_ * (cz_ * dx_ - cx_ * dz_)
        + bz_ * (cx_ * dy_ - cy_ * dx_)
    )
    b = bx_ * bx_ + by_ * by_ + bz_ * bz_
    c = cx_ * cx_ + cy_ * cy_ + cz_ * cz_
    d = dx_ * dx_ + dy_ * dy_ + dz_ * dz_
    if det * det > ORIENT_FILTER * (b * c * d):
        return det
    return _orient3d_adaptive(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz)


@njit(**HELPER)
def insphere(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, ex, ey, ez):
    """Positive when e lies inside the sphere through a, b, c, d of positive volume; exact sign."""
    ax_ = ax - ex
    ay_ = ay - ey
    az_ = az - ez
    bx_ = bx - ex
    by_ = by - ey
    bz_ = bz - ez
    cx_ = cx - ex
    cy_ = cy - ey
    cz_ = cz - ez
    dx_ = dx - ex
    dy_ = dy - ey
    dz_ = dz - ez
    ab = ax_ * by_ - bx_ * ay_
    bc = bx_ * cy_ - cx_ * by_
    cd = cx_ * dy_ - dx_ * cy_
    da = dx_ * ay_ - ax_ * dy_
    ac = ax_ * cy_ - cx_ * ay_
    bd = bx_ * dy_ - dx_ * by_
    a = ax_ * ax_ + ay_ * ay_ + az_ * az_
    b = bx_ * bx_ + by_ * by_ + bz_ * bz_
    c = cx_ * cx_ + cy_ * cy_ + cz_ * cz_
    d = dx_ * dx_ + dy_ * dy_ + dz_ * dz_
    abc = az_ * bc - bz_ * ac + cz_ * ab
    bcd = bz_ * cd - cz_ * bd + dz_ * bc
    cda = cz_ * da + dz_ * ac + az_ * cd
    dab = dz_ * ab + az_ * bd + bz_ * da
    det = (a * bcd - b * cda) + (c * dab - d * abc)
    longest = max(max(a, b), max(c, d))
    square = longest * longest
    if det * det > SPHERE_FILTER * (square * square * longest):
        return det
    return _insphere_adaptive(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz, ex, ey, ez)

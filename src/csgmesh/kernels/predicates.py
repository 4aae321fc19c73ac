"""Exact signs of orientation and in-circle determinants, behind a static filter.

Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
predicates", Discrete & Computational Geometry 18 (1997). The filter is his stage A; the stages
behind it are in `exact`.

The proofs need every operation rounded on its own: no fastmath, no contraction to FMA.
"""

from __future__ import annotations

from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

from . import exact
from .exact import EPS
from .pointers import HELPER, JIT_IS_OFF

ORIENT_A = (3.0 + 16.0 * EPS) * EPS
CIRCLE_A = (10.0 + 96.0 * EPS) * EPS


def _external(name, n):
    """A call of machine code by name, with n doubles."""

    def codegen(context, builder, sig, args):
        double = ir.DoubleType()
        kind = ir.FunctionType(double, [double] * n)
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), args)

    return types.float64(*[types.float64] * n), codegen


@intrinsic
def _orient2d_adaptive(typing, ax, ay, bx, by, cx, cy, magnitude):
    return _external(exact.ORIENT2D, 7)


@intrinsic
def _incircle_adaptive(typing, ax, ay, bx, by, cx, cy, dx, dy, permanent):
    return _external(exact.INCIRCLE, 9)


if JIT_IS_OFF:
    _orient2d_adaptive = exact.orient2d_adaptive
    _incircle_adaptive = exact.incircle_adaptive


@njit(**HELPER)
def orient2d(ax, ay, bx, by, cx, cy):
    """Twice the signed area of a, b, c: its sign is exact, positive when counter-clockwise."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    det = left - right
    magnitude = abs(left) + abs(right)
    bound = ORIENT_A * magnitude
    if det >= bound or -det >= bound:
        return det
    return _orient2d_adaptive(ax, ay, bx, by, cx, cy, magnitude)


@njit(**HELPER)
def incircle(ax, ay, bx, by, cx, cy, dx, dy):
    """Positive when d lies inside the circle through a, b, c (counter-clockwise); exact sign."""
    adx = ax - dx
    bdx = bx - dx
    cdx = cx - dx
    ady = ay - dy
    bdy = by - dy
    cdy = cy - dy
    bc = bdx * cdy
    cb = cdx * bdy
    a_lift = adx * adx + ady * ady
    ca = cdx * ady
    ac = adx * cdy
    b_lift = bdx * bdx + bdy * bdy
    ab = adx * bdy
    ba = bdx * ady
    c_lift = cdx * cdx + cdy * cdy
    det = a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba)
    permanent = (
        (abs(bc) + abs(cb)) * a_lift + (abs(ca) + abs(ac)) * b_lift + (abs(ab) + abs(ba)) * c_lift
    )
    bound = CIRCLE_A * permanent
    if det > bound or -det > bound:
        return det
    return _incircle_adaptive(ax, ay, bx, by, cx, cy, dx, dy, permanent)

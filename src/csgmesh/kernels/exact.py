"""What is left of orientation and in-circle tests when a filter cannot tell; exact signs.

Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
predicates", Discrete & Computational Geometry 18 (1997). After his stage A, the filter in
`predicates`, come: B, the determinant of the rounded differences; C, a first-order correction by
their tails; D, exact. A stage is entered only when the one before cannot tell. His stage B is exact
from the start. Here double-double arithmetic comes first: it is several times cheaper, and fails
only nearer to zero than the differences of most inputs can come, short of zero itself.

Both functions are compiled once and called by name from the machine code of every other kernel:
compiled into each of them they would take longer than all the rest of some.
"""

from __future__ import annotations

import llvmlite.binding
from numba import cfunc, njit, types

from .expansions import (
    add_expansions,
    cross,
    diff_tail,
    multiply_into,
    pair,
    scale_expansion,
    two_diff,
    two_product,
    two_sum,
)
from .pointers import ENTRY, HELPER, JIT_IS_OFF, scratch

EPS = 2.0**-53
RESULT_BOUND = (3.0 + 8.0 * EPS) * EPS
ORIENT_B = (2.0 + 12.0 * EPS) * EPS
ORIENT_C = (9.0 + 64.0 * EPS) * EPS * EPS
#: Rounding of a determinant in double-double arithmetic, as a share of its permanent. Each of the
#: three terms is (s + t) (l + m), where |t| <= 2 EPS |s|, |m| <= 2 EPS |l| but for 3 EPS^2 of
#: rounding each: its products and sums add 23 EPS^2, those of the three terms 28.
CIRCLE_DOUBLE = 64.0 * EPS * EPS
CIRCLE_B = (4.0 + 256.0 * EPS) * EPS
CIRCLE_C = (44.0 + 64.0 + 1024.0 * EPS) * EPS * EPS


@njit(**HELPER)
def orient2d_adaptive(ax, ay, bx, by, cx, cy, magnitude):
    """Orientation with an exact sign; `magnitude` is the sum of the products' sizes."""
    acx = ax - cx
    bcx = bx - cx
    acy = ay - cy
    bcy = by - cy
    left, left_error = two_product(acx, bcy)
    right, right_error = two_product(acy, bcx)
    high, low = two_diff(left, right)
    det = high + (low + (left_error - right_error))
    if abs(det) >= ORIENT_B * magnitude:
        return det
    acx_tail = diff_tail(ax, cx, acx)
    bcx_tail = diff_tail(bx, cx, bcx)
    acy_tail = diff_tail(ay, cy, acy)
    bcy_tail = diff_tail(by, cy, bcy)
    is_exact = acx_tail == 0.0 and acy_tail == 0.0 and bcx_tail == 0.0 and bcy_tail == 0.0
    if not is_exact:
        bound = ORIENT_C * magnitude + RESULT_BOUND * abs(det)
        det += (acx * bcy_tail + bcy * acx_tail) - (acy * bcx_tail + bcx * acy_tail)
        if abs(det) >= bound:
            return det
    elif left_error == 0.0 and right_error == 0.0:
        return high
    p = scratch(2)
    q = scratch(2)
    b = scratch(4)
    nb = cross(acx, acy, bcx, bcy, p, q, b)
    if is_exact:
        return b[nb - 1] if nb > 0 else 0.0
    u = scratch(4)
    c1 = scratch(8)
    c2 = scratch(12)
    d = scratch(16)
    nu = cross(acx_tail, acy_tail, bcx, bcy, p, q, u)
    n = add_expansions(nb, b, nu, u, c1)
    nu = cross(acx, acy, bcx_tail, bcy_tail, p, q, u)
    n = add_expansions(n, c1, nu, u, c2)
    nu = cross(acx_tail, acy_tail, bcx_tail, bcy_tail, p, q, u)
    n = add_expansions(n, c2, nu, u, d)
    return d[n - 1] if n > 0 else 0.0


@njit(**HELPER)
def lifted_minor(ux, uy, n, minor, s, t, v, w, h):
    """h = (ux² + uy²) * minor, exactly, for an expansion of n <= 4 terms."""
    k = scale_expansion(n, minor, ux, s)
    i = scale_expansion(k, s, ux, v)
    k = scale_expansion(n, minor, uy, t)
    j = scale_expansion(k, t, uy, w)
    return add_expansions(i, v, j, w, h)


@njit(**HELPER)
def incircle_of_pairs(ax, ay, bx, by, cx, cy, dx, dy):
    """Stage D: coordinates relative to d as pairs, every product and sum exact."""
    x = scratch(6)
    y = scratch(6)
    e = scratch(2)
    f = scratch(2)
    s = scratch(1024)
    minor = scratch(16)
    part = scratch(16)
    lift = scratch(16)
    o = scratch(512)
    term = scratch(512)
    total = scratch(1536)
    spare = scratch(1536)
    for k in range(3):
        px = ax if k == 0 else (bx if k == 1 else cx)
        py = ay if k == 0 else (by if k == 1 else cy)
        high = px - dx
        x[2 * k] = diff_tail(px, dx, high)
        x[2 * k + 1] = high
        high = py - dy
        y[2 * k] = diff_tail(py, dy, high)
        y[2 * k + 1] = high
    n_total = 0
    for k in range(3):
        i = (k + 1) % 3
        j = (k + 2) % 3
        ne = pair(x[2 * i], x[2 * i + 1], e)
        nf = pair(y[2 * j], y[2 * j + 1], f)
        n_minor = multiply_into(ne, e, nf, f, s, minor, o)
        ne = pair(-y[2 * i], -y[2 * i + 1], e)
        nf = pair(x[2 * j], x[2 * j + 1], f)
        n_part = multiply_into(ne, e, nf, f, s, part, o)
        n = add_expansions(n_minor, minor, n_part, part, o)
        n_minor = n
        for a in range(n):
            minor[a] = o[a]
        ne = pair(x[2 * k], x[2 * k + 1], e)
        n_lift = multiply_into(ne, e, ne, e, s, lift, o)
        ne = pair(y[2 * k], y[2 * k + 1], e)
        n_part = multiply_into(ne, e, ne, e, s, part, o)
        n = add_expansions(n_lift, lift, n_part, part, o)
        n_lift = n
        for a in range(n):
            lift[a] = o[a]
        n_term = multiply_into(n_minor, minor, n_lift, lift, s, term, spare)
        n = add_expansions(n_total, total, n_term, term, spare)
        n_total = n
        for a in range(n):
            total[a] = spare[a]
    return total[n_total - 1] if n_total > 0 else 0.0


@njit(**HELPER)
def incircle_of_differences(adx, ady, bdx, bdy, cdx, cdy):
    """Stage B: the exact determinant of differences, which have no tails here."""
    p = scratch(2)
    q = scratch(2)
    minor = scratch(4)
    s = scratch(8)
    t = scratch(8)
    v = scratch(16)
    w = scratch(16)
    a_det = scratch(32)
    b_det = scratch(32)
    ab_det = scratch(64)
    total = scratch(96)
    n = cross(bdx, bdy, cdx, cdy, p, q, minor)
    na = lifted_minor(adx, ady, n, minor, s, t, v, w, a_det)
    n = cross(cdx, cdy, adx, ady, p, q, minor)
    nb = lifted_minor(bdx, bdy, n, minor, s, t, v, w, b_det)
    n_ab = add_expansions(na, a_det, nb, b_det, ab_det)
    n = cross(adx, ady, bdx, bdy, p, q, minor)
    na = lifted_minor(cdx, cdy, n, minor, s, t, v, w, a_det)
    n = add_expansions(n_ab, ab_det, na, a_det, total)
    return total[n - 1] if n > 0 else 0.0


@njit(**HELPER)
def difference_of_products(a, b, c, d):
    """a * b - c * d as a high and a low part, and whether the high part alone is exact."""
    p, p_error = two_product(a, b)
    q, q_error = two_product(c, d)
    high, low = two_diff(p, q)
    return high, low + (p_error - q_error), p_error == 0.0 and q_error == 0.0 and low == 0.0


@njit(**HELPER)
def lift(x, y):
    """x² + y² as a high and a low part, and whether the high part alone is exact."""
    p, p_error = two_product(x, x)
    q, q_error = two_product(y, y)
    high, low = two_sum(p, q)
    return high, low + (p_error + q_error), p_error == 0.0 and q_error == 0.0 and low == 0.0


@njit(**HELPER)
def product(high, low, other_high, other_low):
    """Product of two double-doubles, their low parts' own product left out."""
    p, error = two_product(high, other_high)
    return p, error + (high * other_low + low * other_high)


@njit(**HELPER)
def are_rectangle(ax, ay, bx, by, cx, cy, dx, dy):
    """Whether x and y take two values each, and each twice: the commonest four points on a circle.

    They are the corners of a rectangle parallel to the axes, or some of them coincide.
    """
    return ((ax == bx and cx == dx) or (ax == cx and bx == dx) or (ax == dx and bx == cx)) and (
        (ay == by and cy == dy) or (ay == cy and by == dy) or (ay == dy and by == cy)
    )


@njit(**HELPER)
def incircle_adaptive(ax, ay, bx, by, cx, cy, dx, dy, permanent):
    """In-circle determinant with an exact sign; `permanent` is that of the rounded differences."""
    if are_rectangle(ax, ay, bx, by, cx, cy, dx, dy):
        return 0.0
    adx, adx_t = two_diff(ax, dx)
    ady, ady_t = two_diff(ay, dy)
    bdx, bdx_t = two_diff(bx, dx)
    bdy, bdy_t = two_diff(by, dy)
    cdx, cdx_t = two_diff(cx, dx)
    cdy, cdy_t = two_diff(cy, dy)
    bc, bc_low, bc_exact = difference_of_products(bdx, cdy, cdx, bdy)
    ca, ca_low, ca_exact = difference_of_products(cdx, ady, adx, cdy)
    ab, ab_low, ab_exact = difference_of_products(adx, bdy, bdx, ady)
    a_lift, a_low, a_exact = lift(adx, ady)
    b_lift, b_low, b_exact = lift(bdx, bdy)
    c_lift, c_low, c_exact = lift(cdx, cdy)
    u, u_low = product(bc, bc_low, a_lift, a_low)
    v, v_low = product(ca, ca_low, b_lift, b_low)
    w, w_low = product(ab, ab_low, c_lift, c_low)
    uv, uv_error = two_sum(u, v)
    high, high_error = two_sum(uv, w)
    det = high + ((u_low + v_low + w_low) + (uv_error + high_error))
    if abs(det) >= CIRCLE_B * permanent:
        return det
    if (
        adx_t == 0.0
        and ady_t == 0.0
        and bdx_t == 0.0
        and bdy_t == 0.0
        and cdx_t == 0.0
        and cdy_t == 0.0
    ):
        if abs(det) >= CIRCLE_DOUBLE * permanent:
            return det
        # Small integers and their like: nothing was rounded.
        factors_are_exact = bc_exact and ca_exact and ab_exact and a_exact and b_exact and c_exact
        products_are_exact = u_low == 0.0 and v_low == 0.0 and w_low == 0.0
        if factors_are_exact and products_are_exact and uv_error == 0.0:
            return high
        return incircle_of_differences(adx, ady, bdx, bdy, cdx, cdy)
    bound = CIRCLE_C * permanent + RESULT_BOUND * abs(det)
    det += (
        a_lift * ((bdx * cdy_t + cdy * bdx_t) - (bdy * cdx_t + cdx * bdy_t))
        + 2.0 * (adx * adx_t + ady * ady_t) * bc
        + b_lift * ((cdx * ady_t + ady * cdx_t) - (cdy * adx_t + adx * cdy_t))
        + 2.0 * (bdx * bdx_t + bdy * bdy_t) * ca
        + c_lift * ((adx * bdy_t + bdy * adx_t) - (ady * bdx_t + bdx * ady_t))
        + 2.0 * (cdx * cdx_t + cdy * cdy_t) * ab
    )
    if abs(det) >= bound:
        return det
    return incircle_of_pairs(ax, ay, bx, by, cx, cy, dx, dy)


def _named(name, function, n):
    """Compile a function of n doubles, and let other machine code call it by name."""
    if JIT_IS_OFF:
        return
    double = types.float64
    compiled = cfunc(double(*[double] * n), **ENTRY)(function.py_func)
    llvmlite.binding.add_symbol(name, compiled.address)


ORIENT2D = "csgmesh_orient2d_adaptive"
INCIRCLE = "csgmesh_incircle_adaptive"
_named(ORIENT2D, orient2d_adaptive, 7)
_named(INCIRCLE, incircle_adaptive, 9)

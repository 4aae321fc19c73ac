"""Exact signs of orientation and in-circle determinants.

Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
predicates", Discrete & Computational Geometry 18 (1997). Each predicate goes through his stages:
A, a static filter; B, the exact determinant of the rounded differences; C, a first-order
correction by their tails; D, exact. A stage is entered only when the one before cannot tell.

The proofs need every operation rounded on its own: no fastmath, no contraction to FMA.
"""

from __future__ import annotations

from numba import njit

from .pointers import HELPER, scratch

EPS = 2.0**-53
SPLITTER = 134217729.0
RESULT_BOUND = (3.0 + 8.0 * EPS) * EPS
ORIENT_A = (3.0 + 16.0 * EPS) * EPS
ORIENT_B = (2.0 + 12.0 * EPS) * EPS
ORIENT_C = (9.0 + 64.0 * EPS) * EPS * EPS
CIRCLE_A = (10.0 + 96.0 * EPS) * EPS
CIRCLE_B = (4.0 + 48.0 * EPS) * EPS
CIRCLE_C = (44.0 + 576.0 * EPS) * EPS * EPS


@njit(**HELPER)
def two_sum(a, b):
    x = a + b
    b_part = x - a
    a_part = x - b_part
    return x, (a - a_part) + (b - b_part)


@njit(**HELPER)
def diff_tail(a, b, x):
    """What a - b lost when it was rounded to x."""
    b_part = a - x
    a_part = x + b_part
    return (a - a_part) + (b_part - b)


@njit(**HELPER)
def two_product(a, b):
    x = a * b
    c = SPLITTER * a
    a_high = c - (c - a)
    a_low = a - a_high
    c = SPLITTER * b
    b_high = c - (c - b)
    b_low = b - b_high
    error = x - a_high * b_high
    error = error - a_low * b_high
    error = error - a_high * b_low
    return x, a_low * b_low - error


@njit(**HELPER)
def add_expansions(n, e, m, f, h):
    """h = e + f for expansions of n and m terms, without zeros; returns the number of terms."""
    i = 0
    j = 0
    k = 0
    q = 0.0
    while i < n or j < m:
        if j >= m:
            term = e[i]
            i += 1
        elif i >= n:
            term = f[j]
            j += 1
        elif (f[j] > e[i]) == (f[j] > -e[i]):
            term = e[i]
            i += 1
        else:
            term = f[j]
            j += 1
        q, low = two_sum(q, term)
        if low != 0.0:
            h[k] = low
            k += 1
    if q != 0.0:
        h[k] = q
        k += 1
    return k


@njit(**HELPER)
def scale_expansion(n, e, b, h):
    """h = b * e for an expansion of n terms, without zeros; returns the number of terms."""
    if n == 0 or b == 0.0:
        return 0
    k = 0
    q, low = two_product(e[0], b)
    if low != 0.0:
        h[k] = low
        k += 1
    for i in range(1, n):
        high, tail = two_product(e[i], b)
        s, low = two_sum(q, tail)
        if low != 0.0:
            h[k] = low
            k += 1
        q, low = two_sum(high, s)
        if low != 0.0:
            h[k] = low
            k += 1
    if q != 0.0:
        h[k] = q
        k += 1
    return k


@njit(**HELPER)
def estimate(n, e):
    total = 0.0
    for i in range(n):
        total += e[i]
    return total


@njit(**HELPER)
def cross(ax, ay, bx, by, p, q, h):
    """h = ax * by - ay * bx exactly; p and q are scratch of two terms."""
    high, low = two_product(ax, by)
    n = 0
    if low != 0.0:
        p[n] = low
        n += 1
    if high != 0.0:
        p[n] = high
        n += 1
    high, low = two_product(-ay, bx)
    m = 0
    if low != 0.0:
        q[m] = low
        m += 1
    if high != 0.0:
        q[m] = high
        m += 1
    return add_expansions(n, p, m, q, h)


@njit(**HELPER)
def orient2d_adaptive(ax, ay, bx, by, cx, cy, magnitude):
    acx = ax - cx
    bcx = bx - cx
    acy = ay - cy
    bcy = by - cy
    p = scratch(2)
    q = scratch(2)
    b = scratch(4)
    nb = cross(acx, acy, bcx, bcy, p, q, b)
    det = estimate(nb, b)
    bound = ORIENT_B * magnitude
    if det >= bound or -det >= bound:
        return det
    acx_tail = diff_tail(ax, cx, acx)
    bcx_tail = diff_tail(bx, cx, bcx)
    acy_tail = diff_tail(ay, cy, acy)
    bcy_tail = diff_tail(by, cy, bcy)
    if acx_tail == 0.0 and acy_tail == 0.0 and bcx_tail == 0.0 and bcy_tail == 0.0:
        return det
    bound = ORIENT_C * magnitude + RESULT_BOUND * abs(det)
    det += (acx * bcy_tail + bcy * acx_tail) - (acy * bcx_tail + bcx * acy_tail)
    if det >= bound or -det >= bound:
        return det
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
def orient2d(ax, ay, bx, by, cx, cy):
    """Twice the signed area of a, b, c: its sign is exact, positive when counter-clockwise."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    det = left - right
    magnitude = abs(left) + abs(right)
    bound = ORIENT_A * magnitude
    if det >= bound or -det >= bound:
        return det
    return orient2d_adaptive(ax, ay, bx, by, cx, cy, magnitude)


@njit(**HELPER)
def lifted_minor(ux, uy, n, minor, s, t, v, w, h):
    """h = (ux² + uy²) * minor, exactly, for an expansion of n <= 4 terms."""
    k = scale_expansion(n, minor, ux, s)
    i = scale_expansion(k, s, ux, v)
    k = scale_expansion(n, minor, uy, t)
    j = scale_expansion(k, t, uy, w)
    return add_expansions(i, v, j, w, h)


@njit(**HELPER)
def multiply_into(n, e, m, f, s, h, other):
    """h += e * f, term by term of f; `other` is scratch as large as h; returns (terms of e*f).

    On entry h holds nothing. The product is left in h.
    """
    k = 0
    for i in range(m):
        j = scale_expansion(n, e, f[i], s)
        k2 = add_expansions(k, h, j, s, other)
        for a in range(k2):
            h[a] = other[a]
        k = k2
    return k


@njit(**HELPER)
def pair(low, high, h):
    n = 0
    if low != 0.0:
        h[n] = low
        n += 1
    if high != 0.0:
        h[n] = high
        n += 1
    return n


@njit(**HELPER)
def incircle_exact(ax, ay, bx, by, cx, cy, dx, dy):
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
def incircle_adaptive(ax, ay, bx, by, cx, cy, dx, dy, permanent):
    adx = ax - dx
    bdx = bx - dx
    cdx = cx - dx
    ady = ay - dy
    bdy = by - dy
    cdy = cy - dy
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
    det = estimate(n, total)
    bound = CIRCLE_B * permanent
    if det >= bound or -det >= bound:
        return det
    adx_t = diff_tail(ax, dx, adx)
    ady_t = diff_tail(ay, dy, ady)
    bdx_t = diff_tail(bx, dx, bdx)
    bdy_t = diff_tail(by, dy, bdy)
    cdx_t = diff_tail(cx, dx, cdx)
    cdy_t = diff_tail(cy, dy, cdy)
    if (
        adx_t == 0.0
        and ady_t == 0.0
        and bdx_t == 0.0
        and bdy_t == 0.0
        and cdx_t == 0.0
        and cdy_t == 0.0
    ):
        return det
    bound = CIRCLE_C * permanent + RESULT_BOUND * abs(det)
    det += (
        (adx * adx + ady * ady) * ((bdx * cdy_t + cdy * bdx_t) - (bdy * cdx_t + cdx * bdy_t))
        + 2.0 * (adx * adx_t + ady * ady_t) * (bdx * cdy - bdy * cdx)
        + (bdx * bdx + bdy * bdy) * ((cdx * ady_t + ady * cdx_t) - (cdy * adx_t + adx * cdy_t))
        + 2.0 * (bdx * bdx_t + bdy * bdy_t) * (cdx * ady - cdy * adx)
        + (cdx * cdx + cdy * cdy) * ((adx * bdy_t + bdy * adx_t) - (ady * bdx_t + bdx * ady_t))
        + 2.0 * (cdx * cdx_t + cdy * cdy_t) * (adx * bdy - ady * bdx)
    )
    if det >= bound or -det >= bound:
        return det
    return incircle_exact(ax, ay, bx, by, cx, cy, dx, dy)


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
    return incircle_adaptive(ax, ay, bx, by, cx, cy, dx, dy, permanent)

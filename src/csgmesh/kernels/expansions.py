"""Expansions: sums of doubles that hold a real number exactly, smallest term first.

Source: J. R. Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric
predicates", Discrete & Computational Geometry 18 (1997); T. J. Dekker, "A floating-point technique
for extending the available precision", Numerische Mathematik 18 (1971).

The proofs need every operation rounded on its own: no fastmath, no contraction to FMA. The one
place that wants an FMA asks for it: the error of a product. Processors without one get it from the
C library, which is slower and as exact.
"""

from __future__ import annotations

from numba import njit, types
from numba.extending import intrinsic

from .pointers import HELPER, JIT_IS_OFF

SPLITTER = 134217729.0


@intrinsic
def _fma(typing, a, b, c):
    def codegen(context, builder, sig, args):
        return builder.fma(*args)

    return types.float64(types.float64, types.float64, types.float64), codegen


def _split(a):
    c = SPLITTER * a
    high = c - (c - a)
    return high, a - high


@njit(**HELPER)
def two_sum(a, b):
    x = a + b
    b_part = x - a
    a_part = x - b_part
    return x, (a - a_part) + (b - b_part)


@njit(**HELPER)
def two_diff(a, b):
    x = a - b
    return x, diff_tail(a, b, x)


@njit(**HELPER)
def diff_tail(a, b, x):
    """What a - b lost when it was rounded to x."""
    b_part = a - x
    a_part = x + b_part
    return (a - a_part) + (b_part - b)


if JIT_IS_OFF:

    def two_product(a, b):
        x = a * b
        a_high, a_low = _split(a)
        b_high, b_low = _split(b)
        error = ((x - a_high * b_high) - a_low * b_high) - a_high * b_low
        return x, a_low * b_low - error

else:

    @njit(**HELPER)
    def two_product(a, b):
        x = a * b
        return x, _fma(a, b, -x)


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
def pair(low, high, h):
    """h = low + high, without zeros; returns the number of terms."""
    n = 0
    if low != 0.0:
        h[n] = low
        n += 1
    if high != 0.0:
        h[n] = high
        n += 1
    return n


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

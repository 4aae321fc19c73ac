"""Arithmetic with about 32 digits: a number is a high and a low double (T. J. Dekker, 1971).

A product or sum errs by less than 2^-102 of the sizes that go into it.
"""

from __future__ import annotations

from numba import njit

from ..expansions import two_product, two_sum
from ..pointers import HELPER


@njit(**HELPER)
def multiply(a, a_low, b, b_low):
    p, error = two_product(a, b)
    error += a * b_low + a_low * b
    high = p + error
    return high, error - (high - p)


@njit(**HELPER)
def add(a, a_low, b, b_low):
    s, error = two_sum(a, b)
    error += a_low + b_low
    high = s + error
    return high, error - (high - s)


@njit(**HELPER)
def minor(a, a_low, b, b_low, c, c_low, d, d_low):
    """a d - b c."""
    p, p_low = multiply(a, a_low, d, d_low)
    q, q_low = multiply(b, b_low, c, c_low)
    return add(p, p_low, -q, -q_low)


@njit(**HELPER)
def sum_of_products(a, a_low, u, u_low, b, b_low, v, v_low, c, c_low, w, w_low):
    """a u + b v + c w."""
    p, p_low = multiply(a, a_low, u, u_low)
    q, q_low = multiply(b, b_low, v, v_low)
    p, p_low = add(p, p_low, q, q_low)
    q, q_low = multiply(c, c_low, w, w_low)
    return add(p, p_low, q, q_low)

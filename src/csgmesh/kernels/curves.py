"""Points of exact curves, and where a subsegment is to be split."""

from __future__ import annotations

from collections import namedtuple
from math import cos, hypot, log2, sin

import numpy as np
from numba import njit

from .pointers import HELPER

#: Pointers to the subsegments (ends, original segment, interval, apex) and to their curves.
Subsegments = namedtuple(
    "Subsegments",
    "ends segment interval apex segment_ends segment_curve curve_kind curve_data",
)

ARC = np.int64(1)
QUADRATIC = np.int64(2)
NO_APEX = np.int64(-1)
BOTH = np.int64(-2)
STEPS = 60


@njit(**HELPER)
def curve_point(kind, d, i, t):
    """Point at parameter t of the curve of this kind whose data start at d[i]."""
    if kind == ARC:
        c = cos(t)
        s = sin(t)
        return d[i] + c * d[i + 2] + s * d[i + 4], d[i + 1] + c * d[i + 3] + s * d[i + 5]
    u = 1.0 - t
    if kind < ARC:
        return u * d[i] + t * d[i + 2], u * d[i + 1] + t * d[i + 3]
    if kind == QUADRATIC:
        p = u * u
        q = 2.0 * u * t
        r = t * t
        return p * d[i] + q * d[i + 2] + r * d[i + 4], p * d[i + 1] + q * d[i + 3] + r * d[i + 5]
    p = u * u * u
    q = 3.0 * u * u * t
    r = 3.0 * u * t * t
    s = t * t * t
    return (
        p * d[i] + q * d[i + 2] + r * d[i + 4] + s * d[i + 6],
        p * d[i + 1] + q * d[i + 3] + r * d[i + 5] + s * d[i + 7],
    )


@njit(**HELPER)
def point_on(xy, subs, k, t):
    """Point at parameter t of the exact curve of subsegment k."""
    s = subs.segment[k]
    c = subs.segment_curve[s]
    if c >= 0:
        return curve_point(subs.curve_kind[c], subs.curve_data, 8 * c, t)
    a = 2 * subs.segment_ends[2 * s]
    b = 2 * subs.segment_ends[2 * s + 1]
    u = 1.0 - t
    return u * xy[a] + t * xy[b], u * xy[a + 1] + t * xy[b + 1]


@njit(**HELPER)
def shell(near, far, unit):
    """The coarsest multiple of unit·2^-j in the middle third between two distances from an apex.

    All segments of an apex choose from the same numbers, whatever their lengths, so their
    vertices come to lie on common circles (concentric shells: Ruppert 1995; Miller, Pav,
    Walkington 2003) and stop encroaching upon each other's subsegments.
    """
    low = near + (far - near) / 3.0
    high = far - (far - near) / 3.0
    step = unit * 2.0 ** np.floor(log2(high / unit))
    while True:
        r = step * np.floor(high / step)
        if r >= low:
            return r
        step *= 0.5


@njit(**HELPER)
def between_shells(length, ra, rb):
    """Where to split a segment of two apexes first, as a distance from the first of them."""
    if ra + rb <= length:
        return min(max(0.5 * length, ra), length - rb)
    return length * (ra / (ra + rb))


@njit(**HELPER)
def at_distance(xy, subs, k, px, py, r, near, far):
    """Parameter of the point of subsegment k at distance r from (px, py), between near and far."""
    t = 0.5 * (near + far)
    for _ in range(STEPS):
        x, y = point_on(xy, subs, k, t)
        if hypot(x - px, y - py) < r:
            near = t
        else:
            far = t
        t = 0.5 * (near + far)
    return t


@njit(**HELPER)
def halfway(xy, subs, k, t0, t1):
    """Parameter of the point of subsegment k as far from either end."""
    a = 2 * subs.ends[2 * k]
    b = 2 * subs.ends[2 * k + 1]
    t = 0.5 * (t0 + t1)
    for _ in range(STEPS):
        x, y = point_on(xy, subs, k, t)
        if hypot(x - xy[a], y - xy[a + 1]) < hypot(x - xy[b], y - xy[b + 1]):
            t0 = t
        else:
            t1 = t
        t = 0.5 * (t0 + t1)
    return t


@njit(**HELPER)
def split_place(xy, subs, k, radius):
    """Where to split subsegment k: x, y and the curve's parameter.

    As far from either end, unless there is an apex: then at the distance of one of its shells.
    """
    a = 2 * subs.ends[2 * k]
    b = 2 * subs.ends[2 * k + 1]
    t0 = subs.interval[2 * k]
    t1 = subs.interval[2 * k + 1]
    curve = subs.segment_curve[subs.segment[k]]
    straight = curve < 0 or subs.curve_kind[curve] < ARC
    apex = subs.apex[k]
    if apex == NO_APEX:
        t = 0.5 * (t0 + t1) if straight else halfway(xy, subs, k, t0, t1)
        x, y = point_on(xy, subs, k, t)
        return x, y, t
    v = a if apex == BOTH else 2 * apex
    da = hypot(xy[a] - xy[v], xy[a + 1] - xy[v + 1])
    db = hypot(xy[b] - xy[v], xy[b + 1] - xy[v + 1])
    if apex == BOTH:
        r = between_shells(db, radius[a // 2], radius[b // 2])
    else:
        r = shell(min(da, db), max(da, db), radius[apex])
    if straight:
        t = t0 + (t1 - t0) * ((r - da) / (db - da))
    elif da < db:
        t = at_distance(xy, subs, k, xy[v], xy[v + 1], r, t0, t1)
    else:
        t = at_distance(xy, subs, k, xy[v], xy[v + 1], r, t1, t0)
    x, y = point_on(xy, subs, k, t)
    return x, y, t

"""Feet and normals of points on exact surfaces, and on the common curves of two."""

from __future__ import annotations

from math import atan2, ceil, cos, hypot, pi, sin, sqrt

from numba import njit

from ..curves import curve_point
from ..pointers import HELPER

#: Numbers a surface: matrix 9, inverse 9, offset 3, profile 8 or unit normal 3, interval 2.
WIDTH = 32
INVERSE = 9
OFFSET = 18
PROFILE = 21
INTERVAL = 29
#: Codes a surface: kind, kind of the profile, whether the profile is an arc of a circle.
CODES = 4

PLANE = 0
EXTRUDED = 1
LINE = 0
SAMPLES = 16
STEPS = 30
CURVE_STEPS = 12
PARALLEL = 1e-8
ULP = 2.3e-16


@njit(**HELPER)
def tangent(kind, d, i, t):
    """First and second derivative of a curve that is no line at parameter t."""
    if kind == 1:
        c = cos(t)
        s = sin(t)
        ux = c * d[i + 2] + s * d[i + 4]
        uy = c * d[i + 3] + s * d[i + 5]
        return c * d[i + 4] - s * d[i + 2], c * d[i + 5] - s * d[i + 3], -ux, -uy
    if kind == 2:
        ax = d[i + 2] - d[i]
        ay = d[i + 3] - d[i + 1]
        bx = d[i + 4] - d[i + 2]
        by = d[i + 5] - d[i + 3]
        u = 1.0 - t
        x = 2.0 * (u * ax + t * bx)
        y = 2.0 * (u * ay + t * by)
        return x, y, 2.0 * (bx - ax), 2.0 * (by - ay)
    ax = d[i + 2] - d[i]
    ay = d[i + 3] - d[i + 1]
    bx = d[i + 4] - d[i + 2]
    by = d[i + 5] - d[i + 3]
    cx = d[i + 6] - d[i + 4]
    cy = d[i + 7] - d[i + 5]
    u = 1.0 - t
    x = 3.0 * (u * u * ax + 2.0 * u * t * bx + t * t * cx)
    y = 3.0 * (u * u * ay + 2.0 * u * t * by + t * t * cy)
    return x, y, 6.0 * (u * (bx - ax) + t * (cx - bx)), 6.0 * (u * (by - ay) + t * (cy - by))


@njit(**HELPER)
def descend(kind, d, i, x, y, t, low, high):
    """Newton's method for the nearest point of a curve between two parameters."""
    for _ in range(STEPS):
        px, py = curve_point(kind, d, i, t)
        tx, ty, sx, sy = tangent(kind, d, i, t)
        rx = px - x
        ry = py - y
        slope = tx * tx + ty * ty
        bent = slope + rx * sx + ry * sy
        if bent > 0.0:
            slope = bent
        if slope <= 0.0:
            break
        new = min(max(t - (rx * tx + ry * ty) / slope, low), high)
        if abs(new - t) <= ULP * max(abs(t), 1.0):
            return new
        t = new
    return t


@njit(**HELPER)
def nearest_parameter(code, d, b, x, y):
    """Parameter of the nearest point of a surface's profile."""
    kind = code[1]
    i = b + PROFILE
    t0 = d[b + INTERVAL]
    t1 = d[b + INTERVAL + 1]
    low = min(t0, t1)
    high = max(t0, t1)
    if kind == LINE:
        ux = d[i + 2] - d[i]
        uy = d[i + 3] - d[i + 1]
        t = ((x - d[i]) * ux + (y - d[i + 1]) * uy) / (ux * ux + uy * uy)
        return min(max(t, low), high)
    if code[2]:
        rx = x - d[i]
        ry = y - d[i + 1]
        t = atan2(rx * d[i + 4] + ry * d[i + 5], rx * d[i + 2] + ry * d[i + 3])
        t += 2.0 * pi * ceil((low - t) / (2.0 * pi))
        if t <= high:
            return t
        # Beyond both ends: the nearer in angle.
        return high if t - high < low + 2.0 * pi - t else low
    best = 1e300
    at = low
    for k in range(SAMPLES + 1):
        t = low + (high - low) * k / SAMPLES
        px, py = curve_point(kind, d, i, t)
        gap = (px - x) * (px - x) + (py - y) * (py - y)
        if gap < best:
            best = gap
            at = t
    step = (high - low) / SAMPLES
    return descend(kind, d, i, x, y, at, max(at - step, low), min(at + step, high))


@njit(**HELPER)
def profile_foot(code, d, b, x, y):
    """Nearest point of a profile and its right-hand unit normal there."""
    kind = code[1]
    i = b + PROFILE
    t = nearest_parameter(code, d, b, x, y)
    px, py = curve_point(kind, d, i, t)
    if kind == LINE:
        tx = d[i + 2] - d[i]
        ty = d[i + 3] - d[i + 1]
    else:
        tx, ty, _, _ = tangent(kind, d, i, t)
    size = hypot(tx, ty)
    if d[b + INTERVAL + 1] < d[b + INTERVAL]:
        size = -size
    return px, py, ty / size, -tx / size


@njit(**HELPER)
def on_surface(code, d, s, x, y, z):
    """Foot of a point on surface s, and the outward unit normal there."""
    b = WIDTH * s
    dx = x - d[b + OFFSET]
    dy = y - d[b + OFFSET + 1]
    dz = z - d[b + OFFSET + 2]
    kind = code[CODES * s]
    if kind == PLANE:
        nx = d[b + PROFILE]
        ny = d[b + PROFILE + 1]
        nz = d[b + PROFILE + 2]
        gap = dx * nx + dy * ny + dz * nz
        return x - gap * nx, y - gap * ny, z - gap * nz, nx, ny, nz
    v = b + INVERSE
    qx = d[v] * dx + d[v + 1] * dy + d[v + 2] * dz
    qy = d[v + 3] * dx + d[v + 4] * dy + d[v + 5] * dz
    qz = d[v + 6] * dx + d[v + 7] * dy + d[v + 8] * dz
    codes = (kind, code[CODES * s + 1], code[CODES * s + 2])
    if kind == EXTRUDED:
        fx, fy, mx, my = profile_foot(codes, d, b, qx, qy)
        fz = qz
        mz = 0.0
    else:
        r = hypot(qx, qy)
        fr, fz, mr, mz = profile_foot(codes, d, b, r, qz)
        cx = qx / r if r > 0.0 else 0.0
        cy = qy / r if r > 0.0 else 0.0
        fx = fr * cx
        fy = fr * cy
        mx = mr * cx
        my = mr * cy
    nx = d[v] * mx + d[v + 3] * my + d[v + 6] * mz
    ny = d[v + 1] * mx + d[v + 4] * my + d[v + 7] * mz
    nz = d[v + 2] * mx + d[v + 5] * my + d[v + 8] * mz
    size = sqrt(nx * nx + ny * ny + nz * nz)
    share = 1.0 / size if size > 0.0 else 0.0
    return (
        d[b] * fx + d[b + 1] * fy + d[b + 2] * fz + d[b + OFFSET],
        d[b + 3] * fx + d[b + 4] * fy + d[b + 5] * fz + d[b + OFFSET + 1],
        d[b + 6] * fx + d[b + 7] * fy + d[b + 8] * fz + d[b + OFFSET + 2],
        nx * share,
        ny * share,
        nz * share,
    )


@njit(**HELPER)
def on_curve(code, d, a, b, x, y, z):
    """Point of the common curve of surfaces a and b near a point; of a alone if they touch."""
    for _ in range(CURVE_STEPS):
        fx, fy, fz, nx, ny, nz = on_surface(code, d, a, x, y, z)
        if a == b:
            return fx, fy, fz
        gx, gy, gz, mx, my, mz = on_surface(code, d, b, x, y, z)
        g = (fx - x) * nx + (fy - y) * ny + (fz - z) * nz
        h = (gx - x) * mx + (gy - y) * my + (gz - z) * mz
        c = nx * mx + ny * my + nz * mz
        sine = 1.0 - c * c
        if sine < PARALLEL:
            return fx, fy, fz
        s = (g - c * h) / sine
        t = (h - c * g) / sine
        dx = s * nx + t * mx
        dy = s * ny + t * my
        dz = s * nz + t * mz
        x += dx
        y += dy
        z += dz
        big = max(abs(x), max(abs(y), abs(z)))
        if max(abs(dx), max(abs(dy), abs(dz))) <= 4.0 * ULP * big:
            break
    return x, y, z

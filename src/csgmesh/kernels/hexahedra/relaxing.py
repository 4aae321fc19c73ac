"""Relax hexahedra vertex by vertex: untangling first, then towards cubes.

At each corner of a cell stand three edges with matrix J and determinant D. The energy of a corner
is f = |J|²/3 χ^(-2/3) + w (D² + 1) / χ with χ = (D + sqrt(ε² + D²)) / 2, which is finite where a
corner is turned over and grows without bound there as ε goes to zero (Garanzha, Kaporin,
Kudryavtseva, Protais, Ray, Sokolov 2021). Seen from one vertex, |J|² is quadratic and D affine, so
Newton's method needs no more than their gradients.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER

FIXED, ON_CURVE, ON_FACE, FREE = 0, 1, 2, 3

#: Vertices looked at between two returns to the caller.
SLICE = 4_000
#: Share of the energy that asks for volumes, not shapes.
VOLUMES = 0.02

#: For each corner of a hexahedron the corners along its edges, right-handed.
AROUND = np.array(
    [(1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3)],
    np.int64,
)


@njit(**HELPER)
def corner_at(xyz, hexes, c, k, moved, x, y, z, e):
    """Edges of corner k of cell c with vertex `moved` at (x, y, z); which column moves, -1 all."""
    o = hexes[c, k]
    ox = xyz[o, 0]
    oy = xyz[o, 1]
    oz = xyz[o, 2]
    column = -1
    if o == moved:
        ox = x
        oy = y
        oz = z
    for j in range(3):
        n = hexes[c, AROUND[k, j]]
        if n == moved:
            column = j
            e[3 * j] = x - ox
            e[3 * j + 1] = y - oy
            e[3 * j + 2] = z - oz
        else:
            e[3 * j] = xyz[n, 0] - ox
            e[3 * j + 1] = xyz[n, 1] - oy
            e[3 * j + 2] = xyz[n, 2] - oz
    return column


@njit(**HELPER)
def determinant(e):
    return (
        e[0] * (e[4] * e[8] - e[5] * e[7])
        + e[1] * (e[5] * e[6] - e[3] * e[8])
        + e[2] * (e[3] * e[7] - e[4] * e[6])
    )


@njit(**HELPER)
def raised(f, power):
    """A whole power."""
    out = 1.0
    for _ in range(power):
        out *= f
    return out


@njit(**HELPER)
def corner_energy(e, scale, epsilon, power):
    """Energy of a corner."""
    square = 0.0
    for j in range(9):
        square += e[j] * e[j]
    square *= scale * scale
    d = determinant(e) * scale * scale * scale
    chi = 0.5 * (d + sqrt(epsilon * epsilon + d * d))
    if chi <= 0.0:
        return 1e300
    root = np.cbrt(chi)
    f = square / (3.0 * root * root) + VOLUMES * (d * d + 1.0) / chi
    return raised(f, power)


@njit(**HELPER)
def star_energy(view, v, x, y, z, epsilon, power, limit):
    """Energy of all corners that vertex v is part of, as far as `limit`."""
    total = 0.0
    for s in range(view[3][v], view[3][v + 1]):
        c = view[2][s] // 8
        i = view[2][s] % 8
        for j in range(4):
            k = i if j == 3 else AROUND[i, j]
            corner_at(view[0], view[1], c, k, v, x, y, z, view[7])
            total += corner_energy(view[7], view[6][v], epsilon, power)
        if total > limit:
            return total
    return total


@njit(**HELPER)
def gather(view, v, epsilon, power, g, h):
    """Gradient (3) and a positive approximation of the Hessian (xx, xy, xz, yy, yz, zz)."""
    for j in range(3):
        g[j] = 0.0
    for j in range(6):
        h[j] = 0.0
    e = view[7]
    scale = view[6][v]
    x = view[0][v, 0]
    y = view[0][v, 1]
    z = view[0][v, 2]
    for s in range(view[3][v], view[3][v + 1]):
        c = view[2][s] // 8
        i = view[2][s] % 8
        for j in range(4):
            k = i if j == 3 else AROUND[i, j]
            column = corner_at(view[0], view[1], c, k, v, x, y, z, e)
            add_corner(e, column, scale, epsilon, power, g, h)


@njit(**HELPER)
def add_corner(e, column, scale, epsilon, power, g, h):
    """Add what one corner contributes to gradient and Hessian."""
    square = 0.0
    for j in range(9):
        square += e[j] * e[j]
    square *= scale * scale
    d = determinant(e) * scale**3
    root = sqrt(epsilon * epsilon + d * d)
    chi = 0.5 * (d + root)
    if chi <= 0.0:
        return
    tx = 0.0
    ty = 0.0
    tz = 0.0
    dx = 0.0
    dy = 0.0
    dz = 0.0
    for j in range(3):
        if column >= 0 and column != j:
            continue
        sign = 1.0 if column >= 0 else -1.0
        a = 3 * ((j + 1) % 3)
        b = 3 * ((j + 2) % 3)
        tx += sign * 2.0 * e[3 * j]
        ty += sign * 2.0 * e[3 * j + 1]
        tz += sign * 2.0 * e[3 * j + 2]
        dx += sign * (e[a + 1] * e[b + 2] - e[a + 2] * e[b + 1])
        dy += sign * (e[a + 2] * e[b] - e[a] * e[b + 2])
        dz += sign * (e[a] * e[b + 1] - e[a + 1] * e[b])
    s2 = scale * scale
    s3 = s2 * scale
    tx *= s2
    ty *= s2
    tz *= s2
    dx *= s3
    dy *= s3
    dz *= s3
    third = np.cbrt(chi)
    weight = 1.0 / (3.0 * third * third)
    shape = square * weight
    volume = VOLUMES * (d * d + 1.0) / chi
    f = shape + volume
    # chi' = chi / root, chi'' = epsilon² / (2 root³)
    slope = chi / root
    bend = 0.5 * epsilon * epsilon / (root * root * root)
    by_d = -2.0 / 3.0 * shape * slope / chi + VOLUMES * 2.0 * d / chi - volume * slope / chi
    ratio = slope / chi
    by_dd = shape * (10.0 / 9.0 * ratio * ratio - 2.0 / 3.0 * bend / chi)
    by_dd += VOLUMES * (2.0 / chi - 4.0 * d * ratio / chi)
    by_dd += volume * (2.0 * ratio * ratio - bend / chi)
    by_dd = max(by_dd, 0.0)
    outer = power * raised(f, power - 1)
    gx = weight * tx + by_d * dx
    gy = weight * ty + by_d * dy
    gz = weight * tz + by_d * dz
    g[0] += outer * gx
    g[1] += outer * gy
    g[2] += outer * gz
    round_ = outer * weight * s2 * (2.0 if column >= 0 else 6.0)
    steep = outer * by_dd
    twice = outer * (power - 1) / f
    h[0] += round_ + steep * dx * dx + twice * gx * gx
    h[1] += steep * dx * dy + twice * gx * gy
    h[2] += steep * dx * dz + twice * gx * gz
    h[3] += round_ + steep * dy * dy + twice * gy * gy
    h[4] += steep * dy * dz + twice * gy * gz
    h[5] += round_ + steep * dz * dz + twice * gz * gz


@njit(**HELPER)
def direction(kind, n, g, h, p):
    """Newton's direction: free, across the normal n, or along the tangent n."""
    if kind == ON_CURVE:
        slope = g[0] * n[0] + g[1] * n[1] + g[2] * n[2]
        bend = h[0] * n[0] * n[0] + h[3] * n[1] * n[1] + h[5] * n[2] * n[2]
        bend += 2.0 * (h[1] * n[0] * n[1] + h[2] * n[0] * n[2] + h[4] * n[1] * n[2])
        for j in range(3):
            p[j] = -slope / bend * n[j]
        return
    if kind == ON_FACE:
        # A stiff wall along the normal, and the gradient without its part there.
        slope = g[0] * n[0] + g[1] * n[1] + g[2] * n[2]
        wall = 1e4 * (h[0] + h[3] + h[5])
        for j in range(3):
            g[j] -= slope * n[j]
        h[0] += wall * n[0] * n[0]
        h[1] += wall * n[0] * n[1]
        h[2] += wall * n[0] * n[2]
        h[3] += wall * n[1] * n[1]
        h[4] += wall * n[1] * n[2]
        h[5] += wall * n[2] * n[2]
    xx = h[3] * h[5] - h[4] * h[4]
    xy = h[2] * h[4] - h[1] * h[5]
    xz = h[1] * h[4] - h[2] * h[3]
    yy = h[0] * h[5] - h[2] * h[2]
    yz = h[1] * h[2] - h[0] * h[4]
    zz = h[0] * h[3] - h[1] * h[1]
    det = h[0] * xx + h[1] * xy + h[2] * xz
    p[0] = -(xx * g[0] + xy * g[1] + xz * g[2]) / det
    p[1] = -(xy * g[0] + yy * g[1] + yz * g[2]) / det
    p[2] = -(xz * g[0] + yz * g[1] + zz * g[2]) / det


@njit(**ENTRY)
def relax(
    xyz, hexes, star, star_begin, kind, frame, scale, scratch, vertices, start, epsilon, power
):
    """One visit of each vertex of a list from `start` on; the next one to visit.

    `star` holds 8 cell + corner for each vertex in turn; `frame` the normal of vertices on faces,
    the tangent of those on curves; `scale` one over the length wanted there;
    `power` is a whole number.
    """
    view = (xyz, hexes, star, star_begin, kind, frame, scale, scratch[0])
    g = scratch[1]
    h = scratch[2]
    p = scratch[3]
    last = min(start + SLICE, vertices.shape[0])
    for at in range(start, last):
        v = vertices[at]
        if kind[v] == FIXED or star_begin[v] == star_begin[v + 1]:
            continue
        gather(view, v, epsilon, power, g, h)
        direction(kind[v], frame[v], g, h, p)
        length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) * scale[v]
        if not length < 1e10:
            continue
        share = 1.0 if length <= 0.5 else 0.5 / length
        x = xyz[v, 0]
        y = xyz[v, 1]
        z = xyz[v, 2]
        now = star_energy(view, v, x, y, z, epsilon, power, 1e305)
        for _ in range(8):
            nx = x + share * p[0]
            ny = y + share * p[1]
            nz = z + share * p[2]
            if star_energy(view, v, nx, ny, nz, epsilon, power, now) < now:
                xyz[v, 0] = nx
                xyz[v, 1] = ny
                xyz[v, 2] = nz
                break
            share *= 0.4
    return last


@njit(**ENTRY)
def least_determinant(xyz, hexes, scale, scratch):
    """Smallest determinant of all corners, in units of the wanted volume."""
    least = 1e300
    e = scratch[0]
    for c in range(hexes.shape[0]):
        for k in range(8):
            corner_at(xyz, hexes, c, k, -1, 0.0, 0.0, 0.0, e)
            least = min(least, determinant(e) * scale[hexes[c, k]] ** 3)
    return least

"""How good a tetrahedron is: the squared sine of its worst dihedral angle."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import HELPER

#: Volumes below this share of the product of three edges are taken for none. The error of the
#: triple product is at most 4.1e-15 of that product (Shewchuk's stage A, whose permanent is at most
#: 5.2 times the product), so whatever counts as positive is positive exactly.
DOUBTFUL = 1e-14


@njit(**HELPER)
def shape(ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz):
    """Smallest squared sine of the dihedral angles of a tetrahedron; at most 0 if not positive.

    sin = 6 V l / (|n| |m|) at an edge of length l between faces with normals n, m of twice their
    area.
    """
    ux = bx - ax
    uy = by - ay
    uz = bz - az
    vx = cx - ax
    vy = cy - ay
    vz = cz - az
    wx = dx - ax
    wy = dy - ay
    wz = dz - az
    # Normals of the faces opposite d, b, c and a.
    px = uy * vz - uz * vy
    py = uz * vx - ux * vz
    pz = ux * vy - uy * vx
    qx = vy * wz - vz * wy
    qy = vz * wx - vx * wz
    qz = vx * wy - vy * wx
    rx = wy * uz - wz * uy
    ry = wz * ux - wx * uz
    rz = wx * uy - wy * ux
    sx = px + qx + rx
    sy = py + qy + ry
    sz = pz + qz + rz
    det = ux * qx + uy * qy + uz * qz
    u = ux * ux + uy * uy + uz * uz
    v = vx * vx + vy * vy + vz * vz
    w = wx * wx + wy * wy + wz * wz
    size = sqrt(u * v * w)
    if det <= DOUBTFUL * size:
        return min(det / size, 0.0) if size > 0.0 else 0.0
    p = 1.0 / (px * px + py * py + pz * pz)
    q = 1.0 / (qx * qx + qy * qy + qz * qz)
    r = 1.0 / (rx * rx + ry * ry + rz * rz)
    s = 1.0 / (sx * sx + sy * sy + sz * sz)
    ex = vx - ux
    ey = vy - uy
    ez = vz - uz
    fx = wx - ux
    fy = wy - uy
    fz = wz - uz
    gx = wx - vx
    gy = wy - vy
    gz = wz - vz
    least = min(u * p * r, min(v * p * q, w * q * r))
    least = min(least, (ex * ex + ey * ey + ez * ez) * p * s)
    least = min(least, (fx * fx + fy * fy + fz * fz) * r * s)
    least = min(least, (gx * gx + gy * gy + gz * gz) * q * s)
    return least * det * det


@njit(**HELPER)
def shape_of(xyz, a, b, c, d):
    """`shape` of four points by number."""
    a *= 3
    b *= 3
    c *= 3
    d *= 3
    return shape(
        xyz[a],
        xyz[a + 1],
        xyz[a + 2],
        xyz[b],
        xyz[b + 1],
        xyz[b + 2],
        xyz[c],
        xyz[c + 1],
        xyz[c + 2],
        xyz[d],
        xyz[d + 1],
        xyz[d + 2],
    )


@njit(**HELPER)
def shape_over(link, k, x, y, z):
    """`shape` of the tetrahedron of apex (x, y, z) over triangle k of a list of coordinates."""
    k *= 9
    return shape(
        x,
        y,
        z,
        link[k],
        link[k + 1],
        link[k + 2],
        link[k + 3],
        link[k + 4],
        link[k + 5],
        link[k + 6],
        link[k + 7],
        link[k + 8],
    )

"""Nearest faces of a triangulated boundary: facets in buckets of a regular grid."""

from __future__ import annotations

from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER
from ..tree.triangle_distance import nearest_weights

#: Places looked at between two returns to the caller.
SLICE = 4_000


@njit(**HELPER)
def closest_on_triangle(t, px, py, pz, out):
    """The point of the triangle t (9,) nearest to p, and the square of its distance."""
    v, w = nearest_weights(t, 0, px, py, pz)
    for d in range(3):
        out[d] = t[d] + v * (t[3 + d] - t[d]) + w * (t[6 + d] - t[d])
    dx = out[0] - px
    dy = out[1] - py
    dz = out[2] - pz
    return dx * dx + dy * dy + dz * dz


@njit(**ENTRY)
def fill_buckets(triangles, normal, low, side, shape, reach, begin, items, writes):
    """Count the buckets within reach of each triangle, or write it into them."""
    half = reach + 0.8660254037844387 * side
    for k in range(triangles.shape[0]):
        t = triangles[k]
        i0 = max(int((min(t[0], t[3], t[6]) - reach - low[0]) / side), 0)
        j0 = max(int((min(t[1], t[4], t[7]) - reach - low[1]) / side), 0)
        l0 = max(int((min(t[2], t[5], t[8]) - reach - low[2]) / side), 0)
        i1 = min(int((max(t[0], t[3], t[6]) + reach - low[0]) / side), shape[0] - 1)
        j1 = min(int((max(t[1], t[4], t[7]) + reach - low[1]) / side), shape[1] - 1)
        l1 = min(int((max(t[2], t[5], t[8]) + reach - low[2]) / side), shape[2] - 1)
        for i in range(i0, i1 + 1):
            x = low[0] + (i + 0.5) * side - t[0]
            for j in range(j0, j1 + 1):
                y = low[1] + (j + 0.5) * side - t[1]
                for m in range(l0, l1 + 1):
                    z = low[2] + (m + 0.5) * side - t[2]
                    off = x * normal[k, 0] + y * normal[k, 1] + z * normal[k, 2]
                    if abs(off) > half:
                        continue
                    b = (i * shape[1] + j) * shape[2] + m
                    if writes:
                        items[begin[b]] = k
                    begin[b] += 1


@njit(**HELPER)
def remember(face, square, place, faces, squares, places, n):
    """Keep the nearest faces in order; how many there are now."""
    at = n
    for s in range(n):
        if faces[s] == face:
            if squares[s] <= square:
                return n
            at = s
            break
    if at == n:
        if n == faces.shape[0]:
            if squares[n - 1] <= square:
                return n
            at = n - 1
        else:
            n += 1
    while at > 0 and squares[at - 1] > square:
        faces[at] = faces[at - 1]
        squares[at] = squares[at - 1]
        for d in range(3):
            places[at, d] = places[at - 1, d]
        at -= 1
    faces[at] = face
    squares[at] = square
    for d in range(3):
        places[at, d] = place[d]
    return n


@njit(**ENTRY)
def nearest_faces(
    points, triangles, face, low, side, shape, begin, items, faces, squares, places, spot, start
):
    """Nearest faces of places from `start` on, nearest first; the next place.

    `faces` comes filled with -1; `squares` holds squared distances; `spot` (3,) is scratch.
    """
    last = min(start + SLICE, points.shape[0])
    for p in range(start, last):
        x = points[p, 0]
        y = points[p, 1]
        z = points[p, 2]
        i = int((x - low[0]) / side)
        j = int((y - low[1]) / side)
        m = int((z - low[2]) / side)
        if x < low[0] or y < low[1] or z < low[2]:
            continue
        if i >= shape[0] or j >= shape[1] or m >= shape[2]:
            continue
        b = (i * shape[1] + j) * shape[2] + m
        n = 0
        for q in range(begin[b], begin[b + 1]):
            k = items[q]
            square = closest_on_triangle(triangles[k], x, y, z, spot)
            n = remember(face[k], square, spot, faces[p], squares[p], places[p], n)
    return last


@njit(**ENTRY)
def least_corners(points, hexes, out):
    """Smallest scaled Jacobian over the corners of each hexahedron."""
    for c in range(hexes.shape[0]):
        worst = 2.0
        for k in range(8):
            if k < 4:
                a = hexes[c, (k + 1) % 4]
                b = hexes[c, (k + 3) % 4]
            else:
                a = hexes[c, 4 + (k + 3) % 4]
                b = hexes[c, 4 + (k + 1) % 4]
            d = hexes[c, (k + 4) % 8]
            o = hexes[c, k]
            ax = points[a, 0] - points[o, 0]
            ay = points[a, 1] - points[o, 1]
            az = points[a, 2] - points[o, 2]
            bx = points[b, 0] - points[o, 0]
            by = points[b, 1] - points[o, 1]
            bz = points[b, 2] - points[o, 2]
            dx = points[d, 0] - points[o, 0]
            dy = points[d, 1] - points[o, 1]
            dz = points[d, 2] - points[o, 2]
            det = ax * (by * dz - bz * dy) + ay * (bz * dx - bx * dz) + az * (bx * dy - by * dx)
            size = sqrt(
                (ax * ax + ay * ay + az * az)
                * (bx * bx + by * by + bz * bz)
                * (dx * dx + dy * dy + dz * dz)
            )
            value = det / size if size > 0.0 else -1.0
            worst = min(worst, value)
        out[c] = worst

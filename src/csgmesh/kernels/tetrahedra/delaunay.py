"""Delaunay tetrahedra of points, by insertion one after the other in a given order.

A. Bowyer, "Computing Dirichlet tessellations"; D. F. Watson, "Computing the n-dimensional Delaunay
tessellation", both The Computer Journal 24 (1981).

The cavity of a point is all whose circumsphere holds it strictly, by an exact test. Two spheres
that meet in a plane differ by a linear function, so the point sees every face of its cavity from
the right side and none edge-on, however many points lie on one sphere: no ties have to be broken.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..pointers import ENTRY, HELPER, pointer
from ..predicates import orient2d
from .net import (
    COPLANAR,
    DONE,
    DUPLICATE,
    ROOM,
    SLICE,
    TETS,
    Net,
    in_conflict,
    orient_vertices,
    slot_of,
    walk,
)

ZERO = np.int64(0)
#: Cavities and steps after which a kernel returns to its shell: some 0.1 s of work.
EFFORT = 1000000


@njit(**HELPER)
def are_collinear(xyz, a, b, c):
    a *= 3
    b *= 3
    c *= 3
    for k in range(3):
        i = k
        j = (k + 1) % 3
        if orient2d(xyz[a + i], xyz[a + j], xyz[b + i], xyz[b + j], xyz[c + i], xyz[c + j]) != 0.0:
            return False
    return True


@njit(**HELPER)
def first_tetrahedron(net, a, b, c, d):
    """One tetrahedron of positive volume and its four ghosts."""
    vert = net.vert
    vert[0], vert[1], vert[2], vert[3] = a, b, c, d
    vert[4], vert[5], vert[6], vert[7] = b, c, d, -1
    vert[8], vert[9], vert[10], vert[11] = c, a, d, -1
    vert[12], vert[13], vert[14], vert[15] = a, b, d, -1
    vert[16], vert[17], vert[18], vert[19] = b, a, c, -1
    for t in range(5):
        net.mark[t] = 0
    for t in range(5):
        for k in range(4):
            for u in range(5):
                if u == t:
                    continue
                # The corner of u that t lacks, if t has the other three.
                found = 0
                odd = ZERO
                for m in range(4):
                    v = vert[4 * u + m]
                    if v == vert[4 * t + k]:
                        found = -4
                    is_there = False
                    for s in range(4):
                        if vert[4 * t + s] == v:
                            is_there = True
                    if is_there:
                        found += 1
                    else:
                        odd = m
                if found == 3:
                    net.nei[4 * t + k] = 4 * u + odd


@njit(**HELPER)
def seed(net, n, counts):
    """Choose four points that are not in one plane, the first ones that will do."""
    xyz = net.xyz
    i = 1
    while i < n and xyz[3 * i] == xyz[0] and xyz[3 * i + 1] == xyz[1] and xyz[3 * i + 2] == xyz[2]:
        i += 1
    j = i + 1
    while j < n and are_collinear(xyz, ZERO, i, j):
        j += 1
    k = j + 1
    o = 0.0
    while k < n:
        o = orient_vertices(xyz, ZERO, i, j, k)
        if o != 0.0:
            break
        k += 1
    if k >= n:
        return COPLANAR
    if o > 0.0:
        first_tetrahedron(net, ZERO, i, j, k)
    else:
        first_tetrahedron(net, ZERO, j, i, k)
    counts[1] = 5
    counts[2] = i
    counts[3] = j
    counts[4] = k
    return DONE


@njit(**HELPER)
def gather(net, t, x, y, z, stamp, room):
    """Cavity of a point from t, which is in it, and the faces around it; their numbers.

    mark: stamp for members, stamp + 1 for those that were looked at and are not.
    """
    vert = net.vert
    nei = net.nei
    mark = net.mark
    cavity = net.cavity
    rim = net.rim
    cavity[0] = t
    mark[t] = stamp
    n = ZERO + 1
    n_rim = ZERO
    i = ZERO
    while i < n:
        if n + 4 > room or n_rim + 4 > room:
            return -1, n_rim
        t = cavity[i]
        i += 1
        for h in range(4 * t, 4 * t + 4):
            u = nei[h] >> 2
            m = mark[u]
            if m == stamp:
                continue
            if m != stamp + 1:
                if in_conflict(net.xyz, vert, nei, u, x, y, z):
                    mark[u] = stamp
                    cavity[n] = u
                    n += 1
                    continue
                mark[u] = stamp + 1
            rim[n_rim] = h
            n_rim += 1
    return n, n_rim


@njit(**HELPER)
def fill_cavity(net, p, n, n_rim, n_tets, n_free):
    """Replace a cavity of n tetrahedra by those of vertex p and its n_rim faces."""
    vert = net.vert
    nei = net.nei
    rim = net.rim
    free = net.free
    for r in range(n_rim):
        h = rim[r]
        if n_free > 0:
            n_free -= 1
            new = free[n_free]
        else:
            new = n_tets
            n_tets += 1
        t = h & ~3
        own = 4 * new
        for k in range(4):
            vert[own + k] = vert[t + k]
            nei[own + k] = -1
        k = h & 3
        vert[own + k] = p
        outer = nei[h]
        nei[own + k] = outer
        nei[outer] = own + k
        # The face of the old one leads to the new one from now on.
        nei[h] = -1 - own
        net.mark[new] = 0
    for r in range(n_rim):
        h = rim[r]
        own = -1 - nei[h]
        i = h & 3
        for j in range(4):
            if j == i or nei[own + j] >= 0:
                continue
            # Around the edge of the other two corners, through the cavity to its rim.
            t = h >> 2
            entry = i
            leave = np.int64(j)
            ahead = nei[4 * t + leave]
            while ahead >= 0:
                v = vert[4 * t + entry]
                t = ahead >> 2
                entry = ahead & 3
                leave = slot_of(vert, t, v)
                ahead = nei[4 * t + leave]
            other = -1 - ahead + entry
            nei[own + j] = other
            nei[other] = own + j
    last = -1 - nei[rim[0]] >> 2
    for i in range(n):
        t = net.cavity[i]
        vert[4 * t] = -2
        free[n_free] = t
        n_free += 1
    return n_tets, n_free, last


@njit(**ENTRY)
def insert_in_space(points, verts, neis, marks, frees, work, counts, until):
    """Insert points counts[0] … until - 1, in this order, into the Delaunay tetrahedra.

    counts: next point, slots in use, second to fourth point of the first tetrahedron, where to
    start walking from, the duplicate found, empty slots, last stamp.
    """
    room = work.shape[1]
    slots = marks.shape[0]
    net = Net(
        pointer(points),
        pointer(verts),
        pointer(neis),
        pointer(marks),
        pointer(frees),
        pointer(work[0]),
        pointer(work[1]),
    )
    xyz = net.xyz
    vert = net.vert
    if counts[1] == 0:
        status = seed(net, until, counts)
        if status != DONE:
            return status
        counts[0] = 1
        counts[8] = 2
    n_tets = counts[1]
    t = counts[5]
    n_free = counts[7]
    stamp = counts[8]
    p = counts[0]
    effort = 0
    status = DONE
    while p < until:
        if p == counts[2] or p == counts[3] or p == counts[4]:
            p += 1
            continue
        if effort > EFFORT:
            status = SLICE
            break
        x = xyz[3 * p]
        y = xyz[3 * p + 1]
        z = xyz[3 * p + 2]
        t = walk(xyz, vert, net.nei, t, x, y, z)
        for h in range(4 * t, 4 * t + 4):
            v = 3 * vert[h]
            if v >= 0 and xyz[v] == x and xyz[v + 1] == y and xyz[v + 2] == z:
                counts[6] = vert[h]
                status = DUPLICATE
        if status != DONE:
            break
        stamp += 2
        n, n_rim = gather(net, t, x, y, z, stamp, room)
        if n < 0:
            status = ROOM
            break
        if n_tets + n_rim > slots:
            status = TETS
            break
        n_tets, n_free, t = fill_cavity(net, p, n, n_rim, n_tets, n_free)
        effort += n + n_rim
        p += 1
    counts[0] = p
    counts[1] = n_tets
    counts[5] = t
    counts[7] = n_free
    counts[8] = stamp
    return status

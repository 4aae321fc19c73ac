"""Flat tetrahedra on flat faces: they leave the mesh, and the surface runs over them.

Rounding moves points of a flat face off its plane, so that four of them have a volume. Where two
of its faces are triangles of the surface and there is nothing beyond, the other two replace them.
"""

from __future__ import annotations

import numpy as np

from csgmesh.meshers.tetrahedra.net import Net
from csgmesh.meshers.tetrahedra.swaps import apart
from csgmesh.tolerance import ON_CURVE_SHARE, accuracy

#: A tetrahedron is flat whose height is not above that many times what vertices may be off their
#: exact surfaces.
_FLAT = 10.0
#: Taking one away may leave the next with two faces on the surface.
_ROUNDS = 20
#: Faces of a tetrahedron, counterclockwise seen from outside, each opposite to a corner.
_FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])


def peel(
    net: Net,
    triangles: np.ndarray,
    where: np.ndarray,
    face: np.ndarray,
    region: np.ndarray,
    label: np.ndarray,
) -> np.ndarray:
    """Take flat tetrahedra off the outside; the surface's triangles.

    Parameters
    ----------
    net : Net
    triangles : (m, 3) int64
    where : (m,) int64
        Faces of the net that these are.
    face : (m,) int64
    region : (m, 2) int64
        Behind and in front of each triangle.
    label : (n_slots,) int32
        Region of each slot; those that are taken away get -1.
    """
    triangles, where = triangles.copy(), where.copy()
    points = net.xyz.reshape(-1, 3)
    flat = _FLAT * accuracy(ON_CURVE_SHARE, net.diagonal, points[net.order < net.n_points])
    n = len(triangles)
    is_outer = (region < 0).any(axis=1)
    for _ in range(_ROUNDS):
        own = np.flatnonzero(is_outer)
        sides = np.concatenate([where[own], net.nei[where[own]]])
        wall = np.concatenate([own, own])
        inside = label[sides >> 2] >= 0
        sides, wall = sides[inside], wall[inside]
        order = np.argsort(sides, kind="stable")
        sides, wall = sides[order], wall[order]
        _, first, count = np.unique(sides >> 2, return_index=True, return_counts=True)
        two = first[count == 2]
        pair = np.column_stack([wall[two], wall[two + 1]])
        rows = net.vert[(sides[two] >> 2)[:, None] * 4 + np.arange(4)]
        fits = (face[pair[:, 0]] == face[pair[:, 1]]) & (_heights(points, rows) <= flat)
        two, pair, rows = two[fits], pair[fits], rows[fits]
        if not len(two):
            break
        chosen = apart(pair, n)
        two, pair, rows = two[chosen], pair[chosen], rows[chosen]
        taken = np.column_stack([sides[two], sides[two + 1]]) & 3
        is_left = np.ones((len(two), 4), bool)
        np.put_along_axis(is_left, taken.astype(np.int64), False, axis=1)
        left = np.nonzero(is_left)[1].reshape(-1, 2)
        was_behind = region[pair[:, 0], 0] >= 0
        for turn in range(2):
            new = np.take_along_axis(rows, _FACES[left[:, turn]], axis=1)
            new[was_behind] = new[was_behind][:, ::-1]
            triangles[pair[:, turn]] = net.order[new]
            where[pair[:, turn]] = (sides[two] & ~3) + left[:, turn]
        label[sides[two] >> 2] = -1
    return triangles


def _heights(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Height of tetrahedra (k, 4) over their largest face, (k,)."""
    a, b, c, d = (points[rows[:, k]] for k in range(4))
    normals = [np.cross(b - a, c - a), np.cross(b - a, d - a), np.cross(c - a, d - a)]
    normals.append(np.cross(c - b, d - b))
    area = np.sqrt(np.max([(normal * normal).sum(axis=1) for normal in normals], axis=0))
    return np.asarray(np.abs((normals[0] * (d - a)).sum(axis=1)) / area)

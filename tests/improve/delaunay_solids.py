"""Delaunay tetrahedra of solids, with the slivers that these have: food for improvement."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.spatial import Delaunay

import csgmesh as cm
from csgmesh.domain.surface_mesh import SurfaceMesh


def spiral(n):
    """Points spread evenly over the unit sphere."""
    k = np.arange(n) + 0.5
    polar, turn = np.arccos(1 - 2 * k / n), np.pi * (1 + 5**0.5) * k
    ring = np.sin(polar)
    return np.column_stack([np.cos(turn) * ring, np.sin(turn) * ring, np.cos(polar)])


def lattice(h, rng):
    """Body-centred points in the cube from -1 to 1, not quite regular."""
    a = 2 * h / np.sqrt(3)
    line = np.arange(-1, 1 + a, a)
    points = np.stack(np.meshgrid(line, line, line), -1).reshape(-1, 3)
    points = np.concatenate([points, points + a / 2])
    return points + 1e-6 * rng.normal(size=points.shape)


def delaunay(points):
    """Positively oriented tetrahedra, none without volume."""
    tets = Delaunay(points).simplices.astype(np.int64)
    a, b, c, d = (points[tets[:, k]] for k in range(4))
    volume = ((b - a) * np.cross(c - a, d - a)).sum(axis=1)
    tets[volume < 0] = tets[volume < 0][:, [0, 2, 1, 3]]
    return tets[np.abs(volume) > 1e-15]


def outer_faces(tets):
    """Faces of one tetrahedron, counterclockwise from outside."""
    faces = np.concatenate([tets[:, k] for k in ([1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1])])
    _, first, count = np.unique(np.sort(faces), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def ball(h):
    """Points, tets, regions, triangles, faces and surface mesh of the unit ball; and the ball."""
    solid = cm.Ball((0, 0, 0), 1)
    rng = np.random.default_rng(0)
    shell = spiral(int(14.5 / h**2))
    inner = lattice(h, rng)
    inner = inner[np.sqrt((inner**2).sum(axis=1)) < 1 - 0.6 * h]
    points = np.concatenate([shell, inner])
    tets = delaunay(points)
    triangles = outer_faces(tets)
    zeros = np.zeros(len(triangles), np.int64)
    surface = SurfaceMesh(
        *(shell, triangles, zeros, zeros[:1], zeros[:1], np.array([[0, -1]])),
        *(np.zeros((0, 2), np.int64), zeros[:0], np.zeros((0, 2), np.int64)),
        *(np.full(len(shell), 2, np.int8), np.zeros(len(shell), np.int64), cm.evaluate(solid)),
    )
    return (points, tets, np.zeros(len(tets), np.int64), triangles, zeros, surface), solid


def box_around_ball(h, keep_ball=False, radius=0.55):
    """The same of a box less a ball, points shaken within their faces and edges.

    With `keep_ball` the ball is a second region.
    """
    solid = cm.Box((-1, -1, -1), (1, 1, 1)) - cm.Ball((0, 0, 0), radius)
    plc, rng = cm.evaluate(solid), np.random.default_rng(1)
    sides = [(axis, sign) for axis in range(3) for sign in (-1, 1)]
    flat = plc.surfaces.kind == 0
    normal = plc.surfaces.plane_normals
    on_side = [
        next(s for s in np.flatnonzero(flat) if normal[s, axis] * sign > 0.9)
        for axis, sign in sides
    ]
    face_surface = np.array([*on_side, int(np.flatnonzero(~flat)[0])])
    shell, dim, owner, pairs = _points_on(h, radius, sides, face_surface, rng)
    inner = lattice(h, rng)
    r = np.sqrt((inner**2).sum(axis=1))
    deep = (np.abs(inner).max(axis=1) < 1 - 0.6 * h) & (np.abs(r - radius) > 0.6 * h)
    points = np.concatenate([shell, inner[deep & (keep_ball | (r > radius))]])
    tets = delaunay(points)
    on_ball = np.zeros(len(points), bool)
    on_ball[: len(shell)] = (dim == 2) & (owner == 6)
    centre = points[tets].mean(axis=1)
    inside = np.where(
        on_ball[tets].any(axis=1),
        on_ball[tets].all(axis=1) | (np.sqrt((centre**2).sum(axis=1)) < 0.97 * radius),
        np.sqrt((centre**2).sum(axis=1)) < radius,
    )
    triangles = outer_faces(tets[~inside])
    face = np.full(len(triangles), 6)
    for k, (axis, sign) in enumerate(sides):
        face[(np.abs(points[triangles][:, :, axis] - sign) < 1e-12).all(axis=1)] = k
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2))
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, of = edges[order][::2], np.repeat(face, 3)[order].reshape(-1, 2)
    sharp = of[:, 0] != of[:, 1]
    curve = [pairs.index(tuple(sorted(pair))) for pair in of[sharp].tolist()]
    marker = [int(plc.facet_marker[plc.facet_surface == s][0]) for s in face_surface]
    beside = np.tile([0, -1], (7, 1))
    if keep_ball:
        beside[6, 1] = 1
    surface = SurfaceMesh(
        *(shell, triangles, face, face_surface, np.array(marker), beside),
        *(edges[sharp], np.array(curve), face_surface[np.array(pairs)], dim, owner, plc),
    )
    region = inside.astype(np.int64)
    kept = np.full(len(tets), True) if keep_ball else ~inside
    return (points, tets[kept], region[kept], triangles, face, surface), solid


def _points_on(h, radius, sides, face_surface, rng):
    """Points of the boundary with their strata, and the pairs of faces that curves lie on."""
    points = [np.array(c, float) for c in itertools.product((-1, 1), repeat=3)]
    dim, owner, pairs = [0] * 8, list(range(8)), []
    n = round(2 / h)

    def shake():
        return 0.3 * h * rng.uniform(-1, 1)

    for axis in range(3):
        others = [a for a in range(3) if a != axis]
        for signs in itertools.product((-1, 1), repeat=2):
            for x in np.linspace(-1, 1, n + 1)[1:-1]:
                point = np.zeros(3)
                point[axis], point[others] = x + shake(), signs
                points.append(point)
            dim += [1] * (n - 1)
            owner += [len(pairs)] * (n - 1)
            pairs.append(tuple(sides.index(side) for side in zip(others, signs, strict=True)))
    for k, (axis, sign) in enumerate(sides):
        others = [a for a in range(3) if a != axis]
        rows = round(2 / (h * 0.87))
        for row in range(1, rows):
            for x in np.arange(-1 + (h if row % 2 else 0.5 * h), 1 - 0.3 * h, h):
                point = np.zeros(3)
                point[axis] = sign
                point[others] = x + shake(), -1 + 2 * row / rows + shake()
                points.append(point)
                dim.append(2)
                owner.append(k)
    hole = radius * spiral(int(14.5 * radius**2 / h**2))
    points.extend(hole)
    dim += [2] * len(hole)
    owner += [6] * len(hole)
    return np.array(points), np.array(dim, np.int8), np.array(owner), pairs


def as_mesh(parts, surface):
    """What improvement returns as a mesh that knows its domain."""
    points, tets, region, triangles, face = parts
    plc = surface.plc
    return cm.Mesh(
        points,
        {"tetra": tets},
        {"tetra": region},
        [*plc.region_names, *(f"inner{k}" for k in range(1, region.max() + 1))],
        {"triangle": triangles},
        {"triangle": surface.face_marker[face]},
        plc.boundary_names,
        {"triangle": surface.face_region[face]},
        domain=plc,
    )

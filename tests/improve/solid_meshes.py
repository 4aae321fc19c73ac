"""Meshes of space to refine, elevate, locate in and measure: by sweeps, and of tetrahedra."""

from __future__ import annotations

import functools

import numpy as np
from scipy.spatial import Delaunay

import csgmesh as cm

BALL = cm.Ball((0, 0, 0), 1, name="ball")
#: A ball cut by a plane: a curved face and a flat one, which meet in a circle.
DOME = BALL & cm.HalfSpace((0, 0, 0.2), (0, 0, -1), name="floor")
WASHER = cm.Extrude(cm.Disk((0, 0), 2, name="rim") - cm.Disk((0, 0), 1, name="bore"), 0.5)
BOWL = cm.Revolve(cm.Disk((0, 2), 2) - cm.Disk((0, 2), 1.5) - cm.HalfSpace((0, 2), (0, -1)))

SWEPT = {
    "wedges": (WASHER, cm.Sweep()),
    "hexahedra": (WASHER, cm.Sweep(cm.QuadPairing())),
    "wedges, pyramids and tetrahedra": (BOWL, cm.Sweep()),
    "hexahedra at an axis": (cm.Revolve(cm.Box((0, 0), (1, 2)), 120), cm.Sweep(cm.Structured())),
    "pyramids at an axis": (
        cm.Revolve(cm.Polygon([(0, 0), (1, -1), (2, 0), (1, 1)], name="diamond")),
        cm.Sweep(cm.Structured()),
    ),
    "stretched": (WASHER.scale((0.5, 1, 1)), cm.Sweep()),
}


@functools.cache
def swept(name: str) -> cm.Mesh:
    """A mesh by `Sweep`, of size 0.4."""
    shape, mesher = SWEPT[name]
    return cm.generate(shape, mesher, size=0.4)


def _sphere(n: int) -> np.ndarray:
    """Points spread evenly over the unit sphere, on a spiral."""
    k = np.arange(n) + 0.5
    z, turn = 1 - 2 * k / n, np.pi * (1 + np.sqrt(5)) * k
    r = np.sqrt(1 - z**2)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def _inside(h: float, reach: float) -> np.ndarray:
    """Points of a body-centred lattice within a radius."""
    n = int(np.ceil(1 / h))
    grid = np.stack(np.meshgrid(*[np.arange(-n, n + 1) * h] * 3), axis=3).reshape(-1, 3)
    points = np.concatenate([grid, grid + 0.5 * h])
    # Off the lattice by a little: no eight points of it lie on one sphere any more.
    points += 0.05 * h * np.random.default_rng(1).uniform(-1, 1, points.shape)
    return points[(points**2).sum(axis=1) < reach**2]


@functools.cache
def ball(h: float) -> cm.Mesh:
    """Tetrahedra in the unit ball, of about size h."""
    surface = _sphere(int(4 * np.pi / (0.8 * h**2)))
    return convex(np.concatenate([surface, _inside(h, 1 - 0.6 * h)]), BALL)


@functools.cache
def dome(h: float) -> cm.Mesh:
    """Tetrahedra in the part of the unit ball above z = 0.2, of about size h."""
    surface, floor, radius = _sphere(int(4 * np.pi / (0.8 * h**2))), 0.2, np.sqrt(0.96)
    n = int(np.ceil(2 * np.pi * radius / h))
    turn = 2 * np.pi * np.arange(n) / n
    rim = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(n, floor)])
    flat = np.stack(np.meshgrid(*[np.arange(-1, 1, h)] * 2), axis=2).reshape(-1, 2) + 0.3 * h
    flat = flat[(flat**2).sum(axis=1) < (radius - 0.5 * h) ** 2]
    base = np.column_stack([flat, np.full(len(flat), floor)])
    inner = _inside(h, 1 - 0.6 * h)
    parts = [
        surface[surface[:, 2] > floor + 0.5 * h],
        rim,
        base,
        inner[inner[:, 2] > floor + 0.4 * h],
    ]
    return convex(np.concatenate(parts), DOME)


def convex(points: np.ndarray, shape: cm.Shape) -> cm.Mesh:
    """The Delaunay tetrahedra of points of a convex solid, its facets named by its surfaces."""
    plc = cm.evaluate(shape)
    corners = Delaunay(points).simplices.astype(np.int64)
    a, b, c = (points[corners[:, k]] - points[corners[:, 0]] for k in (1, 2, 3))
    volume = (a * np.cross(b, c)).sum(axis=1)
    corners[volume < 0] = corners[volume < 0][:, [1, 0, 2, 3]]
    corners = corners[np.abs(volume) > 1e-12]
    faces = np.concatenate([corners[:, k] for k in ([0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2])])
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    hull = faces[np.sort(first[count == 1])]
    flat = points[hull].reshape(-1, 3)
    off = np.stack(
        [
            plc.surfaces.distance(np.full(len(flat), s), flat).reshape(-1, 3).max(axis=1)
            for s in range(len(plc.surfaces))
        ]
    )
    surface = np.where((off < 1e-12).any(axis=0), (off < 1e-12).argmax(axis=0), off.argmin(axis=0))
    # Where all corners lie on the rim of two surfaces, the flat one is meant.
    marker_of = dict(zip(plc.facet_surface.tolist(), plc.facet_marker.tolist(), strict=True))
    ambiguous = (off < 1e-12).sum(axis=0) > 1
    surface[ambiguous] = np.flatnonzero(plc.surfaces.kind == 0)[:1].repeat(ambiguous.sum())
    marker = np.array([marker_of[s] for s in surface.tolist()])
    used, renumbered = np.unique(corners, return_inverse=True)
    new = np.full(len(points), -1)
    new[used] = np.arange(len(used))
    return cm.Mesh(
        points[used],
        {"tetra": renumbered.reshape(corners.shape)},
        region_names=plc.region_names,
        facets={"triangle": new[hull]},
        facet_marker={"triangle": marker},
        boundary_names=plc.boundary_names,
        facet_region={"triangle": np.tile([0, -1], (len(hull), 1))},
        domain=plc,
    )

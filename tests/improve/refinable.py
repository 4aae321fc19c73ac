"""Meshes to refine, elevate and smooth: triangles, quads and both, straight and curved."""

from __future__ import annotations

import functools

import numpy as np

import csgmesh as cm
from csgmesh.mesh import Mesh

BOX = cm.Box((0, 0), (4, 2), name="plate")
SHAPES = {
    "square": (cm.Box((0, 0), (1, 1)), 0.2),
    "disk": (cm.Disk((0, 0), 1), 0.3),
    "regions": (
        cm.Regions({"rock": BOX - cm.Disk((1, 1), 0.5, name="hole"), "core": cm.Disk((3, 1), 0.4)}),
        0.4,
    ),
    "crack": (
        cm.Embed(
            cm.Disk((0, 0), 1),
            [
                cm.EmbeddedPath([(-0.5, 0.0), (0.0, 0.1), (0.5, 0.0)], name="crack"),
                cm.EmbeddedPoints([(0.1, 0.5)], name="probe"),
            ],
        ),
        0.3,
    ),
    "wedge": (cm.Polygon([(0, 0), (4, 0), (4, 1)]) | cm.Disk((4, 0.5), 0.7), 0.4),
    "lens": (cm.Disk((0, 0), 2) ^ cm.Disk((1.5, 0), 1), 0.4),
    "ellipse": (cm.Ellipse((0, 0), (3, 1), angle=20), 0.4),
}


@functools.cache
def mesh_of(name: str) -> Mesh:
    shape, size = SHAPES[name]
    return cm.generate(shape, size=size)


def quads(n: int, noise: float = 0.0, triangles: bool = False) -> Mesh:
    """An n by n grid on the unit square, its inner vertices moved at random, some cells cut."""
    x, y = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    points = np.column_stack([x.ravel(), y.ravel()])
    inner = (points > 0).all(axis=1) & (points < 1).all(axis=1)
    points[inner] += noise / n * np.random.default_rng(5).uniform(-1, 1, (int(inner.sum()), 2))
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    corners = (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1])
    rows = np.stack([c.ravel() for c in corners], axis=1)
    cells = {"quad": rows}
    if triangles:
        cut = rows[::3]
        cells = {
            "triangle": np.concatenate([cut[:, [0, 1, 2]], cut[:, [0, 2, 3]]]),
            "quad": np.delete(rows, np.s_[::3], axis=0),
        }
    sides = [at[0, :], at[:, -1], at[-1, ::-1], at[::-1, 0]]
    lines = np.concatenate([np.stack([s[:-1], s[1:]], axis=1) for s in sides])
    return Mesh(
        points,
        cells,
        facets={"line": lines},
        facet_marker={"line": np.repeat(np.arange(4), n)},
        facet_region={"line": np.tile([0, -1], (4 * n, 1))},
        boundary_names=[["bottom"], ["right"], ["top"], ["left"]],
    )

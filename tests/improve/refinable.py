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


@functools.cache
def with_quads(name: str) -> Mesh:
    """A mesh of the catalogue with pairs of its triangles joined to quads where they fit."""
    mesh = mesh_of(name)
    rows = mesh.cells["triangle"]
    half_edges = {
        (a, b): (t, k)
        for t, r in enumerate(rows.tolist())
        for k, (a, b) in enumerate(zip(r, r[1:] + r[:1], strict=True))
    }
    facets = {tuple(sorted(f)) for f in mesh.facets["line"].tolist()}
    taken, found = set(), []
    for (a, b), (t, k) in half_edges.items():
        s, j = half_edges.get((b, a), (-1, 0))
        if s < 0 or t in taken or s in taken or tuple(sorted((a, b))) in facets:
            continue
        quad = [a, int(rows[s, (j + 2) % 3]), b, int(rows[t, (k + 2) % 3])]
        flat = Mesh(mesh.points, {"quad": [quad]})
        if cm.quality(flat).scaled_jacobian[0] > 0.3:
            taken |= {s, t}
            found.append(quad)
    rest = np.setdiff1d(np.arange(len(rows)), sorted(taken))
    region = mesh.cell_region["triangle"]
    owner = [half_edges[q[0], q[2]][0] for q in found]
    fields = {
        f: getattr(mesh, f)
        for f in (
            "facets",
            "facet_marker",
            "facet_region",
            "facet_curve",
            "facet_interval",
            "boundary_names",
            "region_names",
            "curves",
            "domain",
            "point_marker",
        )
    }
    return Mesh(
        mesh.points,
        {"triangle": rows[rest], "quad": found},
        {"triangle": region[rest], "quad": region[owner]},
        **fields,
    )

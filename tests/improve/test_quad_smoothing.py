"""Smoothing with quads: never a worse cell, never one turned over, boundaries on their curves."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refinable import SHAPES, mesh_of, quads

import csgmesh as cm
from csgmesh.improve.stars import BEST, Stars
from csgmesh.mesh import Mesh

METHODS = ("laplace", "odt", "optimize")


def with_quads(name: str) -> Mesh:
    """A mesh of the catalogue, refined beside some quads that pairs of its triangles make."""
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


@pytest.mark.parametrize("name", ["disk", "regions", "crack", "lens"])
@pytest.mark.parametrize("method", METHODS)
def test_no_cell_gets_worse_than_the_worst(name: str, method: str) -> None:
    mesh = with_quads(name)
    better = cm.smooth(mesh, method)
    assert Stars(better).qualities().min() >= Stars(mesh).qualities().min()
    certificate = cm.check(better, SHAPES[name][0])
    assert certificate.ok, str(certificate)
    assert better.names == mesh.names


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), method=st.sampled_from(METHODS), triangles=st.booleans())
def test_random_grids_never_get_worse(seed: int, method: str, triangles: bool) -> None:
    mesh = quads(5, 0.0, triangles)
    rng = np.random.default_rng(seed)
    inner = (mesh.points > 0.01).all(axis=1) & (mesh.points < 0.99).all(axis=1)
    moved = mesh.points + inner[:, None] * rng.uniform(-0.09, 0.09, mesh.points.shape)
    rough = Mesh(moved, mesh.cells)
    if cm.check(rough)["orientation"].status != "passed":
        return
    better = cm.smooth(rough, method)
    assert Stars(better).qualities().min() >= Stars(rough).qualities().min()
    assert cm.check(better)["orientation"].status == "passed"
    assert (better.points[~inner] == rough.points[~inner]).all()


def test_a_rough_grid_becomes_square_again() -> None:
    mesh = quads(6, 0.35)
    assert cm.quality(mesh).scaled_jacobian.min() < 0.75
    better = cm.smooth(cm.smooth(mesh, "laplace", sweeps=40), "optimize")
    assert cm.quality(better).scaled_jacobian.min() > 0.999


def test_turned_over_cells_can_be_righted() -> None:
    mesh = quads(3)
    points = np.array(mesh.points)
    points[5] = [0.8, 0.8]
    tangled = Mesh(points, mesh.cells)
    stars = Stars(tangled)
    assert stars.qualities().min() < 0
    for _ in range(5):
        stars.move(BEST)
    assert stars.qualities().min() > 0.9

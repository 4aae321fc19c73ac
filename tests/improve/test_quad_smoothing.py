"""Smoothing with quads: never a worse cell, never one turned over, boundaries on their curves."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refinable import SHAPES, quads, with_quads

import csgmesh as cm
from csgmesh.improve.stars import BEST, Stars
from csgmesh.mesh import Mesh

METHODS = ("laplace", "odt", "optimize")


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

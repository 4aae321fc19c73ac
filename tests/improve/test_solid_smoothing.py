"""Smoothing in space: no worst cell gets worse, surfaces and names stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from delaunay_solids import as_mesh, ball, box_around_ball

import csgmesh as cm
from csgmesh.errors import InputError


def worst(mesh):
    measured = cm.quality(mesh)
    return min(measured.min_dihedral.min(), 180 - measured.max_dihedral.max())


@pytest.mark.parametrize("method", ["laplace", "odt", "optimize"])
@pytest.mark.parametrize("make", [ball, box_around_ball])
def test_the_worst_cell_gets_better_and_the_solid_stays(make, method):
    (*parts, surface), solid = make(0.3)
    mesh = as_mesh(parts, surface)
    better = cm.smooth(mesh, method)
    assert worst(better) > worst(mesh)
    assert cm.check(better, solid).ok
    assert better.names == mesh.names
    if method == "optimize":
        assert worst(better) > 15
    else:
        assert (better.cells["tetra"] == mesh.cells["tetra"]).all()
        assert (better.facets["triangle"] == mesh.facets["triangle"]).all()
    corners = [c for c in mesh.points if (np.abs(c) == 1).all()]
    assert all((better.points == c).all(axis=1).any() for c in corners)


@pytest.mark.parametrize("method", ["laplace", "odt"])
def test_shaken_vertices_settle(method):
    (*parts, surface), _ = ball(0.3)
    mesh = as_mesh(parts, surface)
    shake = 0.03 * np.random.default_rng(0).normal(size=mesh.points.shape)
    shake[np.sqrt((mesh.points**2).sum(axis=1)) > 0.6] = 0
    shaken = replace(mesh, points=mesh.points + shake)
    assert cm.check(shaken)["orientation"].failures == ()
    mean = [cm.quality(m).min_dihedral.mean() for m in (shaken, cm.smooth(shaken, method))]
    assert mean[1] > mean[0] + 0.5


@pytest.mark.parametrize("method", ["odt", "optimize"])
def test_a_boundary_without_facets_stays(method):
    (*parts, surface), _ = box_around_ball(0.3, keep_ball=True)
    whole = as_mesh(parts, surface)
    bare = cm.Mesh(whole.points, whole.cells, whole.cell_region, whole.region_names)
    better = cm.smooth(bare, method)
    on = np.unique(whole.facets["triangle"])
    assert (better.points[on] == bare.points[on]).all()
    volumes = [np.bincount(m.cell_region["tetra"], cm.quality(m).volume) for m in (bare, better)]
    np.testing.assert_allclose(*volumes, rtol=1e-12)
    assert cm.check(better)["orientation"].failures == ()
    assert cm.check(better)["conforming"].failures == ()


@pytest.mark.parametrize("method", ["odt", "optimize"])
def test_facets_without_exact_surfaces_keep_their_points(method):
    (*parts, surface), _ = box_around_ball(0.3)
    bare = replace(as_mesh(parts, surface), domain=None)
    better = cm.smooth(bare, method)
    on = np.unique(bare.facets["triangle"])
    assert (better.points[on] == bare.points[on]).all()
    assert (better.points != bare.points).any()
    assert (better.facets["triangle"] == bare.facets["triangle"]).all()
    assert cm.check(better).ok
    assert worst(better) >= worst(bare)


def test_points_may_stand_in_any_order():
    (*parts, surface), solid = ball(0.4)
    mesh = as_mesh(parts, surface)
    order = np.random.default_rng(0).permutation(mesh.n_points)
    number = np.argsort(order)
    shuffled = replace(
        mesh,
        points=mesh.points[order],
        cells={"tetra": number[mesh.cells["tetra"]]},
        facets={"triangle": number[mesh.facets["triangle"]]},
    )
    better = cm.smooth(shuffled, "optimize")
    assert cm.check(better, solid).ok
    assert worst(better) > 15


@pytest.mark.parametrize("method", ["laplace", "odt"])
@pytest.mark.parametrize("mesher", [cm.Sweep(), cm.Sweep(cm.QuadPairing())], ids=["wedge", "hex"])
def test_other_cells_are_smoothed_inside(mesher, method):
    pipe = cm.Extrude(cm.Disk((0, 0), 2) - cm.Disk((0, 0), 1), 1)
    mesh = cm.generate(pipe, mesher, size=0.4)
    inner = np.setdiff1d(
        np.arange(mesh.n_points), np.concatenate([r.ravel() for r in mesh.facets.values()])
    )
    points = np.array(mesh.points)
    points[inner] += 0.06 * np.random.default_rng(0).normal(size=(len(inner), 3))
    shaken = replace(mesh, points=points)
    better = cm.smooth(shaken, method)
    assert cm.check(better, pipe).ok
    assert worst(better) > worst(shaken)
    assert cm.quality(better).min_jacobian.min() > 0
    moved = (better.points != shaken.points).any(axis=1)
    assert moved[inner].any()
    assert moved.sum() == moved[inner].sum()


def test_other_cells_are_not_flipped():
    mesh = cm.generate(cm.Box((0, 0, 0), (1, 1, 1)), cm.Sweep(), size=0.5)
    with pytest.raises(InputError, match=r"'optimize' is for straight tetrahedra.* holds wedge"):
        cm.smooth(mesh, "optimize")

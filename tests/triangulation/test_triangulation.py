"""Delaunay functions beside scipy's, and what they do with degenerate input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.csgraph import minimum_spanning_tree as scipy_tree
from scipy.spatial import ConvexHull, Delaunay, cKDTree
from scipy.spatial.distance import cdist

import csgmesh as cm
from csgmesh import kernels
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh

RNG = np.random.default_rng(11)
CLOUD = RNG.random((400, 2))
GRID = np.stack(np.meshgrid(np.arange(7.0), np.arange(6.0)), axis=-1).reshape(-1, 2)


def as_sets(rows: np.ndarray) -> set[tuple[int, ...]]:
    return {tuple(sorted(row)) for row in rows.tolist()}


def lengths(points: np.ndarray, edges: np.ndarray) -> np.ndarray:
    return np.hypot(*(points[edges[:, 0]] - points[edges[:, 1]]).T)


def test_triangles_hull_and_balls_are_those_of_scipy() -> None:
    mesh = cm.delaunay(CLOUD)
    assert as_sets(mesh.cells["triangle"]) == as_sets(Delaunay(CLOUD).simplices)
    assert as_sets(mesh.facets["line"]) == as_sets(ConvexHull(CLOUD).simplices)
    certificate = cm.check(mesh)
    assert certificate.ok, str(certificate)
    centres, radii = cm.delaunay_balls(mesh)
    corners = CLOUD[mesh.cells["triangle"]]
    reach = np.hypot(*np.moveaxis(corners - centres[:, None], 2, 0))
    assert reach == pytest.approx(np.tile(radii[:, None], 3), rel=1e-9)
    assert (cdist(centres, CLOUD).min(axis=1) >= radii * (1 - 1e-9)).all()


def test_points_on_a_grid_are_triangulated_without_gaps() -> None:
    mesh = cm.delaunay(GRID)
    assert mesh.n_cells == 2 * 6 * 5
    assert cm.quality(mesh).total_area == 30
    assert len(mesh.facets["line"]) == 2 * (6 + 5)
    assert cm.check(mesh).ok


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(4, 120), grid=st.booleans())
def test_flips_lead_from_any_triangulation_to_delaunay(seed: int, n: int, grid: bool) -> None:
    rng = np.random.default_rng(seed)
    points = np.unique(rng.integers(0, 12, (n, 2)), axis=0).astype(float)
    points = points if grid else rng.random((n, 2))
    # A triangulation with long triangles: Delaunay after a shear, seen without it.
    try:
        sheared = cm.delaunay(points @ [[1.0, 0.0], [0.0, 64.0]])
    except InputError:
        return
    mesh = cm.flip_to_delaunay(replace(sheared, points=points, info={}))
    certificate = cm.check(mesh)
    assert certificate.ok, str(certificate)
    wanted = cm.quality(cm.delaunay(points)).min_angle.min()
    assert cm.quality(mesh).min_angle.min() == pytest.approx(wanted, abs=1e-6)
    rows = mesh.cells["triangle"]
    for _ in range(5):
        others = rng.integers(0, len(points), len(rows))
        assert (kernels.in_circles(points, rows, others) <= 0).all()


def test_flips_keep_facets_and_regions() -> None:
    shape = cm.Regions({"rock": cm.Box((0, 0), (4, 2)), "core": cm.Disk((2, 1), 0.7)})
    mesh = cm.generate(shape, size=0.3)
    rough = cm.smooth(mesh, "optimize")
    flipped = cm.flip_to_delaunay(rough)
    certificate = cm.check(flipped, shape)
    assert certificate["Delaunay"].failures == ()
    assert certificate["conforming"].status == certificate["facets"].status == "passed"


def test_the_certificate_fails_a_promise_of_delaunay() -> None:
    kite = Mesh(
        [[0, 0], [1, -0.2], [2, 0], [1, 0.2]],
        {"triangle": [[0, 1, 2], [0, 2, 3]]},
        facets={"line": [[0, 1], [1, 2], [2, 3], [3, 0]]},
        facet_region={"line": [[0, -1]] * 4},
        facet_marker={"line": [0] * 4},
        boundary_names=[["rim"]],
    )
    assert cm.check(kite).ok
    promised = cm.check(replace(kite, info={"delaunay": True}))
    assert [failure.rule for failure in promised.failures] == ["Delaunay"]
    assert cm.check(cm.flip_to_delaunay(kite)).ok


def test_neighbours_and_tree_are_those_of_scipy() -> None:
    nearest = cm.nearest_neighbours(CLOUD)
    assert (nearest == cKDTree(CLOUD).query(CLOUD, 2)[1][:, 1]).all()
    tree = cm.minimum_spanning_tree(CLOUD)
    wanted = scipy_tree(cdist(CLOUD, CLOUD)).tocoo()
    assert as_sets(tree) == as_sets(np.stack([wanted.row, wanted.col], axis=1))


@pytest.mark.parametrize(
    "points",
    [
        GRID,
        np.repeat(CLOUD[:50], 2, axis=0),
        np.outer(RNG.random(30), [1.0, 2.0]),
        [[0, 0], [3, 4]],
    ],
    ids=["grid", "repeated", "line", "two"],
)
def test_graphs_of_degenerate_points_have_the_right_lengths(points) -> None:
    points = np.asarray(points, float)
    nearest = cm.nearest_neighbours(points)
    away = cdist(points, points) + np.diag(np.full(len(points), np.inf))
    assert (nearest != np.arange(len(points))).all()
    found = lengths(points, np.stack([np.arange(len(points)), nearest], axis=1))
    assert found == pytest.approx(away.min(axis=1), abs=1e-12)
    tree = cm.minimum_spanning_tree(points)
    assert len(tree) == len(points) - 1
    # Without zeros, which scipy takes for no edge.
    wanted = scipy_tree(cdist(points, points) + 1.0).sum() - (len(points) - 1)
    assert lengths(points, tree).sum() == pytest.approx(wanted, abs=1e-9)


def nearest_site_areas(sites: np.ndarray, shape: cm.Shape, n: int) -> np.ndarray:
    lo, hi = cm.evaluate(shape).bounds()
    grid = np.stack(np.meshgrid(*(np.linspace(a, b, n) for a, b in zip(lo, hi, strict=True))), -1)
    grid = grid.reshape(-1, 2)
    inside = grid[shape.contains(grid)]
    count = np.bincount(cKDTree(sites).query(inside)[1], minlength=len(sites))
    return count * np.prod(hi - lo) / n**2


def test_voronoi_cells_are_the_nearest_parts_of_the_domain() -> None:
    shape = cm.Box((0, 0), (2, 1)) - cm.Disk((1, 0.5), 0.3) - cm.Box((0.9, -0.1), (1.1, 0.3))
    sites = RNG.random((60, 2)) * [2, 1]
    diagram = cm.voronoi(sites, shape)
    assert diagram.areas.sum() == pytest.approx(cm.evaluate(shape).chord_areas().sum(), abs=1e-12)
    assert diagram.areas == pytest.approx(nearest_site_areas(sites, shape, 500), abs=2e-3)
    for site, rings, area in zip(sites, diagram.cells, diagram.areas, strict=True):
        total = 0.0
        for ring in rings:
            (x, y), (u, v) = ring.T, np.roll(ring, -1, axis=0).T
            total += 0.5 * (x * v - y * u).sum()
            gap = cdist(ring, sites).min(axis=1)
            assert np.hypot(*(ring - site).T) == pytest.approx(gap, abs=1e-9)
        assert total == pytest.approx(area, abs=1e-12)


def test_voronoi_takes_meshes_lines_and_single_sites() -> None:
    mesh = cm.generate(cm.Disk((0, 0), 1), size=0.4)
    diagram = cm.voronoi(mesh)
    assert diagram.areas.sum() == pytest.approx(cm.quality(mesh).total_area, abs=1e-12)
    assert len(diagram.cells) == mesh.n_points
    assert cm.voronoi([[0.3, 0.2]], cm.Box((0, 0), (1, 1))).areas == pytest.approx([1])
    row = np.stack([np.arange(4) + 0.5, np.full(4, 0.5)], axis=1)
    assert cm.voronoi(row, cm.Box((0, 0), (4, 1))).areas == pytest.approx([1] * 4)
    assert cm.voronoi(GRID).areas.sum() > 30


def test_what_cannot_be_triangulated_is_refused() -> None:
    with pytest.raises(InputError, match=r"points 1 and 3 are both \(1, 0\)"):
        cm.delaunay([[0, 0], [1, 0], [0, 1], [1, 0]])
    with pytest.raises(InputError, match="lie on one line"):
        cm.delaunay([[0, 0], [1, 1], [2, 2], [5, 5]])
    with pytest.raises(InputError, match="needs three points; got 2"):
        cm.delaunay([[0, 0], [1, 1]])
    with pytest.raises(InputError, match="point 1 is"):
        cm.delaunay([[0, 0], [np.nan, 1], [2, 2]])
    with pytest.raises(InputError, match=r"shape \(n, 2\) or \(n, 3\)"):
        cm.delaunay([0, 1, 2])
    with pytest.raises(InputError, match="are both"):
        cm.voronoi([[0, 0], [0, 0], [1, 1]])
    with pytest.raises(InputError, match="need two points"):
        cm.nearest_neighbours([[0, 0]])
    with pytest.raises(InputError, match="must be counterclockwise"):
        cm.flip_to_delaunay(Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 2, 1]]}))

"""Sizes in space and the lattice inside a solid, before any mesh is made of them."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import csgmesh as cm
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.errors import BudgetError, NameLookupError, SizeError
from csgmesh.mesh.faces import faces_of
from csgmesh.meshers.octree.lattice import lattice
from csgmesh.meshers.octree.sizes import SpaceSizes

SOLID = (
    cm.Box((0, 0, 0), (1, 1, 1), name="box")
    - cm.Ball((0.3, 0.3, 0.3), 0.2, name="ball")
    - cm.Cylinder((0.7, 0.7, -1), (0.7, 0.7, 2), 0.15, name="bore")
)
DOMAIN = cm.evaluate(SOLID)


def facets_as_surface(plc):
    """The facets of evaluation as a surface mesh of one face."""
    none = np.zeros(0, np.int64)
    face = np.zeros(plc.n_facets, np.int64)
    return SurfaceMesh(
        plc.points,
        plc.facets,
        face,
        face[:1],
        face[:1],
        np.array([[0, -1]]),
        none.reshape(-1, 2),
        none,
        none.reshape(-1, 2),
        np.full(plc.n_points, 2, np.int8),
        np.zeros(plc.n_points, np.int64),
        plc,
    )


SURFACE = facets_as_surface(DOMAIN)
SIZES = {
    "uniform": 0.05,
    "undercut": 0.12,
    "by name": {"bore": 0.02, "default": 0.2},
    "callable": lambda p: 0.03 + 0.2 * np.abs(p[:, 0] - 0.5),
    "none": None,
}


def distance_from_surface(points):
    exact = np.stack(
        [
            np.abs(np.sqrt(((points - 0.3) ** 2).sum(axis=1)) - 0.2),
            np.abs(np.hypot(*(points[:, :2] - 0.7).T) - 0.15),
            np.minimum(points, 1 - points).min(axis=1),
        ]
    )
    return exact.min(axis=0)


@pytest.mark.parametrize("name", SIZES)
def test_lattices_are_inside_clear_of_the_surface_and_strictly_delaunay(name):
    sizes = SpaceSizes.of(DOMAIN, SIZES[name], 0.3, 10**7)
    grid = lattice(sizes, SURFACE)
    points, kept = grid.points, grid.kept
    assert (DOMAIN.oracle.region(points) >= 0).all()
    # A leaf is at least 0.7 of the size wide, and facets are no further off than the deviation.
    clear = 0.9 * 0.56 * 0.7 * sizes(points) - DOMAIN.deviation
    assert (distance_from_surface(points) > clear).all()
    corner = points[kept]
    edges = corner[:, 1:] - corner[:, :1]
    assert (np.linalg.det(edges) > 0).all()
    faces = faces_of({"tetra": kept})
    assert faces.count.max() == 2 and (faces.n_behind[faces.count == 2] == 1).all()
    to_centre = np.linalg.solve(2 * edges, (edges**2).sum(axis=2)[..., None])[..., 0]
    radius = np.sqrt((to_centre**2).sum(axis=1))
    centre = corner[:, 0] + to_centre
    away = cKDTree(points).query(centre, k=5)[0][:, 4]
    assert (away > radius * (1 + 1e-9)).all()
    assert (cKDTree(SURFACE.points).query(centre)[0] > radius).all()


def test_uniform_lattices_have_edges_of_the_size_on_average():
    sizes = SpaceSizes.of(DOMAIN, 0.03, 0.3, 10**7)
    assert sizes.uniform == 0.03
    grid = lattice(sizes, SURFACE)
    a, b = grid.kept[:, [0, 0, 0, 1, 1, 2]], grid.kept[:, [1, 2, 3, 2, 3, 3]]
    pairs = np.unique(np.sort(np.stack([a, b], axis=-1).reshape(-1, 2), axis=1), axis=0)
    length = np.sqrt(((grid.points[pairs[:, 0]] - grid.points[pairs[:, 1]]) ** 2).sum(axis=1))
    assert abs(length.mean() / 0.03 - 1) < 0.01
    assert length.min() > 0.9 * 0.03 and length.max() < 1.1 * 0.03


def test_sizes_grow_no_faster_than_the_gradation():
    sizes = SpaceSizes.of(DOMAIN, {"bore": 0.01, "default": 0.3}, 0.2, 10**7)
    rng = np.random.default_rng(3)
    points = rng.random((20_000, 3))
    off = np.hypot(*(points[:, :2] - 0.7).T) - 0.15
    h, wanted = sizes(points[off > 0]), np.minimum(0.01 + 0.2 * off[off > 0], 0.3)
    assert (h <= 1.35 * wanted).all() and np.median(h / wanted) > 0.9


def test_curvature_bounds_chords_and_short_edges_count():
    ball = cm.evaluate(cm.Ball((0, 0, 0), 1), deviation=0.01)
    h = SpaceSizes.of(ball, 0.9, 0.3, 10**6)(np.array([[1.0, 0, 0], [0, 0, 0]]))
    assert abs(h[0] / (2 * np.sqrt(2 * 0.01)) - 1) < 1e-3 and h[1] > 1.5 * h[0]
    notched = cm.evaluate(cm.Box((0, 0, 0), (1, 1, 1)) - cm.Box((0.9, 0.9, 0.9), (2, 2, 2)))
    h = SpaceSizes.of(notched, 0.4, 0.3, 10**6)(np.array([[0.9, 0.9, 0.9], [0.0, 0.0, 0.0]]))
    assert h[0] <= 0.1 + 1e-12 and h[1] > 0.3


def test_a_size_that_makes_no_sense_outside_is_not_asked_there():
    inner = lambda p: 0.4 - np.sqrt(((p - 0.5) ** 2).sum(axis=1))  # noqa: E731
    ball = cm.evaluate(cm.Ball((0.5, 0.5, 0.5), 0.3))
    assert SpaceSizes.of(ball, inner, 0.3, 10**6)(np.full((1, 3), 0.5)) > 0


def test_errors():
    with pytest.raises(SizeError, match="positive and finite; got 0"):
        SpaceSizes.of(DOMAIN, 0, 0.3, 10**6)
    with pytest.raises(SizeError, match=r"positive and finite; got nan at \("):
        SpaceSizes.of(DOMAIN, lambda p: np.where(p[:, 0] > 0.5, np.nan, 0.1), 0.3, 10**6)
    with pytest.raises(SizeError, match="one number per point"):
        SpaceSizes.of(DOMAIN, lambda p: p, 0.3, 10**6)
    with pytest.raises(NameLookupError, match="bor"):
        SpaceSizes.of(DOMAIN, {"bor": 0.1}, 0.3, 10**6)
    with pytest.raises(BudgetError, match=r"about 1\.\d+e\+09 points, max_points allows 1,000,000"):
        SpaceSizes.of(DOMAIN, 1e-3, 0.3, 10**6)
    with pytest.raises(BudgetError, match=r"more than 1,000 leaves .* is at"):
        SpaceSizes.of(DOMAIN, {"bore": 0.02, "default": 0.2}, 0.3, 10**3)

"""Fields in space: the sizes that they mean, and the edges that meshers make of them."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

BLOCK = cm.Box((0, 0, 0), (4, 2, 2), name="block") - cm.Ball((1, 1, 1), 0.5, name="void")
SHELL = cm.Regions({"rock": BLOCK, "core": cm.Ball((1, 1, 1), 0.5)})

#: Field, solid, points, the sizes there, what facets and exact surfaces may differ by.
FIELDS = {
    "near a plane": (
        cm.NearSize("block.left", 0.05, within=1),
        BLOCK,
        [(0, 1, 1), (0.9, 1, 1), (3, 1, 1)],
        [0.05, 0.05, 0.65],
        1e-12,
    ),
    "near a sphere": (
        cm.NearSize("void", 0.05, gradation=0.5),
        BLOCK,
        [(1, 1, 1.5), (1, 1, 2), (4, 1, 1)],
        [0.05, 0.3, 1.3],
        1e-3,
    ),
    "region": (
        cm.RegionSize({"core": 0.1}),
        SHELL,
        [(1, 1, 1), (1.4, 1, 1), (2.5, 1, 1)],
        [0.1, 0.1, 0.4],
        1e-3,
    ),
    "curvature": (
        cm.CurvatureSize(24),
        BLOCK,
        [(1, 1, 1.5), (3.5, 1, 1)],
        [np.pi / 24, np.pi / 24 + 0.6],
        1e-3,
    ),
    "features": (
        cm.FeatureSize(5),
        BLOCK,
        [(1, 1, 1.5), (1, 1, 1.8), (1, 0, 1)],
        [0.1, 0.1, 0.1],
        1e-3,
    ),
    "names in a product": (
        cm.minimum({"void": 0.1, "default": 0.4}, 1.0) * 0.5,
        BLOCK,
        [(1, 1, 1.5), (4, 1, 1)],
        [0.05, 0.2],
        1e-3,
    ),
}


@pytest.mark.parametrize("name", FIELDS)
def test_fields_mean_the_same_as_in_the_plane(name: str) -> None:
    field, solid, points, sizes, slack = FIELDS[name]
    found = field.bind(cm.evaluate(solid))(np.array(points, float))
    np.testing.assert_allclose(found, sizes, atol=slack)


def test_nothing_thin_nothing_bent_asks_for_nothing() -> None:
    wedge = cm.evaluate(cm.Tetrahedron((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
    for field in (cm.CurvatureSize(24), cm.FeatureSize(3)):
        assert field.bind(wedge)(np.zeros((1, 3))) == wedge.diagonal


def test_sizes_by_distance_grow_as_asked() -> None:
    field = cm.NearSize("void", 0.08, gradation=0.4)
    domain = cm.evaluate(BLOCK)
    h = field.bind(domain)
    points = np.random.default_rng(0).random((2000, 3)) * (4, 2, 2)
    away = np.linalg.norm(points - 1, axis=1) - 0.5
    away[away < 0] *= -1
    expected = 0.08 + 0.4 * away
    assert abs(h(points) - expected).max() <= 0.4 * domain.deviation + 1e-12


def test_edges_follow_a_field() -> None:
    size = cm.minimum(cm.NearSize("void", 0.15), 0.4)
    mesh = cm.generate(BLOCK, size=size)
    assert cm.check(mesh, BLOCK).ok
    tets = mesh.cells["tetra"]
    edges = np.concatenate([tets[:, [a, b]] for a in range(4) for b in range(a)])
    a, b = mesh.points[edges[:, 0]], mesh.points[edges[:, 1]]
    share = np.linalg.norm(a - b, axis=1) / size.bind(mesh.domain)(0.5 * (a + b))
    # Leaves of an octree are half or twice as large.
    assert 0.6 < np.median(share) < 1.2
    assert share.max() < 2.2
    again = cm.generate(BLOCK, cm.SurfaceRefinement(), size=size)
    corners = again.points[again.facets["triangle"][again.boundary("void")["triangle"]]]
    assert 0.12 < np.linalg.norm(corners[:, 0] - corners[:, 1], axis=1).mean() < 0.18


def test_fields_are_read_from_domain_files(tmp_path) -> None:
    path = tmp_path / "part.yaml"
    path.write_text("""csgmesh: 1
shapes:
  part: {difference: [{box: {lo: [0, 0, 0], hi: [2, 1, 1]}},
                      {ball: {center: [0.5, 0.5, 0.5], radius: 0.3, name: void}}]}
domain: part
mesh:
  size:
    minimum:
      - near_size: {names: part.void, size: 0.08, gradation: 0.2}
      - feature_size: 2
      - 0.3
""")
    file = cm.load(path)
    found = file.size.bind(cm.evaluate(file.shape))(np.array([[0.5, 0.5, 0.8], [2.0, 0.5, 0.5]]))
    np.testing.assert_allclose(found, [0.08, 0.3], atol=1e-3)


def test_what_has_no_meaning_is_refused_by_name() -> None:
    domain = cm.evaluate(BLOCK)
    with pytest.raises(cm.NameLookupError, match=r"'viod'.*did you mean 'void'"):
        cm.NearSize("viod", 0.1).bind(domain)
    with pytest.raises(cm.NameLookupError, match=r"region.*'core'"):
        cm.RegionSize({"core": 0.1}).bind(domain)
    grid = cm.BackgroundSize(([0, 1], [0, 1]), [[0.1, 0.1], [0.3, 0.3]])
    with pytest.raises(cm.SizeError, match=r"needs a domain in the plane.*callable"):
        cm.generate(BLOCK, size=grid)
    with pytest.raises(cm.InputError, match="generate_to_budget meshes domains in the plane"):
        cm.generate_to_budget(BLOCK, cells=1000)


def test_regions_are_given_by_a_mapping() -> None:
    with pytest.raises(cm.SizeError, match="map names of regions to sizes; got 'core'"):
        cm.RegionSize("core")

"""Size fields say at every point what their names promise, and combine."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import csgmesh as cm
from csgmesh.errors import NameLookupError, SizeError
from csgmesh.size import pointwise
from csgmesh.size.sources import GradedSources

PLATE = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
RANDOM = np.random.default_rng(0)
ANYWHERE = RANDOM.uniform((0, 0), (4, 2), (500, 2))


def at(field, shape, *points):
    return field.bind(cm.evaluate(shape))(np.array(points, float))


def distances(a, b, points):
    along = b - a
    share = ((points[:, None] - a) * along).sum(2) / np.maximum((along**2).sum(1), 1e-300)
    nearest = a + np.clip(share, 0, 1)[..., None] * along
    return np.hypot(*np.moveaxis(nearest - points[:, None], 2, 0))


@given(seed=st.integers(0, 10**6), n=st.integers(1, 40), growth=st.sampled_from([0.05, 1.0]))
def test_the_search_tree_finds_the_lowest_of_all_sources(seed, n, growth):
    rng = np.random.default_rng(seed)
    a = rng.integers(0, 4, (n, 2)) / 4.0
    b = a + rng.integers(-1, 2, (n, 2)) / 8.0
    value, reach = 10 ** rng.uniform(-3, 0, n), rng.uniform(0, 0.2, n)
    points = rng.uniform(-1, 2, (50, 2))
    asked = value + growth * np.maximum(distances(a, b, points) - reach, 0)
    found, which = GradedSources(np.stack([a, b], axis=1), value, reach, growth).lowest(points)
    np.testing.assert_allclose(found, asked.min(axis=1), rtol=1e-12)
    np.testing.assert_allclose(asked[np.arange(50), which], found, rtol=1e-12)


def test_near_size_grows_with_the_exact_distance():
    h = cm.NearSize("hole", 0.03, gradation=0.2, within=0.1).bind(cm.evaluate(PLATE))
    away = np.abs(np.hypot(*(ANYWHERE - (2, 1)).T) - 0.5)
    exact = 0.03 + 0.2 * np.maximum(away - 0.1, 0)
    # A sixteenth of the chords' deviation, 1e-3 of the disk's extent.
    assert np.abs(h(ANYWHERE) - exact).max() < 0.2 * 1e-3 / 16
    walls = cm.NearSize(["plate.left", "plate.top"], 0.1)
    assert at(walls, PLATE, (1, 0.5), (3, 1.5)) == pytest.approx([0.1 + 0.3 * 1, 0.1 + 0.3 * 0.5])


def test_near_size_knows_embedded_points():
    probe = cm.Embed(cm.Box((0, 0), (4, 2)), [cm.EmbeddedPoints([(3, 1)], name="probe")])
    assert at(cm.NearSize("probe", 0.01), probe, (3, 1), (2, 1)) == pytest.approx([0.01, 0.31])


def test_region_size_holds_inside_and_grows_outside():
    rock = cm.Regions({"rock": cm.Box((0, 0), (4, 2)), "core": cm.Box((2, 0), (3, 1))})
    field = cm.RegionSize({"core": 0.05}, gradation=0.5)
    values = at(field, rock, (2.5, 0.5), (2, 0.5), (1, 0.5), (2.5, 1.4))
    assert values == pytest.approx([0.05, 0.05, 0.55, 0.25])
    both = cm.RegionSize({"core": 0.05, "rock": 0.2}, gradation=0.5)
    assert at(both, rock, (1.9, 0.5), (0.5, 0.5)) == pytest.approx([0.1, 0.2])


def test_curvature_size_divides_the_circle():
    field = cm.CurvatureSize(points_per_circle=40)
    for radius in (0.1, 0.5):
        plate = cm.Box((0, 0), (4, 2)) - cm.Disk((2, 1), radius)
        assert at(field, plate, (2 + radius, 1)) == pytest.approx([2 * np.pi * radius / 40])
    oval = cm.Ellipse((0, 0), (2, 1))
    tip, side = at(cm.CurvatureSize(40, gradation=0.01), oval, (2, 0), (0, 1))
    assert tip == pytest.approx(2 * np.pi * 0.5 / 40, rel=0.02)
    assert side <= 2 * np.pi * 4 / 40
    square = cm.Box((0, 0), (3, 4))
    assert at(field, square, (1, 1)) == pytest.approx([5.0])


def test_feature_size_divides_gaps_wherever_they_are():
    channel = cm.Box((0, 0), (4, 0.3)) | cm.Box((4, -1), (6, 1))
    across = [(x, y) for x in (0.5, 1.7, 3.1) for y in (0.0, 0.1, 0.3)]
    assert at(cm.FeatureSize(6), channel, *across) == pytest.approx([0.05] * 9)
    ring = cm.Disk((0, 0), 1) - cm.Disk((0, 0), 0.99)
    assert at(cm.FeatureSize(2), ring, (0, 0.995), (-0.99, 0)) == pytest.approx(
        [0.005] * 2, rel=0.1
    )
    apart = cm.Box((-3, -3), (3, 3)) - cm.Disk((-1, 0), 0.999) - cm.Disk((1, 0), 0.999)
    assert at(cm.FeatureSize(4), apart, (0, 0)) == pytest.approx([0.0005], rel=0.1)
    tips = cm.Box((-1, -1), (1, 1)) - cm.Polygon([(-0.01, 0), (-0.5, 0.3), (-0.5, -0.3)])
    tips -= cm.Polygon([(0.01, 0), (0.5, 0.3), (0.5, -0.3)])
    assert at(cm.FeatureSize(2), tips, (0, 0)) == pytest.approx([0.01], rel=0.01)


def test_feature_size_leaves_corners_and_bends_alone():
    for shape in (cm.Box((0, 0), (1, 1)), cm.Disk((0, 0), 0.5), cm.RegularPolygon((0, 0), 0.5, 40)):
        domain = cm.evaluate(shape)
        lowest = cm.FeatureSize(2).bind(domain)(domain.points).min()
        assert lowest == pytest.approx(0.5, rel=0.02)
    wedge = cm.evaluate(cm.Polygon([(0, 0), (2, 0), (2, 0.1)]))
    # Of the two corners at the short side, and growing from there.
    values = cm.FeatureSize(2, gradation=1.0).bind(wedge)(np.array([[2.0, 0.05], [1.0, 0.02]]))
    assert values[0] == pytest.approx(0.05)
    assert values[1] > 0.9
    inside_crescent = at(
        cm.FeatureSize(4), cm.Disk((0, 0), 1) - cm.Disk((0.15, 0), 0.95), (-0.9, 0)
    )
    assert inside_crescent == pytest.approx([0.2 / 4], rel=0.02)


def test_feature_size_of_a_slit_in_the_middle_of_nowhere_is_found():
    """A wall of one segment, 1e5 times as long as the gap at one place of it."""
    tooth = cm.Polygon([(0.7013, 1e-5), (0.9, 0.3), (0.5, 0.3)])
    shape = cm.Box((0, 0), (1, 1)) - tooth
    assert at(cm.FeatureSize(2), shape, (0.7013, 0)) == pytest.approx([5e-6], rel=0.01)


@pytest.mark.parametrize(
    "field",
    [
        cm.NearSize("hole", 0.02, 0.25),
        cm.CurvatureSize(30, 0.25),
        cm.FeatureSize(5, 0.25),
        cm.minimum(cm.NearSize("plate.left", 0.02, 0.2), cm.FeatureSize(3, 0.25)).clamp(0.05, 0.2),
    ],
    ids=lambda field: type(field).__name__,
)
def test_no_field_grows_faster_than_its_gradation(field):
    h = field.bind(cm.evaluate(PLATE))
    a, b = ANYWHERE[:250], ANYWHERE[250:]
    for share in (1.0, 1e-3):
        c = a + share * (b - a)
        assert (np.abs(h(a) - h(c)) <= 0.25 * np.hypot(*(a - c).T) * (1 + 1e-9)).all()


def test_background_on_a_mesh_and_on_a_grid():
    mesh = cm.generate(cm.Box((0, 0), (1, 1)), size=0.3)
    plane = cm.BackgroundSize(mesh, 0.1 + mesh.points @ [0.2, 0.1])
    points = RANDOM.uniform(0, 1, (50, 2))
    values = plane.bind(cm.evaluate(PLATE))(points)
    np.testing.assert_allclose(values, 0.1 + points @ [0.2, 0.1])
    assert at(plane, PLATE, (5, 0.5), (-1, -1)) == pytest.approx([0.35, 0.1])
    x, y = np.array([0, 0.3, 1]), np.array([0, 2])
    grid = cm.BackgroundSize((x, y), 0.1 + x[:, None] + 0.5 * y)
    assert at(grid, PLATE, (0.2, 1), (0.65, 2), (9, 9)) == pytest.approx([0.8, 1.75, 2.1])


def test_combinations_do_what_they_say():
    near, ramp = cm.NearSize("hole", 0.02), lambda points: 0.1 + points[:, 0]
    points = [(2.5, 1), (3.5, 1), (0, 0)]
    a, b = at(near, PLATE, *points), np.array([2.6, 3.6, 0.1])
    assert at(near * 2, PLATE, *points) == pytest.approx(2 * a)
    assert at(2 * near, PLATE, *points) == pytest.approx(2 * a)
    assert at(near / 4, PLATE, *points) == pytest.approx(a / 4)
    assert at(near * ramp, PLATE, *points) == pytest.approx(a * b)
    assert at(cm.minimum(near, ramp, 0.3), PLATE, *points) == pytest.approx(
        np.clip(a, 0, [0.3, 0.3, 0.1])
    )
    assert at(near.clamp(0.1, 0.2), PLATE, *points) == pytest.approx(np.clip(a, 0.1, 0.2))
    named = cm.minimum({"plate.left": 0.01, "default": 0.5}, near)
    assert at(named, PLATE, (0, 1), (4, 1), (2.5, 1)) == pytest.approx([0.01, 0.47, 0.02])


def test_even_combinations_stay_even():
    domain = cm.evaluate(PLATE)
    for field in (cm.UniformSize(0.1) * 2, cm.minimum(0.3, 0.2), cm.UniformSize(0.5).clamp(hi=0.2)):
        assert field.bind(domain) == cm.UniformSize(0.2)


def test_fields_are_values():
    a = cm.minimum(cm.NearSize(["hole"], 0.02), cm.FeatureSize(3), 0.2) * 2
    b = cm.minimum(cm.NearSize("hole", 0.02), cm.FeatureSize(3.0), 0.2) * 2
    assert a == b
    assert hash(a) == hash(b)
    assert pickle.loads(pickle.dumps(a)) == a
    assert cm.RegionSize({"core": 1}) == pickle.loads(pickle.dumps(cm.RegionSize({"core": 1})))


def test_a_mapping_at_points_means_what_it_means_to_the_mesher():
    rock = cm.Regions({"rock": cm.Box((0, 0), (4, 2)), "core": cm.Box((2, 0), (3, 1))})
    h = pointwise({"core": 0.05, "box.left": lambda p: 0.01 + 0 * p[:, 0], "default": 0.5},
                  cm.evaluate(rock))  # fmt: skip
    found = h(np.array([[2.5, 0.5], [0, 1], [1, 1], [4, 2], [1.8, 0.5]]))
    assert found == pytest.approx([0.05, 0.01, 0.31, 0.05 + 0.3 * np.sqrt(2), 0.11])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: cm.NearSize("hole", -1), "NearSize: size must be positive.*-1"),
        (lambda: cm.NearSize([], 1), "NearSize: names"),
        (lambda: cm.NearSize("hole", 1, within=-2), "within must be positive.*-2"),
        (lambda: cm.RegionSize({}), "at least one region"),
        (lambda: cm.CurvatureSize(2), "at least 3; got 2"),
        (lambda: cm.FeatureSize("many"), "cells must be a number; got 'many'"),
        (lambda: cm.minimum(), "at least one size"),
        (lambda: cm.minimum(0.1, "x"), "must be a number, a callable or a SizeField; got 'x'"),
        (lambda: cm.FeatureSize() / 0, "divisor of a size must be positive"),
        (lambda: cm.FeatureSize().clamp(2, 1), "lo must not exceed hi; got 2 and 1"),
        (lambda: cm.BackgroundSize(([0, 1], [1, 0]), np.ones((2, 2))), "y must be .*increasing"),
        (lambda: cm.BackgroundSize(([0, 1], [0, 1]), np.ones((2, 3))), "shape .2, 2.; got .2, 3."),
        (lambda: cm.BackgroundSize(([0, 1], [0, 1]), -np.ones((2, 2))), "positive.*-1"),
        (lambda: cm.BackgroundSize(5, [1]), "must be a Mesh"),
    ],
)  # fmt: skip
def test_bad_fields_say_what_is_wrong(make, message):
    with pytest.raises(SizeError, match=message):
        make()


def test_names_are_looked_up_on_the_domain():
    with pytest.raises(NameLookupError, match="did you mean 'hole'"):
        cm.generate(PLATE, size=cm.NearSize("hloe", 0.1))
    with pytest.raises(NameLookupError, match="region"):
        cm.generate(PLATE, size=cm.minimum(cm.RegionSize({"rock": 0.1}), 0.3))
    with pytest.raises(SizeError, match=r"positive and finite; got -1 at \("):
        cm.generate(PLATE, size=cm.minimum(lambda points: np.full(len(points), -1.0), 1))

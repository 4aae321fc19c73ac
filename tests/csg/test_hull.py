"""Hulls: exact where they promise it, convex, and the same shape to every question."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy import pi
from scipy.spatial import ConvexHull

import csgmesh as cm

SIDE = st.floats(-3, 3).map(lambda x: round(x, 2))
SIZE = st.floats(0.1, 1.5).map(lambda x: round(x, 2))


def convex_area(disks):
    """Area of the hull of points on the circles; 3,000 on each leave out a millionth."""
    t = 2 * pi * np.arange(3000) / 3000
    circle = np.column_stack([np.cos(t), np.sin(t)])
    return ConvexHull(np.concatenate([np.array(c) + r * circle for c, r in disks])).volume


@settings(max_examples=15)
@given(st.lists(st.tuples(st.tuples(SIDE, SIDE), SIZE), min_size=1, max_size=6))
def test_a_hull_of_disks_is_exact(disks):
    hull = cm.Hull([cm.Disk(c, r) for c, r in disks])
    domain = cm.evaluate(hull)
    assert domain.areas()[0] == pytest.approx(convex_area(disks), rel=1e-6)
    low, high = hull.bounds()
    centres, radii = np.array([c for c, _ in disks]), np.array([r for _, r in disks])[:, None]
    np.testing.assert_allclose(low, (centres - radii).min(axis=0), atol=1e-9)
    np.testing.assert_allclose(high, (centres + radii).max(axis=0), atol=1e-9)
    assert domain.names == ("hull",)


@pytest.mark.parametrize(
    ("shapes", "area"),
    [
        ([cm.Disk((0, 0), 1), cm.Disk((3, 0), 1)], pi + 6),
        ([cm.Disk((0, 0), 1), cm.Disk((0, 0), 0.5)], pi),
        ([cm.Box((0, 0), (1, 1)), cm.Box((2, 2), (3, 3))], 5),
        ([cm.Box((0, 0), (4, 4)) - cm.Disk((0, 0), 1)], 15.5),
        ([cm.Disk((0, 0), 1) & cm.HalfSpace((0, 0), (0, -1)), cm.Triangle((0, 0), (1, 0), (0, -1))],
         pi / 2 + 1 / 2 + 1 / 2),
        ([cm.Polygon([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)])], 16),
        ([cm.Disk((0, 0), 1).scale((3, 1))], 3 * pi),
        ([cm.Disk((0, 0), 1) & cm.Disk((9, 9), 1), cm.Box((0, 0), (1, 1))], 1),
    ],
)  # fmt: skip
def test_areas_in_the_plane(shapes, area):
    assert cm.evaluate(cm.Hull(shapes)).areas()[0] == pytest.approx(area, rel=1e-9)


def test_a_corner_between_two_stretches_of_one_arc():
    ellipse, corner = cm.Ellipse((0, 0), (1, 3)), cm.Triangle((0, 0), (2, 0), (0, 1))
    hull = cm.Hull([ellipse, corner])
    assert hull.bounds()[1].tolist() == [2, 3]
    # Seen from (2, 0), in the ellipse's own measure at the distance 2, the tangents touch the unit
    # circle at ±60°: a kite of two right triangles, less their sector, added to the circle.
    assert cm.evaluate(hull).areas()[0] == pytest.approx(3 * (pi + 3**0.5 - pi / 3))


def cylinder_plate():
    return cm.Hull([cm.Cylinder((x, y, 0), (x, y, 2), 0.5) for x in (0, 3) for y in (0, 2)])


SOLIDS = {
    "boxes": (cm.Hull([cm.Box((0, 0, 0), (1, 1, 1)), cm.Box((2, 2, 2), (3, 3, 3))]), 7.0, 12),
    "plate": (cylinder_plate(), 2 * (6 + 5 + pi / 4), 2 + 8),
    "tilted plate": (
        cylinder_plate().rotate(40, axis=(1, 2, 3)).scale(2),
        16 * (6 + 5 + pi / 4),
        10,
    ),
    "capsule": (
        cm.Hull([cm.Ball((0, 0, 0), 1), cm.Ball((1, 2, 2), 1)]),
        4 * pi / 3 + 3 * pi,
        3,
    ),
    "ball and cone": (
        cm.Hull([cm.Ball((0, 0, 0), 1), cm.Cone((0, 0, 0), (0, 0, 2), 0.1)]),
        2 * pi / 3 + pi * (1 / 2 - 1 / 24) + pi * 0.75 * 1.5 / 3,
        2,
    ),
    "block and cylinder": (
        cm.Hull([cm.Box((-1, -1, 0), (0, 1, 3)), cm.Cylinder((0, 0, 3), (0, 0, 0), 1)]),
        3 * (2 + pi / 2),
        6,
    ),
    "cut box": (
        cm.Hull([cm.Box((0, 0, 0), (2, 2, 2)) - cm.Box((1, 1, 1), (3, 3, 3))]),
        8 - 1 / 6,
        7,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SOLIDS)
def test_volumes_in_space(name):
    hull, volume, n_surfaces = SOLIDS[name]
    plc = cm.evaluate(hull, deviation=5e-4)
    assert plc.volumes()[0] == pytest.approx(volume, rel=2e-3)
    assert len(plc.surfaces) == n_surfaces
    assert plc.names == ("hull",)
    assert plc.euler_characteristic() == 2
    low, high = hull.bounds()
    np.testing.assert_allclose(plc.bounds()[0], low, atol=1e-3)
    np.testing.assert_allclose(plc.bounds()[1], high, atol=1e-3)
    # What contains says is what the boundary encloses.
    rng = np.random.default_rng(1)
    box = high - low
    points = rng.uniform(low - 0.1 * box, high + 0.1 * box, (40_000, 3))
    share = hull.contains(points).mean()
    assert share * np.prod(1.2 * box) == pytest.approx(volume, rel=0.03)


def test_other_hulls_are_polyhedra_within_their_deviation():
    ball, box = cm.Ball((0, 0, 0), 1), cm.Box((1, 1, 1), (2, 2, 2))
    coarse, fine = (cm.Hull([ball, box], deviation=d) for d in (1e-2, 1e-3))
    for hull, deviation in ((coarse, 1e-2), (fine, 1e-3)):
        rng = np.random.default_rng(2)
        directions = rng.normal(size=(500, 3))
        directions /= np.sqrt((directions**2).sum(axis=1))[:, None]
        exact = np.maximum(1.0, np.maximum(directions, 2 * directions).sum(axis=1))
        reach = hull.support(directions)
        assert (reach <= exact + 1e-12).all()
        assert (exact - reach).max() <= deviation
    assert cm.evaluate(fine).n_facets > cm.evaluate(coarse).n_facets


def test_a_hull_is_a_value():
    hull = cm.Hull([cm.Disk((0, 0), 1, name="a"), cm.Box((1, 1), (2, 2))], name="web")
    assert cm.Shape.from_dict(hull.to_dict()) == hull
    assert eval(repr(hull), vars(cm)) == hull
    assert hash(hull) != hash(cm.Hull([cm.Disk((0, 0), 1)]))
    assert (hull.named("part") - cm.Disk((0, 0), 0.2)).bounds()[1].tolist() == [2, 2]


def test_a_sweep_recognises_a_hull_of_prisms():
    hull = cylinder_plate()
    mesh = cm.generate(hull, cm.Sweep(), size=0.5)
    assert "wedge" in mesh.cells
    assert cm.check(mesh, hull).ok


@pytest.mark.parametrize(
    ("shapes", "said"),
    [
        ([], "at least one shape; got none"),
        ([cm.Disk((0, 0), 1), cm.Ball((0, 0, 0), 1)], "number 1 has 3, the first has 2"),
        ([3], "number 0 is 3"),
        (cm.Disk((0, 0), 1), "a sequence of shapes"),
    ],
)
def test_refusals(shapes, said):
    with pytest.raises(cm.ShapeError, match=said):
        cm.Hull(shapes)


@pytest.mark.parametrize(
    ("shape", "said"),
    [
        (cm.HalfSpace((0, 0), (0, 1)), "shape 0 must be bounded"),
        (cm.HalfSpace((0, 0, 0), (0, 0, 1)), "shape 0 must be bounded"),
        (cm.Disk((0, 0), 1) & cm.Disk((3, 0), 1), "all of them are"),
        (cm.Ball((0, 0, 0), 1) & cm.Ball((3, 0, 0), 1), "all of them are"),
    ],
)
def test_refusals_on_first_use(shape, said):
    hull = cm.Hull([shape])
    with pytest.raises(cm.ShapeError, match=said):
        cm.evaluate(hull)


def test_hulls_nest_so_deep_and_no_deeper():
    hull = cm.Disk((0, 0), 1)
    for _ in range(16):
        hull = cm.Hull([hull])
    assert cm.evaluate(hull).areas()[0] == pytest.approx(pi)
    with pytest.raises(cm.ShapeError, match="at most 16 deep"):
        cm.Hull([hull | cm.Disk((1, 0), 1)])


def test_hulls_in_domain_files(tmp_path):
    path = tmp_path / "slot.yaml"
    path.write_text(
        "csgmesh: 1\n"
        "shapes:\n"
        "  pin: {disk: {center: [0, 0], radius: 1}}\n"
        "  slot:\n"
        "    hull:\n"
        "      - pin\n"
        "      - {disk: {center: [3, 0], radius: 1}}\n"
        "domain: slot\n"
    )
    shape = cm.load(path).shape
    assert cm.evaluate(shape).areas()[0] == pytest.approx(pi + 6)
    for broken, place in (("radius: -1}}\ndomain", "7:41"), ("radios: 1}}\ndomain", "7:33")):
        path.write_text(path.read_text().replace("radius: 1}}\ndomain", broken))
        with pytest.raises(cm.DomainFileError, match=place):
            cm.load(path)
        path.write_text(path.read_text().replace(broken, "radius: 1}}\ndomain"))

"""Leaves in space: membership, boxes around them, text and refusals."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import csgmesh as cm

CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
L_SHAPE = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]


def l_prism() -> cm.Polyhedron:
    """A prism over an L, whose end faces are not convex."""
    points = [(x, y, z) for z in (0, 1) for x, y in L_SHAPE]
    walls = [(k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k) for k in range(6)]
    return cm.Polyhedron(points, [tuple(range(5, -1, -1)), tuple(range(6, 12)), *walls])


def radius(p: np.ndarray) -> np.ndarray:
    return np.hypot(p[:, 0], p[:, 1])


LEAVES = {
    "box": (cm.Box((-1, 0, 0), (1, 2, 1)), lambda p: _between(p, (-1, 0, 0), (1, 2, 1))),
    "half_space": (cm.HalfSpace((0, 0, 0.5), (1, 1, 1)), lambda p: p.sum(axis=1) <= 0.5),
    "ball": (cm.Ball((0.5, 0, 0), 1), lambda p: ((p - (0.5, 0, 0)) ** 2).sum(axis=1) <= 1),
    "ellipsoid": (
        cm.Ellipsoid((0, 0, 0.5), (2, 1, 0.5)),
        lambda p: ((p - (0, 0, 0.5)) ** 2 / (4, 1, 0.25)).sum(axis=1) <= 1,
    ),
    "cylinder": (
        cm.Cylinder((0, 0, -1), (0, 0, 1.5), 0.8),
        lambda p: (radius(p) <= 0.8) & (np.abs(p[:, 2] - 0.25) <= 1.25),
    ),
    "cone": (
        cm.Cone((0, 0, 2), (0, 0, 0), 0, 1),
        lambda p: (radius(p) <= 1 - p[:, 2] / 2) & (p[:, 2] >= 0) & (p[:, 2] <= 2),
    ),
    "torus": (
        cm.Torus((0, 0, 0), (0, 0, -3), 1.2, 0.5),
        lambda p: (radius(p) - 1.2) ** 2 + p[:, 2] ** 2 <= 0.25,
    ),
    "tetrahedron": (
        cm.Tetrahedron((0, 0, 0), (0, 2, 0), (2, 0, 0), (0, 0, 2)),
        lambda p: (p >= 0).all(axis=1) & (p.sum(axis=1) <= 2),
    ),
    "polyhedron": (l_prism(), lambda p: _in_l(p) & (p[:, 2] >= 0) & (p[:, 2] <= 1)),
    "extrude": (
        cm.Extrude(cm.Polygon(L_SHAPE) - cm.Disk((0, 0), 0.5), 1.5),
        lambda p: _in_l(p) & (radius(p) > 0.5) & (p[:, 2] >= 0) & (p[:, 2] <= 1.5),
    ),
    "revolve": (
        cm.Revolve(cm.Box((0.5, -1), (1.5, 1)), 135),
        lambda p: (
            (np.abs(radius(p) - 1) <= 0.5)
            & (np.abs(p[:, 2]) <= 1)
            & (np.arctan2(p[:, 1], p[:, 0]) % (2 * np.pi) <= 0.75 * np.pi)
        ),
    ),
}


def _between(p: np.ndarray, low: tuple, high: tuple) -> np.ndarray:
    return ((p >= low) & (p <= high)).all(axis=1)


def _in_l(p: np.ndarray) -> np.ndarray:
    return _between(p[:, :2], (0, 0), (2, 2)) & ~(p[:, :2] > 1).all(axis=1)


def cloud(seed: int = 0, n: int = 4000) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2.2, 2.2, (n, 3))


@pytest.mark.parametrize("kind", LEAVES)
def test_membership_is_the_formula(kind: str) -> None:
    shape, formula = LEAVES[kind]
    points = cloud()
    inside = shape.contains(points)
    assert 20 < inside.sum() < len(points)
    np.testing.assert_array_equal(inside, formula(points))


@pytest.mark.parametrize("kind", LEAVES)
def test_membership_moves_with_the_solid(kind: str) -> None:
    shape, formula = LEAVES[kind]
    moved = shape.rotate(37, axis=(1, 2, 3)).scale((2, 1, 0.5)).translate((3, -1, 2))
    points = cloud(1)
    turn = cm.csg.matrices.rotation(37, (1, 2, 3))
    image = (points @ np.array(turn).T) * (2, 1, 0.5) + (3, -1, 2)
    assert (moved.contains(image) != formula(points)).mean() < 1e-3


@pytest.mark.parametrize("kind", sorted(set(LEAVES) - {"half_space"}))
def test_boxes_hold_the_solid_and_are_tight(kind: str) -> None:
    shape, _ = LEAVES[kind]
    for placed in (shape, shape.rotate(30, axis=(1, 1, 0)).translate((1, 2, 3))):
        low, high = placed.bounds()
        points = np.random.default_rng(2).uniform(low - 0.1, high + 0.1, (60_000, 3))
        found = points[placed.contains(points)]
        assert (found >= low - 1e-12).all()
        assert (found <= high + 1e-12).all()
        if kind not in ("extrude", "revolve"):
            assert (found.min(axis=0) - low).max() < 0.3
            assert (high - found.max(axis=0)).max() < 0.3


@pytest.mark.parametrize("kind", LEAVES)
def test_solids_are_values(kind: str) -> None:
    shape = (LEAVES[kind][0] | cm.Ball((9, 9, 9), 1)).named("part")
    names = {name: getattr(cm, name) for name in cm.__all__}
    for same in (
        pickle.loads(pickle.dumps(shape)),
        cm.Shape.from_dict(json.loads(json.dumps(shape.to_dict()))),
        eval(repr(shape), names),
    ):
        assert same == shape
        assert hash(same) == hash(shape)
        assert repr(same) == repr(shape)


coordinate = st.floats(-2, 2, allow_nan=False).map(lambda x: round(x, 3))
point = st.tuples(coordinate, coordinate, coordinate)
length = st.floats(0.2, 2).map(lambda x: round(x, 3))
leaf = st.one_of(
    st.builds(cm.Ball, point, length),
    st.builds(lambda p, a, b, c: cm.Box(p, np.add(p, (a, b, c))), point, length, length, length),
    st.builds(lambda p, h, r: cm.Cylinder(p, np.add(p, (0, h, h)), r), point, length, length),
    st.builds(lambda p, r, s: cm.Torus(p, (1, 0, 1), r + s, s), point, length, length),
)


@given(leaf, leaf, leaf)
def test_booleans_obey_the_algebra_of_sets(a: cm.Shape, b: cm.Shape, c: cm.Shape) -> None:
    p = cloud(3, 500)
    in_a, in_b, in_c = (s.contains(p) for s in (a, b, c))
    assert ((a | b).contains(p) == (in_a | in_b)).all()
    assert ((a & ~b).contains(p) == (a - b).contains(p)).all()
    assert ((a ^ b ^ c).contains(p) == (in_a ^ in_b ^ in_c)).all()
    assert ((a & (b | c)).contains(p) == ((a & b) | (a & c)).contains(p)).all()


def test_parts_have_names_without_the_users_doing() -> None:
    def names(shape: cm.Shape) -> list[str]:
        return [name for leaf in shape._program.leaves for name in leaf.names]

    assert names(cm.Box((0, 0, 0), (1, 1, 1), name="plate")) == [
        f"plate.{side}" for side in ("left", "right", "bottom", "top", "front", "back")
    ]
    assert names(cm.Cylinder((0, 0, 0), (0, 0, 1), 1)) == [
        "cylinder.side",
        "cylinder.base",
        "cylinder.top",
    ]
    gear = cm.Extrude(cm.Disk((0, 0), 1, name="rim") - cm.Box((-1, 0), (1, 2)), 2, name="gear")
    assert names(gear)[:3] == ["gear.start", "gear.end", "gear.side.rim"]
    assert names(cm.Revolve(cm.Disk((2, 0), 1), 90))[:2] == ["revolve.start", "revolve.end"]
    assert names(cm.Revolve(cm.Disk((2, 0), 1))) == ["revolve.side.disk"]


def test_the_axis_belongs_to_what_is_turned_about_it() -> None:
    """Also where the profile's edge along the axis closes an outline of arcs."""
    foot = [(0, 0), (1.15, 0), ("arc", (1.3, 0.2), (1.15, 0.4)), ("arc", (0.65, 3.1), (0, 3.75))]
    turned = cm.Revolve(cm.Outline([foot]))
    z = np.linspace(-0.5, 4.5, 101)
    on_axis = np.column_stack([0 * z, 0 * z, z])
    within = (z > 0) & (z < 3.75)
    away = (z != 0) & (abs(z - 3.75) > 1e-9)
    assert (turned.contains(on_axis) == within)[away].all()


OPEN_CUBE = SIDES[:5]
TURNED_CUBE = [SIDES[0][::-1], *SIDES[1:]]

REFUSED = [
    (lambda: cm.Ball((0, 0), 1), "center must have 3 coordinates"),
    (lambda: cm.Ball((0, 0, 0), 0), "radius must be positive"),
    (lambda: cm.Ball((0, 0, 0), np.inf), "radius must be finite"),
    (lambda: cm.Ellipsoid((0, 0, 0), (1, 1, -1)), "each semi-axis must be positive"),
    (lambda: cm.Cylinder((0, 0, 0), (0, 0, 0), 1), "base and top must be different"),
    (lambda: cm.Cone((0, 0, 0), (0, 0, 1), 0), "one must be positive"),
    (lambda: cm.Cone((0, 0, 0), (0, 0, 1), 1, -1), "must not be negative"),
    (lambda: cm.Torus((0, 0, 0), (0, 0, 1), 1, 1), "minor_radius must be smaller"),
    (lambda: cm.Torus((0, 0, 0), (0, 0, 0), 2, 1), "axis must not be zero"),
    (lambda: cm.Tetrahedron((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)), "not lie in one plane"),
    (lambda: cm.Polyhedron(CUBE, OPEN_CUBE), "each edge must be shared by two faces"),
    (lambda: cm.Polyhedron(CUBE, TURNED_CUBE), "opposite directions"),
    (lambda: cm.Polyhedron(CUBE, [*SIDES[:5], (1, 5, 7, 9)]), "names point 9; there are 8"),
    (lambda: cm.Polyhedron(CUBE, [*SIDES[:5], (1, 5, 5)]), "three different points"),
    (lambda: cm.Polyhedron([*CUBE[:7], (1, 1, 1.5)], SIDES), "face 5 must be flat"),
    (lambda: cm.Polyhedron(CUBE, 3), "faces must be sequences"),
    (lambda: cm.Extrude(cm.Ball((0, 0, 0), 1), 1), "must be in the plane"),
    (lambda: cm.Extrude(3, 1), "must be a shape in the plane; got 3"),
    (lambda: cm.Extrude(cm.Disk((0, 0), 1), -1), "height must be positive"),
    (lambda: cm.Revolve(cm.Disk((0, 0), 1), 400), "at most 360 degrees; got 400"),
    (lambda: cm.Box((0, 0, 0), (1, 1, 0)), "lo must be below hi"),
    (lambda: cm.HalfSpace((0, 0, 0), (0, 0)), "normal must have 3 coordinates"),
    (lambda: cm.Ball((0, 0, 0), 1) | cm.Disk((0, 0), 1), "same dimension"),
    (
        lambda: cm.generate(cm.Ball((0, 0, 0), 1), cm.Quadtree()),
        "Octree meshes any solid, Sweep extrusions and revolutions",
    ),
]


@pytest.mark.parametrize(("made", "message"), REFUSED)
def test_refused_with_rule_value_and_place(made, message: str) -> None:
    with pytest.raises(cm.InputError, match=message):
        made()


def test_clockwise_polyhedra_are_the_same_body() -> None:
    ahead = cm.Polyhedron(CUBE, SIDES)
    behind = cm.Polyhedron(CUBE, [side[::-1] for side in SIDES])
    p = cloud(4)
    assert (ahead.contains(p) == behind.contains(p)).all()
    assert cm.evaluate(behind).volumes()[0] == pytest.approx(1.0, abs=1e-14)


def test_solids_from_a_domain_file(tmp_path) -> None:
    file = tmp_path / "part.yaml"
    file.write_text(
        """
csgmesh: 1
shapes:
  gear: {difference: [{disk: {center: [0, 0], radius: 2}}, {disk: {center: [0, 0], radius: 1}}]}
  wheel: {extrude: {shape: gear, height: 0.5}, translate: [0, 0, 1]}
  knob: {revolve: {shape: {box: {lo: [0, 0], hi: [1, 3]}}, angle: 180}}
domain: {union: [wheel, knob, {ball: {center: [0, 0, 5], radius: 1}}]}
"""
    )
    shape = cm.load(file).shape
    assert shape.contains([(1.5, 0, 1.2), (0, 0.5, 2), (0, -0.5, 2), (0, 0, 5)]).tolist() == [
        True,
        True,
        False,
        True,
    ]
    assert "wheel.side.gear.disk" in [n for leaf in shape._program.leaves for n in leaf.names]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("extrude: {shape: nothing, height: 1}", r"part.yaml:2:\d+: no shape is called 'nothing'"),
        ("extrude: {shape: {ball: {center: [0, 0, 0], radius: 1}}, height: 1}", "in the plane"),
        ("extrude: {shape: {disk: {center: [0, 0], radius: 1}}, hight: 1}", "unknown key 'hight'"),
        ("ball: {center: [0, 0], radius: 1}", "3 coordinates"),
    ],
)
def test_wrong_solids_in_a_domain_file(tmp_path, line: str, message: str) -> None:
    file = tmp_path / "part.yaml"
    file.write_text(f"csgmesh: 1\ndomain: {{{line}}}\n")
    with pytest.raises(cm.DomainFileError, match=message):
        cm.load(file)

"""Shapes are values: hash, equality, pickle, repr, dictionaries, at any depth and width."""

from __future__ import annotations

import copy
import json
import pickle

import numpy as np
import pytest
from hypothesis import given
from random_trees import SAMPLE, trees

import csgmesh as cm


@given(trees)
def test_round_trips(a: cm.Shape) -> None:
    read = [
        pickle.loads(pickle.dumps(a)),
        cm.Shape.from_dict(json.loads(json.dumps(a.to_dict()))),
        eval(repr(a), vars(cm) | {name: getattr(cm, name) for name in cm.__all__}),
        copy.copy(a),
        copy.deepcopy(a),
    ]
    for b in read:
        assert b == a
        assert hash(b) == hash(a)
        assert repr(b) == repr(a)


@given(trees, trees)
def test_unequal_expressions_differ(a: cm.Shape, b: cm.Shape) -> None:
    assert (a == b) == (repr(a) == repr(b))
    assert (a | b) != (a & b)
    assert a.translate((1, 0)) != a


def test_repr_reads_like_the_input() -> None:
    shape = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
    assert repr(shape) == "Box((0, 0), (4, 2), name='plate') - Disk((2, 1), 0.5, name='hole')"
    assert repr((~shape).named("x").scale((2, 3))) == (
        "(~(Box((0, 0), (4, 2), name='plate') - Disk((2, 1), 0.5, name='hole')).named('x'))"
        ".scale((2, 3))"
    )
    assert str(shape) == "difference of 2"
    assert str(cm.Disk((0, 0), 1, name="hole").translate((1, 1))) == "disk 'hole'"


@pytest.mark.parametrize("wide", [False, True])
def test_repr_evaluates_back_at_a_hundred_levels(wide: bool) -> None:
    s: cm.Shape = cm.Disk((0, 0), 1)
    others = [cm.Box((k, 0), (k + 1, 1)) for k in range(9 if wide else 1)]
    while s.depth < 100:
        s = cm.union(s, *others) if s.depth % 2 else cm.intersection(s, *others)
    assert s.depth == 100
    assert eval(repr(s), {name: getattr(cm, name) for name in cm.__all__}) == s


def test_repr_of_large_trees_is_short() -> None:
    wide = cm.union(cm.Disk((k, 0), 1) for k in range(10_000))
    assert repr(wide) == "<union of 10,000, 10,000 leaves, 2 levels>"
    ring = np.exp(1j * np.linspace(0, 6, 5000))
    assert repr(cm.Polygon(np.column_stack([ring.real, ring.imag]))) == "Polygon(<5,000 points>)"


def test_ten_thousand_terms() -> None:
    s: cm.Shape = cm.Disk((0, 0), 1)
    earlier = []
    for k in range(1, 10_000):
        s = s | cm.Disk((k, 0), 1)
        earlier.append(s)
    assert s.depth == 2
    assert len(s.children) == 10_000
    assert len(earlier[4].children) == 6
    assert s == cm.union(cm.Disk((k, 0), 1) for k in range(10_000))
    assert pickle.loads(pickle.dumps(s)) == s
    assert s.contains([(5000.5, 0.5), (-2, 0)]).tolist() == [True, False]


def test_ten_thousand_levels() -> None:
    s: cm.Shape = cm.Disk((0, 0), 0.4)
    for k in range(1, 5_000):
        s = (s | cm.Disk((k, 0), 0.4)) - cm.Disk((k, 0), 0.2, name="x")
    assert s.depth == 9_999
    assert pickle.loads(pickle.dumps(s)) == s
    assert cm.Shape.from_dict(s.to_dict()) == s
    assert repr(s) == "<difference of 2, 9,999 leaves, 9,999 levels>"
    assert s.contains([(7, 0.3), (7, 0.1), (7.5, 0)]).tolist() == [True, False, False]
    assert s.bounds()[1].tolist() == [4999.4, 0.4]
    assert copy.deepcopy(s) is s
    del s  # a hundred thousand nested references must not overflow the stack


def test_doubling_ends_in_an_error_before_memory_does() -> None:
    def doubled(step):
        s = cm.Disk((0, 0), 1)
        for _ in range(40):
            s = step(s)

    with pytest.raises(cm.ShapeError, match="at most 2,000,000 leaves"):
        doubled(lambda s: s | s)
    with pytest.raises(cm.ShapeError, match="at most 2,000,000 leaves"):
        doubled(lambda s: s ^ s.translate((1, 0)))
    with pytest.raises(cm.ShapeError, match="at most 2,000,000 leaves"):
        doubled(lambda s: (s - s).named("again"))


def test_shapes_cannot_be_changed() -> None:
    disk = cm.Disk((0, 0), 1)
    with pytest.raises(AttributeError):
        disk.radius = 2
    with pytest.raises(AttributeError):
        (disk | disk).operation = "difference"
    polygon = cm.Polygon(corners := np.array([(0.0, 0), (1, 0), (0, 1)]))
    corners[0] = 7
    assert polygon.points[0].tolist() == [0, 0]
    with pytest.raises(ValueError, match="read-only"):
        polygon.points[0] = 7


def test_minus_zero_is_zero() -> None:
    assert cm.Disk((-0.0, 0.0), 1) == cm.Disk((0.0, -0.0), 1)
    a, b = [(0.0, 0), (1, 0), (0, 1)], [(-0.0, 0), (1, -0.0), (0, 1)]
    assert hash(cm.Polygon(a)) == hash(cm.Polygon(b))


@pytest.mark.parametrize(
    "data",
    [
        {},
        {"nodes": []},
        {"nodes": [{"blob": {}}]},
        {"nodes": [{"disk": {"center": [0, 0], "size": 1}}]},
        {"nodes": [{"disk": 3}]},
        {"nodes": [{"union": [0, 1]}]},
        {"nodes": [{"union": 0}]},
        {"nodes": [{"named": 1}]},
        {"nodes": [{"disk": {"center": [0, 0], "radius": 1}}, {"complement": 1}]},
        {"nodes": [{"disk": {"center": [0, 0], "radius": 1}}, {"complement": True}]},
    ],
)
def test_broken_dictionaries_are_refused(data: dict) -> None:
    with pytest.raises(cm.ShapeError, match="from_dict"):
        cm.Shape.from_dict(data)


def test_a_compiled_shape_keeps_its_value() -> None:
    disk = cm.Disk((0, 0), 1)
    disk.contains(SAMPLE)
    assert pickle.loads(pickle.dumps(disk)) == disk
    assert hash(disk.named("a")) != hash(disk)


def test_numbers_beyond_all_floats_are_refused_by_name():
    with pytest.raises(cm.ShapeError, match="radius must be finite"):
        cm.Disk((0, 0), 10**400)


@pytest.mark.parametrize("points", ["x", [["a", "b"]], [[1j, 0]]])
def test_points_asked_about_must_be_numbers(points):
    with pytest.raises(cm.ShapeError, match="contains: points must be an"):
        cm.Disk((0, 0), 1).contains(points)


def test_no_points_asked_about_are_no_answers():
    assert cm.Disk((0, 0), 1).contains([]).shape == (0,)

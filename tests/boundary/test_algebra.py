"""The algebra of sets, on random trees."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import csgmesh as cm

FRAME = cm.Box((-5, -5), (5, 5), name="frame")

# Coordinates on a coarse grid make coincidences, tangencies and shared vertices likely.
coordinate = st.integers(-6, 6).map(lambda k: k / 2)
point = st.tuples(coordinate, coordinate)
length = st.integers(1, 6).map(lambda k: k / 2)


@st.composite
def leaves(draw):
    kind = draw(st.sampled_from(["box", "disk", "ellipse", "triangle", "half_space"]))
    x, y = draw(point)
    if kind == "box":
        return cm.Box((x, y), (x + draw(length), y + draw(length)))
    if kind == "disk":
        return cm.Disk((x, y), draw(length))
    if kind == "ellipse":
        return cm.Ellipse((x, y), (draw(length), draw(length)), draw(st.integers(0, 12)) * 15)
    if kind == "triangle":
        return cm.Triangle((x, y), (x + draw(length), y), (x + draw(coordinate), y + draw(length)))
    return cm.HalfSpace((x, y), draw(st.sampled_from([(1, 0), (0, -1), (1, 1), (-3, 4)])))


def combine(children):
    pair = st.tuples(children, children)
    return st.one_of(
        pair.map(lambda p: p[0] | p[1]),
        pair.map(lambda p: p[0] & p[1]),
        pair.map(lambda p: p[0] - p[1]),
        pair.map(lambda p: p[0] ^ p[1]),
        children.map(lambda s: ~s),
    )


shapes = st.recursive(leaves(), combine, max_leaves=6)


def area(shape) -> float:
    try:
        return float(cm.evaluate(shape & FRAME).areas().sum())
    except cm.EmptyDomainError:
        return 0.0


def close(a: float, b: float) -> bool:
    return a == pytest.approx(b, abs=1e-8)


@given(shapes, shapes)
def test_de_morgan(a, b):
    assert close(area(~(a | b)), area(~a & ~b))
    assert close(area(~(a & b)), area(~a | ~b))


@given(shapes, shapes)
def test_difference_is_intersection_with_the_complement(a, b):
    assert close(area(a - b), area(a & ~b))
    assert close(area(a ^ b), area((a - b) | (b - a)))


@given(shapes, shapes)
def test_areas_add_up(a, b):
    assert close(area(a) + area(b), area(a | b) + area(a & b))


@given(shapes)
def test_complement_twice_and_complement_of_the_frame(a):
    assert close(area(~~a), area(a))
    assert close(area(~a), 100.0 - area(a))


@given(shapes, st.integers(1, 359), point)
@settings(max_examples=25)
def test_rigid_motions_keep_the_area(a, degrees, v):
    moved = (a & FRAME).rotate(degrees).translate(v)
    try:
        got = float(cm.evaluate(moved).areas().sum())
    except cm.EmptyDomainError:
        got = 0.0
    assert close(got, area(a))


@given(shapes)
@settings(max_examples=25)
def test_the_boundary_separates_what_the_tree_says(a):
    shape = a & FRAME
    try:
        pslg = cm.evaluate(shape)
    except cm.EmptyDomainError:
        return
    p, q = pslg.points[pslg.segments[:, 0]], pslg.points[pslg.segments[:, 1]]
    along = q - p
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    t = pslg.segment_interval.mean(axis=1)
    on = pslg.curves.points(pslg.segment_curve, t)
    # Thin slivers of the coarse grid are wider than this step.
    step = 1e-6 * normal / np.hypot(*along.T)[:, None]
    assert (shape.contains(on + step)).all()
    assert not (shape.contains(on - step)).any()


@given(shapes)
@settings(max_examples=25)
def test_appending_a_disjoint_leaf_changes_no_name(a):
    shape = a & FRAME
    try:
        before = cm.evaluate(shape)
    except cm.EmptyDomainError:
        return
    after = cm.evaluate(shape | cm.Disk((20, 20), 1))
    old = {tuple(sorted(n)) for n in before.boundary_names}
    new = {tuple(sorted(n)) for n in after.boundary_names}
    assert old < new or old == new
    assert len(new) == len(old) + 1


def test_areas_of_two_regions_sum_to_their_union():
    a, b = cm.Box((0, 0), (2, 2)), cm.Disk((2, 1), 0.75)
    pslg = cm.evaluate(cm.Regions({"a": a, "b": b}))
    assert pslg.areas()[1] == pytest.approx(np.pi * 0.75**2, rel=1e-13)
    assert pslg.areas().sum() == pytest.approx(area(a | b), rel=1e-13)

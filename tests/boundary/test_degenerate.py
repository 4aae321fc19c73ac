"""Degenerate input is the normal case: right areas and names, in any place and at any scale."""

from __future__ import annotations

import numpy as np
import pytest
from degenerate import CASES

import csgmesh as cm


def placements():
    yield "as written", lambda s: s, 1.0
    yield "turned", lambda s: s.rotate(17), 1.0
    yield "large", lambda s: s.rotate(17).scale(1e6), 1e6
    yield "small", lambda s: s.rotate(17).scale(1e-6), 1e-6
    yield "mirrored", lambda s: s.mirror((0, 0), (1, 2)), 1.0


@pytest.mark.parametrize("label", CASES)
def test_area_and_names_survive_every_placement(label):
    shape, area, names = CASES[label]
    for _, place, scale in placements():
        pslg = cm.evaluate(place(shape))
        # Where a sliver's width is a difference of coordinates, their rounding limits its area.
        rounding = 1e-14 * scale**2
        assert pslg.areas().sum() == pytest.approx(area * scale**2, rel=1e-9, abs=rounding)
        assert names <= set(pslg.names)


@pytest.mark.parametrize("label", CASES)
def test_chords_bound_the_same_area_within_their_deviation(label):
    shape, _, _ = CASES[label]
    pslg = cm.evaluate(shape)
    chord = np.hypot(*(pslg.points[pslg.segments[:, 1]] - pslg.points[pslg.segments[:, 0]]).T)
    # A parabola over a chord of length l and height d has area 2/3 l d.
    bound = 2 / 3 * chord.sum() * pslg.deviation * 1.01 + 1e-14
    assert abs(pslg.chord_areas().sum() - pslg.areas().sum()) <= bound


@pytest.mark.parametrize("label", [k for k in CASES if "1e-9" not in k and "1e-6" not in k])
def test_an_offset_of_1e9_moves_nothing_but_rounding(label):
    shape, area, names = CASES[label]
    pslg = cm.evaluate(shape.translate((1e9, -1e9)))
    assert pslg.areas().sum() == pytest.approx(area, abs=1e-5)
    assert names <= set(pslg.names)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_extreme_scales(scale):
    for shape, area, _ in CASES.values():
        got = cm.evaluate(shape.scale(scale)).areas().sum() / scale**2
        assert got == pytest.approx(area, rel=1e-9, abs=1e-14)


@pytest.mark.parametrize("label", CASES)
def test_segments_end_on_their_exact_curves(label):
    pslg = cm.evaluate(CASES[label][0])
    allowed = 1e-12 * pslg.diagonal + pslg.report.largest_displacement
    for end in (0, 1):
        on = pslg.curves.points(pslg.segment_curve, pslg.segment_interval[:, end])
        off = np.hypot(*(on - pslg.points[pslg.segments[:, end]]).T)
        assert off.max() <= allowed


def test_features_below_the_snap_distance_merge_and_the_report_names_the_leaves():
    pslg = cm.evaluate(cm.Disk((0, 0), 1, name="a") | cm.Disk((2 + 1e-11, 0), 1, name="b"))
    (merge,) = pslg.report.merges
    assert merge.leaves == ("disk 'a'", "disk 'b'")
    assert merge.place == pytest.approx((1, 0), abs=1e-9)
    assert pslg.report.largest_displacement == pytest.approx(1e-11, rel=1e-3)


def test_differently_named_curves_1e_9_apart_keep_their_names():
    inner = cm.Box((0, 0), (1, 1), name="inner")
    outer = cm.Box((0, 0), (1 + 1e-9, 1), name="outer")
    pslg = cm.evaluate(cm.Regions({"thin": outer, "bulk": inner}))
    at = pslg.points[pslg.segments].mean(axis=1)[:, 0]
    upright = np.abs(pslg.points[pslg.segments][:, 0, 0] - pslg.points[pslg.segments][:, 1, 0]) == 0
    names = {pslg.boundary_names[m] for m in pslg.segment_marker[upright & (at > 1 + 5e-10)]}
    assert names == {("outer.right",)}
    names = {pslg.boundary_names[m] for m in pslg.segment_marker[upright & (abs(at - 1) < 5e-10)]}
    assert names == {("inner.right",)}


def test_vertex_pairs_of_real_outlines_are_cleaned_up():
    rng = np.random.default_rng(0)
    corners = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)], float)
    for gap in (4e-16, 1e-15, 1e-14, 1e-13):
        doubled = np.repeat(corners, 2, axis=0)
        doubled[1::2] += gap * rng.choice([-1.0, 1.0], size=(len(corners), 2))
        pslg = cm.evaluate(cm.Polygon(doubled))
        assert pslg.n_segments == 6
        assert pslg.areas()[0] == pytest.approx(4.0, abs=1e-11)
        assert pslg.report.largest_displacement <= 2 * gap


@pytest.mark.parametrize("label", [k for k in CASES if "touching" in k or "tangent" in k])
@pytest.mark.parametrize("degrees", [0, 17, 123])
def test_a_contact_is_one_vertex_however_it_is_turned(label, degrees):
    pslg = cm.evaluate(CASES[label][0].rotate(degrees))
    ends = pslg.points[pslg.segments]
    assert np.hypot(*(ends[:, 1] - ends[:, 0]).T).min() > 1e-3


@pytest.mark.parametrize("gap", [2e-10, -2e-10])
@pytest.mark.parametrize("degrees", [0.0, 23.0, 141.0])
def test_a_touching_over_less_than_the_snap_distance_is_reported_and_passes_the_check(gap, degrees):
    disks = cm.Disk((-1, 0), 1, name="a") | cm.Disk((0.7 + gap, 0), 0.7, name="b")
    shape = cm.Box((-3, -3), (3, 3)) - disks.rotate(degrees)
    pslg = cm.evaluate(shape)
    (merge,) = pslg.report.merges
    assert merge.distance == pytest.approx(abs(gap), rel=1e-3)
    assert merge.leaves == ("disk 'a'", "disk 'b'")
    assert cm.check(cm.generate(pslg, cm.ConstrainedDelaunay()), shape).ok

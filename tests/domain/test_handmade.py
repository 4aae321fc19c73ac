"""A Pslg made of arrays: its faces, names and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
LOOP = [(0, 1), (1, 2), (2, 3), (3, 0)]


def loops(*rings):
    """Points and segments of closed rings."""
    points = np.concatenate([np.asarray(ring, float) for ring in rings])
    segments, k = [], 0
    for ring in rings:
        number = np.arange(len(ring))
        segments.append(np.column_stack([k + number, k + (number + 1) % len(ring)]))
        k += len(ring)
    return points, np.concatenate(segments)


def box(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def perforated(n):
    holes = [box(i + 0.3, j + 0.3, i + 0.7, j + 0.7) for i in range(n) for j in range(n)]
    return loops(box(0, 0, n, n), *holes)


def test_two_thousand_holes_are_found_without_being_shown():
    domain = cm.Pslg(*perforated(45))
    assert domain.areas()[0] == pytest.approx(45**2 * (1 - 0.16), rel=1e-12)


def test_two_thousand_hole_points_and_region_points_are_placed():
    points, segments = perforated(45)
    inside = np.stack(np.meshgrid(np.arange(45), np.arange(45)), axis=-1).reshape(-1, 2) + 0.5
    by_holes = cm.Pslg(points, segments, holes=inside)
    assert by_holes.areas()[0] == pytest.approx(45**2 * (1 - 0.16), rel=1e-12)
    regions = {f"r{k}": p for k, p in enumerate(inside)}
    domain = cm.Pslg(points, segments, regions={"plate": (0.1, 0.1), **regions})
    assert domain.areas()[1:] == pytest.approx(np.full(45**2, 0.16), rel=1e-9)
    assert len(repr(domain)) < 200


def test_a_tall_stack_of_loops_needs_no_memory_in_its_square():
    domain = cm.Pslg(*loops(*[box(0, 2 * k, 1, 2 * k + 1) for k in range(20_000)]))
    assert domain.areas()[0] == pytest.approx(20_000, rel=1e-12)


@pytest.mark.parametrize("scale, shift", [(1.0, 0.0), (1e9, 0.0), (1e-9, 0.0), (1.0, 1e9)])
@pytest.mark.parametrize("turn", [1, -1])
def test_nested_loops_alternate_whatever_way_they_turn(scale, shift, turn):
    rings = [box(-r, -r, r, r)[:: turn if r % 2 else 1] for r in range(1, 8)]
    points, segments = loops(*rings)
    domain = cm.Pslg(points * scale + shift, segments)
    assert domain.areas()[0] == pytest.approx(4 * (49 - 36 + 25 - 16 + 9 - 4 + 1) * scale**2)
    probes = np.array([(0.5, 0.2), (1.5, 0.2), (2.5, -0.2), (6.5, 6.5), (9, 0)]) * scale + shift
    assert domain.oracle.region(probes).tolist() == [0, -1, 0, 0, -1]


def test_a_loop_below_a_vertex_where_many_segments_meet_lies_in_the_right_one():
    # Seen from the apex the heights of a fan's segments agree but for rounding.
    fan = [(np.cos(t), np.sin(t)) for t in np.linspace(-3.0, -0.1, 40)]
    points = np.array([(0.0, 0.0), *fan]) * 1e-3
    segments = [(k, k + 1) for k in range(1, 40)] + [(0, k) for k in range(1, 41)]
    seeds = {f"s{k}": (points[k] + points[k + 1]) * 1e-9 for k in range(1, 40)}
    domain = cm.Pslg(points, segments, regions=seeds)
    step = 2.9 / 39
    assert domain.areas() == pytest.approx(np.full(39, 0.5 * np.sin(step) * 1e-6), rel=1e-9)


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"holes": "x"}, "holes must be points"),
        ({"holes": [(5, 5)]}, r"hole point \(5.0, 5.0\) lies outside"),
        ({"regions": {}}, "regions must be a mapping"),
        ({"regions": [(0.5, 0.5)]}, "regions must be a mapping"),
        ({"regions": {"a": []}}, r"regions\['a'\] needs a point"),
        ({"regions": {"a": (0.5, 0.5), "b": (0.6, 0.5)}}, "'a' and 'b' claim the same face"),
        ({"regions": {1: (0.5, 0.5)}}, "a name must be a string; got 1"),
        ({"regions": {"a*": (0.5, 0.5)}}, "must not contain"),
        ({"names": ["a"]}, "names must be a mapping"),
        ({"names": {"a": "x"}}, r"names\['a'\] must hold segment numbers, got 'x'"),
        ({"names": {"a": [0.5]}}, r"names\['a'\] must hold segment numbers"),
        ({"names": {"a": [4]}}, r"names\['a'\] must hold segment numbers below 4, got 4"),
        ({"names": {"a..b": [0]}}, "between its dots"),
    ],
)
def test_what_a_pslg_refuses(arguments, message):
    with pytest.raises(cm.InputError, match=message):
        cm.Pslg(SQUARE, LOOP, **arguments)


def test_one_segment_number_is_a_name_s_segment():
    assert cm.Pslg(SQUARE, LOOP, names={"floor": 0}).boundary_names[0] == ("floor",)


@pytest.mark.parametrize(
    "scale, message", [(1e101, "at most 1e\\+100"), (1e-101, "wider than 1e-100")]
)
def test_coordinates_beyond_the_range_of_predicates_are_refused(scale, message):
    with pytest.raises(cm.InputError, match=message):
        cm.Pslg(np.array(SQUARE) * scale, LOOP)


def test_points_on_one_line_enclose_nothing():
    with pytest.raises(cm.InputError, match=r"in x and y, got \(0.0, 0.0\) to \(2.0, 0.0\)"):
        cm.Pslg([(0, 0), (1, 0), (2, 0)], [(0, 1), (1, 2), (2, 0)])

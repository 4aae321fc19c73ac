"""Booleans and maps obey their algebra, judged by membership."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_trees import SAMPLE, points, trees

import csgmesh as cm


@given(trees, trees)
def test_de_morgan(a: cm.Shape, b: cm.Shape) -> None:
    assert np.array_equal((~(a | b)).contains(SAMPLE), (~a & ~b).contains(SAMPLE))
    assert np.array_equal((~(a & b)).contains(SAMPLE), (~a | ~b).contains(SAMPLE))


@given(trees, trees)
def test_difference_is_intersection_with_complement(a: cm.Shape, b: cm.Shape) -> None:
    assert np.array_equal((a - b).contains(SAMPLE), (a & ~b).contains(SAMPLE))


@given(trees, trees, trees)
def test_booleans_combine_the_memberships(a: cm.Shape, b: cm.Shape, c: cm.Shape) -> None:
    x, y, z = (s.contains(SAMPLE) for s in (a, b, c))
    assert np.array_equal((a | b | c).contains(SAMPLE), x | y | z)
    assert np.array_equal((a & b & c).contains(SAMPLE), x & y & z)
    assert np.array_equal((a - b - c).contains(SAMPLE), x & ~y & ~z)
    assert np.array_equal((a ^ b ^ c).contains(SAMPLE), x ^ y ^ z)
    assert np.array_equal(((a | b) - (b ^ c)).contains(SAMPLE), (x | y) & ~(y ^ z))


@given(trees)
def test_double_complement_is_the_shape(a: cm.Shape) -> None:
    assert ~~a == a
    assert np.array_equal((~a).contains(SAMPLE), ~a.contains(SAMPLE))


@given(trees, points, st.integers(-3, 3), st.sampled_from([(2.0, 0.5), (-1.0, 3.0)]))
def test_a_mapped_shape_contains_the_mapped_points(
    a: cm.Shape, v: tuple, quarters: int, factors: tuple
) -> None:
    inside = a.contains(SAMPLE)
    turn = np.linalg.matrix_power(np.array([(0, -1), (1, 0)]), quarters % 4)
    moved = a.translate(v).rotate(90 * quarters).scale(factors)
    assert np.array_equal(moved.contains((SAMPLE + v) @ turn.T * factors), inside)


@given(trees)
def test_bounds_contain_the_shape(a: cm.Shape) -> None:
    low, high = a.bounds()
    inside = SAMPLE[a.contains(SAMPLE)]
    assert (inside >= low - 1e-9).all()
    assert (inside <= high + 1e-9).all()


@given(trees, trees, trees)
def test_booleans_flatten(a: cm.Shape, b: cm.Shape, c: cm.Shape) -> None:
    assert (a | b) | c == a | (b | c) == cm.union([a, b, c])
    assert (a & b) & c == a & (b & c) == cm.intersection(a, b, c)
    assert (a ^ b) ^ c == a ^ (b ^ c) == cm.symmetric_difference([a, b, c])
    assert (a - b) - c == cm.difference(a, b, c)


def test_a_shared_prefix_grows_two_ways_without_mixing() -> None:
    a, b, c, d = (cm.Disk((k, 0), 0.1) for k in range(4))
    ab = a | b
    abc, abd, dab, cab = ab | c, ab | d, d | ab, c | ab
    assert [len(s.children) for s in (ab, abc, abd, dab, cab)] == [2, 3, 3, 3, 3]
    assert list(abc.children) == [a, b, c]
    assert list(abd.children) == [a, b, d]
    assert list(dab.children) == [d, a, b]
    assert list(cab.children) == [c, a, b]
    assert list((dab | abc).children) == [d, a, b, a, b, c]
    assert list(((c | ab) | (d | ab | a)).children) == [c, a, b, d, a, b, a]


def test_quarter_turns_are_exact() -> None:
    box = cm.Box((1, 2), (3, 5))
    for degrees, low, high in [
        (90, (-5, 1), (-2, 3)),
        (180, (-3, -5), (-1, -2)),
        (-90, (2, -3), (5, -1)),
        (450, (-5, 1), (-2, 3)),
    ]:
        got = box.rotate(degrees).bounds()
        assert got[0].tolist() == list(low)
        assert got[1].tolist() == list(high)
    assert box.rotate(90).rotate(270) == box
    assert box.mirror((1, 0), (1, 0)).mirror((1, 0), (1, 0)) == box
    assert box.translate((1, 2)).translate((-1, -2)) == box


def test_maps_turn_scale_and_mirror_about_their_center() -> None:
    disk = cm.Disk((3, 1), 1)
    assert np.allclose(disk.rotate(90, center=(1, 1)).bounds(), [(0, 2), (2, 4)])
    assert np.allclose(disk.scale(2, center=(3, 1)).bounds(), [(1, -1), (5, 3)])
    assert np.allclose(disk.mirror((0, 0), (1, -1)).bounds(), [(0, 2), (2, 4)])
    assert np.allclose(disk.transform([(1, 1), (0, 1)], (0, 1)).bounds()[0][1], 1)


@pytest.mark.parametrize("mirrored", [False, True])
def test_placed_curves_keep_the_interior_on_their_left(mirrored: bool) -> None:
    from csgmesh.csg.program import compile_shape

    frame = cm.Polygon([(0, 0), (4, 0), (4, 3)], holes=[[(2, 0.5), (3, 0.5), (3, 1)]])
    triangle = cm.Triangle((0, 0), (0, 1), (1, 0))
    for leaf in (cm.Box((0, 0), (2, 1)), cm.Disk((1, 1), 2), frame, triangle):
        turned = leaf.rotate(30).scale((2, 3))
        shape = turned.mirror((1, 1), (2, 1)) if mirrored else turned
        (placed,) = compile_shape(shape).leaves
        curves, part = placed.curves()
        i = np.arange(len(curves))
        area = curves.area_terms(i, curves.interval[:, 0], curves.interval[:, 1]).sum()
        assert area > 0
        assert len(part) == len(curves)
        ends, starts = curves.ends(), curves.starts()
        gaps = np.abs(ends[:-1] - starts[1:]).max(axis=1)
        assert (gaps > 1e-12).sum() == (1 if leaf is frame else 0)

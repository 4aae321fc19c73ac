"""Bézier outlines: loops, cusps and curves that only look curved."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm


def test_a_cubic_that_crosses_itself_encloses_its_loop():
    loop = cm.Outline([[(0, 0), ("cubic", (3, 2), (-2, 2), (1, 0))]])
    pslg = cm.evaluate(loop)
    points = np.random.default_rng(0).random((200_000, 2)) * [3, 2] - [1, 0.25]
    share = loop.contains(points).mean() * 6.0
    assert pslg.areas()[0] == pytest.approx(share, rel=0.01)
    corners = np.bincount(pslg.segments.ravel())
    assert (corners == 4).sum() == 1


def test_even_odd_fill_leaves_the_overlap_open():
    contours = [[(0, 0), (2, 0), (2, 2), (0, 2)], [(1, 1), (3, 1), (3, 3), (1, 3)]]
    assert cm.evaluate(cm.Outline(contours)).areas()[0] == pytest.approx(7)
    assert cm.evaluate(cm.Outline(contours, fill="evenodd")).areas()[0] == pytest.approx(6)


def test_a_curve_with_its_control_point_on_its_start_is_a_line():
    outline = cm.Outline([[(0, 0), ("quadratic", (0, 0), (2, 0)), (2, 1), (0, 1)]])
    pslg = cm.evaluate(outline)
    assert pslg.n_segments == 4
    assert pslg.areas()[0] == pytest.approx(2)


def test_a_curve_that_returns_along_its_tangent_ends_in_a_cusp():
    outline = cm.Outline(
        [[(2, 2), ("cubic", (3.5, 1.5), (2, 2.5), (3, 2.5)), ("line", (0.5, 2.5))]]
    )
    pslg = cm.evaluate(outline)
    x, y = pslg.points[pslg.segments].transpose(2, 0, 1)
    chords = 0.5 * (x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]).sum()
    assert pslg.areas()[0] == pytest.approx(chords, abs=0.01)


def test_parabolas_touching_at_their_vertices():
    up = cm.Outline([[(-1, 1), ("quadratic", (0, -1), (1, 1))]])
    down = cm.Outline([[(-1, -1), ("quadratic", (0, 1), (1, -1))]])
    pslg = cm.evaluate(up | down)
    assert pslg.areas()[0] == pytest.approx(8 / 3, rel=1e-12)
    assert (np.hypot(*pslg.points.T) < 1e-9).sum() == 1

"""Nearest points on curves."""

from __future__ import annotations

import numpy as np

from csgmesh.domain import Curves


def test_projection_settles_at_the_tip_of_a_hairpin() -> None:
    # A quadratic that turns by nearly 180 degrees within a width of 1e-5.
    corners = [
        [[-0.24999999, -2.14644661]],
        [[0.81066725, -3.20709971]],
        [[-3.96231059, 1.56586399]],
    ]
    curves = Curves.quadratics(*np.array(corners))
    # Between the parameters where it turns back in x and in y lies the tip.
    for lo, hi in ((0.12014537, 0.18181741), (0.18181895, 0.24349142)):
        t = np.linspace(max(lo, 0.18), min(hi, 0.1835), 400)
        on = np.zeros(len(t), int)
        points = curves.points(on, t)
        settled = curves.project(on, points, np.full(len(t), lo), np.full(len(t), hi))
        assert np.hypot(*(curves.points(on, settled) - points).T).max() <= 1e-14

"""Sharp corners are measured between exact tangents, inside the domain only."""

from __future__ import annotations

import numpy as np
import pytest
from plane_domains import disks, loops, star, wedge

from csgmesh.domain import Pslg
from csgmesh.domain.input_angles import input_angles


@pytest.mark.parametrize("degrees", [59.9, 30, 1, 1e-6])
def test_a_wedge_has_its_angle_and_its_common_length(degrees: float) -> None:
    points, angles, radii = input_angles(wedge(degrees, ratio=1.3))
    assert np.array_equal(points[0], [0, 0])
    assert angles[0] == pytest.approx(degrees, rel=1e-9)
    assert radii[0] == pytest.approx(1.0)


def test_sixty_degrees_and_outside_angles_do_not_count() -> None:
    assert len(input_angles(wedge(60))[0]) == 0
    assert len(input_angles(loops([(0, 0), (1, 0), (1, 1), (0, 1)]))[0]) == 0
    # A notch of 10 degrees cut out of a square: its apex is outside the domain's angles.
    notch = loops([(0, 0), (1, 0), (1, 1), (0.55, 1), (0.5, 0.5), (0.45, 1), (0, 1)])
    assert not (input_angles(notch)[0] == [0.5, 0.5]).all(axis=1).any()


def test_spikes_each_have_one() -> None:
    assert len(input_angles(star(20))[0]) == 20


def test_curves_that_touch_enclose_no_angle() -> None:
    for n in (6, 16, 256):
        one, other = disks([(0, 0, 1, 0, -1)], n=n), disks([(0.5, 0, 0.5, -1, 0)], n=n)
        points = np.vstack([one.points, other.points[1:]])
        moved = np.where(other.segments == 0, 0, other.segments + n - 1)
        merged = Pslg.build(
            points=points,
            segments=np.vstack([one.segments, moved]),
            segment_curve=np.repeat([0, 1], n),
            segment_interval=np.vstack([one.segment_interval, other.segment_interval]),
            segment_marker=np.zeros(2 * n, int),
            segment_region=np.vstack([one.segment_region, other.segment_region]),
            boundary_names=(("circles",),),
            curves=type(one.curves).concatenate([one.curves, other.curves]),
        )
        apexes, angles, _ = input_angles(merged)
        assert np.array_equal(apexes, [[1, 0]])
        assert angles[0] < 1e-9


def test_past_a_short_segment_the_long_ones_count() -> None:
    t = np.radians([0, 1, 2])
    rays = np.column_stack([np.cos(t), np.sin(t)]) * np.array([[3], [1], [2]])
    domain = Pslg.build(
        points=np.vstack([[0, 0], rays, [(-5, -5), (5, -5), (5, 5), (-5, 5)]]),
        segments=[[0, 1], [0, 2], [0, 3], [4, 5], [5, 6], [6, 7], [7, 4]],
        segment_marker=[0] * 7,
        segment_region=[[0, 0]] * 3 + [[0, -1]] * 4,
        boundary_names=(("edge",),),
    )
    _, angles, radii = input_angles(domain)
    assert angles[0] == pytest.approx(1)
    assert radii[0] == pytest.approx(2)

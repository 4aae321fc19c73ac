"""Measures of cells with known values."""

from __future__ import annotations

import numpy as np
import pytest

from csgmesh.errors import InputError
from csgmesh.measures import quality
from csgmesh.mesh import Mesh


def test_a_triangle_of_30_60_90_degrees():
    found = quality(Mesh([[0, 0], [3**0.5, 0], [0, 1]], {"triangle": [[0, 1, 2]]}))
    assert found.min_angle == pytest.approx([30]) and found.max_angle == pytest.approx([90])
    assert found.min_edge == pytest.approx([1]) and found.max_edge == pytest.approx([2])
    assert found.total_area == pytest.approx(3**0.5 / 2)
    assert np.isnan(found.sicn).all() and "sicn" not in found.extremes


def test_quads():
    points = [[0, 0], [2, 0], [2, 1], [0, 1], [3, 0], [4, 1]]
    found = quality(Mesh(points, {"quad": [[0, 1, 2, 3], [1, 4, 5, 2]]}))
    assert found.scaled_jacobian == pytest.approx([1, 2**-0.5])
    assert found.sicn == pytest.approx([0.8, 2 / 3])
    assert found.min_angle == pytest.approx([90, 45]) and found.max_angle == pytest.approx(
        [90, 135]
    )
    assert found.area == pytest.approx([2, 1.5])


def test_a_reflex_corner_is_more_than_180_degrees_and_negative():
    found = quality(Mesh([[0, 0], [4, 0], [1, 1], [0, 4]], {"quad": [[0, 1, 2, 3]]}))
    assert found.max_angle[0] > 180 and found.scaled_jacobian[0] < 0 and found.sicn[0] < 0
    assert found.area == pytest.approx([4])


def test_kinds_are_counted_one_after_the_other():
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0.5]]
    found = quality(Mesh(points, {"quad": [[0, 1, 2, 3]], "triangle": [[1, 4, 2]]}))
    assert found.n_by_kind == {"quad": 1, "triangle": 1} and found.n_cells == 2
    assert found.area == pytest.approx([1, 0.5])
    assert np.isnan(found.scaled_jacobian).tolist() == [False, True]
    assert found.extremes["scaled_jacobian"] == pytest.approx((1, 1))
    assert "1 quad, 1 triangle" in str(found)


def test_areas_far_from_the_origin_keep_their_digits():
    near = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    found = quality(Mesh(near + 2.0**40, {"triangle": [[0, 1, 2]]}))
    assert found.area[0] == 0.5


def test_degenerate_cells_are_measured_without_warnings():
    found = quality(Mesh([[0, 0], [1, 0], [0, 0]], {"triangle": [[0, 1, 2]]}))
    assert found.area[0] == 0 and found.min_edge[0] == 0
    quad = quality(Mesh([[0, 0], [1, 0], [1, 0], [0, 1]], {"quad": [[0, 1, 2, 3]]}))
    assert quad.min_edge[0] == 0 and np.isfinite(quad.min_angle[0])


def test_no_cells_and_wrong_meshes():
    assert str(quality(Mesh(np.zeros((0, 2)), {}))) == "0 points, 0 cells (none)"


def test_only_meshes_have_a_quality():
    with pytest.raises(InputError, match="quality needs a Mesh, as generate returns; got int"):
        quality(5)  # type: ignore[arg-type]

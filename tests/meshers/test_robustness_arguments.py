"""Arguments of any type: taken as what they mean, or refused with rule, value and place."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import csgmesh as cm

SQUARE = cm.Box((0, 0), (1, 1))
PSLG = cm.Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])


@pytest.mark.parametrize(
    "option",
    [
        {"min_angle": "30"},
        {"min_angle": None},
        {"min_angle": True},
        {"min_angle": [30]},
        {"min_angle": float("nan")},
        {"min_angle": 35},
        {"max_points": 2.5},
        {"max_points": "10"},
        {"max_points": float("inf")},
        {"max_points": 2},
        {"gradation": None},
        {"gradation": np.inf},
        {"gradation": "steep"},
        {"improve": 1},
    ],
)
def test_options_of_the_wrong_type_or_range_are_refused(option: dict[str, Any]) -> None:
    ((name, value),) = option.items()
    with pytest.raises(cm.InputError) as caught:
        cm.DelaunayRefinement(**option)
    assert name in str(caught.value) and repr(value) in str(caught.value)


def test_numbers_of_any_type_are_numbers() -> None:
    wanted = cm.DelaunayRefinement(min_angle=25, max_points=10_000, improve=True)
    for number in (np.float32, np.array, Fraction, Decimal, np.int16):
        given = cm.DelaunayRefinement(
            min_angle=number(25), max_points=number(10_000), improve=np.True_
        )
        assert given == wanted
    assert cm.DelaunayRefinement(max_points=1e4) == cm.DelaunayRefinement(max_points=10_000)
    meshes = [cm.generate(SQUARE, size=size) for size in (0.25, Fraction(1, 4), np.array(0.25))]
    assert all(mesh.equals(meshes[0]) for mesh in meshes)


@pytest.mark.parametrize(
    ("size", "message"),
    [
        (lambda p: np.zeros(len(p)), r"got 0 at \(0, 0\)"),
        (lambda p: -np.ones(len(p)), r"got -1 at \(0, 0\)"),
        (lambda p: np.where(p[:, 0] > 0.5, np.nan, 1.0), r"got nan at \(1, "),
        (lambda p: np.full(len(p), np.inf), r"got inf at \(0, 0\)"),
        (lambda p: np.abs(p[:, 0] - 0.5), r"got 0 at \(0.5, "),
        (lambda p: np.ones((len(p), 2)), r"got shape \(4, 2\) for 4 points, the first .*\(0, 0\)"),
        (lambda p: np.ones(3), r"got shape \(3,\) for 4 points"),
        (lambda p: ["a"] * len(p), r"must return numbers; got \['a'.* the first of them \(0, 0\)"),
        (lambda p: p[:, 0] * 1j, "must return numbers"),
        (lambda p: None, "must return numbers; got None"),
        (lambda p: [[1], [1, 2]], "must return numbers"),
        ("0.1", "'0.1'"),
        ([0.1], r"\[0.1\]"),
        (True, "True"),
        (cm.UniformSize, "UniformSize"),
        (1e300, "1e-100 and 1e"),
    ],
)
def test_sizes_that_are_none_are_refused_with_the_point(size: Any, message: str) -> None:
    with pytest.raises(cm.SizeError, match=message):
        cm.generate(SQUARE, size=size)


def test_callables_may_return_numbers_of_any_type() -> None:
    wanted = cm.generate(SQUARE, size=lambda p: np.full(len(p), 0.25))
    for one in (Fraction(1, 4), Decimal("0.25"), 0.25):
        assert cm.generate(SQUARE, size=lambda p, one=one: [one] * len(p)).equals(wanted)


@pytest.mark.parametrize("size", [1e-6, lambda p: np.full(len(p), 1e-6), {"default": 1e-6}])
def test_a_size_far_below_the_budget_is_refused_early(size: Any) -> None:
    with pytest.raises(cm.BudgetError, match=r"asks for about .* 1e-06|1e-06 asks for") as caught:
        cm.generate(SQUARE, cm.DelaunayRefinement(max_points=50_000), size=size)
    assert caught.value.mesh.n_points < 50_000


@pytest.mark.parametrize("option", ["deviation", "snap"])
def test_what_a_pslg_cannot_follow_is_refused(option: str) -> None:
    for verb in (cm.generate, cm.evaluate):
        with pytest.raises(cm.InputError, match=f"{option}=0.1"):
            verb(PSLG, **{option: 0.1})
    assert cm.check(cm.generate(PSLG, size=0.3), PSLG).ok


def test_a_name_of_a_region_and_a_boundary_sizes_both() -> None:
    core = cm.Disk((2, 1), 0.5, name="core")
    plate = cm.Regions({"rock": cm.Box((0, 0), (4, 2), name="plate"), "core": core})
    mesh = cm.generate(plate, size={"core": 0.05, "default": 0.5})
    ends = mesh.points[mesh.facets["line"][mesh.boundary("core")["line"]]]
    on_interface = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    corners = mesh.points[mesh.cells["triangle"][mesh.region("core")["triangle"]]]
    inside = np.hypot(*np.moveaxis(corners - np.roll(corners, 1, axis=1), -1, 0))
    assert on_interface.max() < 0.075
    assert inside.max() < 0.1


def test_shapes_of_nonsense_are_refused() -> None:
    with pytest.raises(cm.ShapeError, match=r"holes must be a sequence of rings.*got 5"):
        cm.Polygon([(0, 0), (1, 0), (1, 1)], holes=5)
    with pytest.raises(cm.InputError, match="mesher must be an object"):
        cm.generate(SQUARE, cm.DelaunayRefinement)

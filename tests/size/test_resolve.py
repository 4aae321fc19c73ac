"""Names, numbers and callables of a size."""

from __future__ import annotations

import numpy as np
import pytest

from csgmesh.domain import Pslg
from csgmesh.errors import NameLookupError, SizeError
from csgmesh.size import SizeField, UniformSize, resolve
from csgmesh.size.resolve import evaluate


@pytest.fixture
def plate() -> Pslg:
    names = ("plate.left", "plate.right", "plate.bottom", "plate.top")
    return Pslg.build(
        points=[[0, 0], [1, 0], [1, 1], [0, 1]],
        segments=[[3, 0], [1, 2], [0, 1], [2, 3]],
        segment_marker=[0, 1, 2, 3],
        segment_region=[[0, -1]] * 4,
        boundary_names=tuple((n,) for n in names),
        region_names=("rock", "core"),
    )


def test_a_number_is_uniform(plate: Pslg) -> None:
    assert resolve(0.1, plate).uniform == 0.1
    assert resolve(np.float64(0.1), plate).uniform == 0.1
    assert resolve(UniformSize(2), plate).uniform == 2.0
    assert resolve(None, plate) is None
    assert resolve({"default": 0.3}, plate).uniform == 0.3


def test_keys_mean_boundaries_and_regions(plate: Pslg) -> None:
    wanted = resolve({"plate": 0.1, "*.top": 0.2, "core": 0.3, "default": 1}, plate)
    assert [m.tolist() for m, _ in wanted.boundary] == [[0, 1, 2, 3], [3]]
    assert [r.tolist() for r, _ in wanted.region] == [[1]]
    assert wanted.uniform is None


def test_unknown_keys_suggest_both_kinds(plate: Pslg) -> None:
    with pytest.raises(NameLookupError, match="core"):
        resolve({"cor": 0.1}, plate)
    with pytest.raises(NameLookupError, match=r"plate\.left"):
        resolve({"plate.lft": 0.1}, plate)


def test_fields_and_callables_pass_through(plate: Pslg) -> None:
    class Ramp(SizeField):
        def bind(self, domain: Pslg):
            return lambda points: 0.1 + points[:, 0]

    source = resolve({"rock": Ramp()}, plate).region[0][1]
    assert evaluate(source, np.array([[1.0, 0.0]])).tolist() == [1.1]
    assert evaluate(resolve(lambda p: 0.5, plate).default, np.zeros((3, 2))).tolist() == [0.5] * 3


def test_a_callable_cannot_change_the_points(plate: Pslg) -> None:
    points = np.ones((2, 2))

    def rude(p: np.ndarray) -> np.ndarray:
        p[:] = 7
        return np.ones(len(p))

    evaluate(resolve(rude, plate).default, points)
    assert (points == 1).all()


@pytest.mark.parametrize("value", [0, -1, np.nan, np.inf, "x", True, [1, 2]])
def test_bad_values_are_refused(plate: Pslg, value) -> None:
    with pytest.raises(SizeError, match="size"):
        resolve(value, plate)
    with pytest.raises(SizeError, match="rock"):
        resolve({"rock": value}, plate)

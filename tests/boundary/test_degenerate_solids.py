"""Solids that touch, coincide or nearly do: exact volumes and areas, closed, and named right."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

PI = np.pi
BOX = cm.Box((0, 0, 0), (2, 2, 2), name="box")


def plate(gap: float) -> cm.Shape:
    """Two boxes with a gap between them, or overlapping by -gap."""
    return BOX | cm.Box((2 + gap, 0, 0), (4 + gap, 2, 2), name="next")


#: Solid, exact volume, exact area, Euler characteristic.
TABLE = {
    "ball on a face, inside": (BOX - cm.Ball((1, 1, 1), 1), 8 - 4 / 3 * PI, 24 + 4 * PI, -2),
    "ball on a face, outside": (BOX | cm.Ball((1, 1, 3), 1), 8 + 4 / 3 * PI, 24 + 4 * PI, 3),
    "cylinders tangent along a line": (
        cm.Cylinder((0, 0, 0), (0, 0, 1), 1) | cm.Cylinder((2, 0, 0), (2, 0, 1), 1),
        2 * PI,
        8 * PI,
        3,
    ),
    "shared face": (BOX | cm.Box((2, 0, 0), (4, 2, 2)), 16, 40, 2),
    "part of a face": (BOX | cm.Box((2, 1, 0.5), (4, 3, 1.5)), 12, 38, 2),
    "shared edge": (BOX | cm.Box((2, 2, 0), (4, 4, 2)), 16, 48, 3),
    "part of an edge": (BOX | cm.Box((2, 2, 1), (4, 4, 3)), 16, 48, 3),
    "shared corner": (BOX | cm.Box((2, 2, 2), (4, 4, 4)), 16, 48, 3),
    "edges that cross": (
        cm.Box((-1, -1, 0), (1, 1, 2)).rotate(45, axis=(0, 1, 0), center=(0, 0, 0))
        | cm.Box((-1, -1, -2), (1, 1, 0)).rotate(45, axis=(1, 0, 0), center=(0, 0, 0)),
        None,
        None,
        None,
    ),
    "coincident faces": (BOX - cm.Box((0, 0, 1), (2, 2, 2)), 4, 16, 2),
    "partly coincident faces": (BOX | cm.Cylinder((2, 2, 0), (2, 2, 2), 1), None, None, 2),
    "a ball less the same ball turned": (
        (BOX | cm.Ball((5, 1, 1), 1))
        - cm.Ball((5, 1, 1), 1).rotate(30, axis=(1, 2, 3), center=(5, 1, 1)),
        8,
        24,
        2,
    ),
    "a cylinder in its own bore": (
        (BOX - cm.Cylinder((1, 1, -1), (1, 1, 3), 0.5)) | cm.Cylinder((1, 1, 2), (1, 1, 0), 0.5),
        8,
        24,
        2,
    ),
    "a cavity": (BOX - cm.Ball((1, 1, 1), 0.5), 8 - PI / 6, 24 + PI, 4),
    "a cavity that touches": (BOX - cm.Box((0.5, 0.5, 1), (1.5, 1.5, 2)), 7, 28, 2),
    "half-spaces bounded together": (
        ~cm.union(*(cm.HalfSpace(-p, p) for p in np.concatenate([np.eye(3), -np.eye(3)]))),
        8,
        24,
        2,
    ),
}


def assert_closed(plc: cm.Plc) -> None:
    edges = plc.facets[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    forward = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    _, key = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    assert not np.bincount(key.ravel(), weights=forward).any()


@pytest.mark.parametrize("name", TABLE)
def test_solids_that_touch(name: str) -> None:
    shape, volume, area, euler = TABLE[name]
    plc = cm.evaluate(shape)
    assert_closed(plc)
    assert plc.facet_areas().min() > 0.0
    slack = plc.deviation * plc.facet_areas().sum() + 1e-12
    if volume is not None:
        assert plc.volumes()[0] == pytest.approx(volume, abs=slack)
    if area is not None:
        assert plc.facet_areas().sum() == pytest.approx(area, rel=0.01)
        if (plc.surfaces.kind == 0).all():
            assert plc.volumes()[0] == pytest.approx(volume, rel=1e-14)
            assert plc.facet_areas().sum() == pytest.approx(area, rel=1e-14)
    if euler is not None:
        assert plc.euler_characteristic() == euler


@pytest.mark.parametrize("gap", [1e-3, 1e-5, 1e-7, 2e-9])
def test_gaps_and_walls_above_the_snap_distance_stay(gap: float) -> None:
    apart = cm.evaluate(plate(gap))
    assert_closed(apart)
    assert apart.euler_characteristic() == 4
    assert apart.volumes()[0] == pytest.approx(16, rel=1e-13)
    wall = cm.evaluate(BOX - cm.Box((0.5, 0.5, gap), (1.5, 1.5, 1)))
    assert wall.euler_characteristic() == 4
    assert wall.volumes()[0] == pytest.approx(8 - (1 - gap), rel=1e-13)


@pytest.mark.parametrize("gap", [1e-11, -1e-11, 1e-13])
def test_gaps_below_the_snap_distance_close(gap: float) -> None:
    plc = cm.evaluate(plate(gap))
    assert_closed(plc)
    assert plc.euler_characteristic() == 2
    assert plc.volumes()[0] == pytest.approx(16, rel=1e-9)


@pytest.mark.parametrize("value", [np.inf, -np.inf, np.nan, 1e300])
def test_numbers_are_looked_at_before_any_boolean(value: float) -> None:
    for build in (
        lambda: cm.Ball((0, 0, 0), value),
        lambda: cm.Box((0, 0, 0), (1, 1, value)),
        lambda: cm.Cylinder((0, 0, value), (0, 0, 1), 1),
        lambda: cm.Ball((0, 0, 0), 1).translate((value, 0, 0)),
    ):
        with pytest.raises(cm.ShapeError):
            cm.evaluate(build() | BOX)


def test_a_thousand_leaves() -> None:
    cubes = cm.union(
        cm.Box((i, j, k), (i + 1, j + 1, k + 1))
        for i in range(10) for j in range(10) for k in range(10)
    )  # fmt: skip
    plc = cm.evaluate(cubes)
    assert plc.volumes()[0] == pytest.approx(1000, rel=1e-13)
    assert plc.facet_areas().sum() == pytest.approx(600, rel=1e-13)
    assert plc.euler_characteristic() == 2
    assert plc.area("box") == pytest.approx(3, rel=1e-13)

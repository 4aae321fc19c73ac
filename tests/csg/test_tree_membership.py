"""Membership and bounds of large and unusual trees, against plain evaluation leaf by leaf."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.csg.program import compile_shape

RNG = np.random.default_rng(5)


def test_a_thousand_disks_with_a_thousand_holes() -> None:
    centers, holes = RNG.uniform(0, 30, (2, 1000, 2))
    shape = cm.union(cm.Disk(c, 0.7) for c in centers) - cm.union(cm.Disk(c, 0.4) for c in holes)
    points = RNG.uniform(-1, 31, (20_000, 2))
    near = (np.hypot(*(points[:, None] - centers).transpose(2, 0, 1)) <= 0.7).any(axis=1)
    cut = (np.hypot(*(points[:, None] - holes).transpose(2, 0, 1)) <= 0.4).any(axis=1)
    assert np.array_equal(shape.contains(points), near & ~cut)


def test_parity_of_many() -> None:
    radii = np.arange(1, 200)
    shape = cm.symmetric_difference(cm.Disk((0, 0), r) for r in radii)
    points = RNG.uniform(-250, 250, (50_000, 2))
    inside = (np.hypot(*points.T)[:, None] <= radii).sum(axis=1) % 2 == 1
    assert np.array_equal(shape.contains(points), inside)
    assert np.array_equal((~shape).contains(points), ~inside)


def test_the_regular_polygon_from_half_spaces() -> None:
    angles = 2 * np.pi * np.arange(500) / 500
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    shape = cm.intersection(cm.HalfSpace(n, n) for n in normals)
    points = RNG.uniform(-1.5, 1.5, (50_000, 2))
    assert np.array_equal(shape.contains(points), (points @ normals.T).max(axis=1) <= 1)
    low, high = shape.bounds()
    assert np.allclose(low, -1, atol=1e-4)
    assert np.allclose(high, 1, atol=1e-4)


def test_many_regions_the_last_one_wins() -> None:
    centers = RNG.uniform(0, 20, (300, 2))
    grains = cm.Regions({f"grain{k}": cm.Disk(c, 1) for k, c in enumerate(centers)})
    points = RNG.uniform(0, 20, (20_000, 2))
    inside = np.hypot(*(points[:, None] - centers).transpose(2, 0, 1)) <= 1
    last = np.where(inside.any(axis=1), 299 - np.argmax(inside[:, ::-1], axis=1), -1)
    assert np.array_equal(compile_shape(grains).region(points), last)


def test_many_nearly_equal_leaves_are_cut_away() -> None:
    ellipses = [cm.Ellipse((0, 0), (4 + k / 500, 2), 30) for k in range(60)]
    boxes = [cm.Box((-5, -3), (5 + k / 500, 3)).rotate(20) for k in range(60)]
    shape = cm.symmetric_difference(ellipses) | cm.intersection(boxes)
    points = RNG.uniform(-6, 6, (20_000, 2))
    z = (points[:, 0] + 1j * points[:, 1]) * np.exp(-1j * np.radians(30))
    odd = np.zeros(len(points), int)
    for k in range(60):
        odd += (z.real / (4 + k / 500)) ** 2 + (z.imag / 2) ** 2 <= 1
    w = (points[:, 0] + 1j * points[:, 1]) * np.exp(-1j * np.radians(20))
    within = (np.abs(w.real) <= 5) & (np.abs(w.imag) <= 3)
    assert np.array_equal(shape.contains(points), (odd % 2 == 1) | within)


def test_few_points_and_none() -> None:
    disk = cm.Disk((0, 0), 1)
    assert disk.contains((0, 0)).tolist() == [True]
    assert disk.contains(np.zeros((0, 2))).tolist() == []
    assert disk.contains([(0, 0)] * 50_000).all()
    everything = disk | ~disk
    assert everything.contains(RNG.uniform(-2, 2, (100, 2))).all()


INF = np.inf


def plane(x: float, y: float, a: float, b: float) -> cm.Shape:
    return cm.HalfSpace((x, y), (a, b))


BOX = cm.Box((0, 0), (4, 2))
WEDGE = plane(0, 0, -2, 1) & plane(0, 0, -2, -1)  # |y| ≤ 2x
BOUNDS = {
    "union": (BOX | cm.Disk((6, 1), 1), (0, 0), (7, 2)),
    "intersection": (BOX & cm.Disk((4, 1), 1), (3, 0), (4, 2)),
    "difference": (BOX - cm.Disk((2, 1), 1), (0, 0), (4, 2)),
    "difference of a complement": (BOX - ~cm.Disk((4, 1), 1), (3, 0), (4, 2)),
    "complement": (~BOX, (-INF, -INF), (INF, INF)),
    "de Morgan": (~(~BOX | ~cm.Disk((4, 1), 1)), (3, 0), (4, 2)),
    "half-plane": (plane(3, 1, 2, 0), (-INF, -INF), (3, INF)),
    "slanted half-plane": (plane(3, 1, 2, 1), (-INF, -INF), (INF, INF)),
    "complement of a half-plane": (~plane(3, 1, 0, 2), (-INF, 1), (INF, INF)),
    "strip": (plane(0, 0, -1, 0) & plane(1, 0, 1, 0), (0, -INF), (1, INF)),
    "slanted strip": (plane(0, 0, -1, 1) & plane(1, 0, 1, -1), (-INF, -INF), (INF, INF)),
    "wedge": (WEDGE, (0, -INF), (INF, INF)),
    "cut wedge": (WEDGE & plane(3, 0, 1, 0), (0, -6), (3, 6)),
    "wedge less a half-plane": (WEDGE - plane(3, 0, -1, 0), (0, -6), (3, 6)),
    "triangle by complements": (
        ~(plane(0, 0, 1, 0) | plane(0, 0, 0, 1) | plane(1, 0, -1, -1)),
        (0, 0),
        (1, 1),
    ),
    "cut box": (BOX & plane(1, 0, 1, 1), (0, 0), (1, 1)),
    "box cut in parts": (((BOX & plane(1, 0, 1, 1)) | BOX.translate((9, 0))), (0, 0), (13, 2)),
    "far away": (
        (WEDGE & plane(3, 0, 1, 0)).translate((1e9, 1e9)),
        (1e9, 1e9 - 6),
        (1e9 + 3, 1e9 + 6),
    ),
    "tiny": ((WEDGE & plane(3, 0, 1, 0)).scale(1e-9), (0, -6e-9), (3e-9, 6e-9)),
    "parity": (BOX ^ cm.Disk((4, 1), 1), (0, 0), (5, 2)),
    "turned ellipse": (cm.Ellipse((0, 0), (5, 5)).scale((2, 1)).rotate(45), None, None),
    "nothing": (BOX & BOX.translate((9, 0)), (INF, INF), (-INF, -INF)),
    "nothing between half-planes": (
        plane(0, 0, 1, 1) & plane(1, 0, -1, -1),
        (INF, INF),
        (-INF, -INF),
    ),
}


@pytest.mark.parametrize("case", BOUNDS)
def test_bounds(case: str) -> None:
    shape, low, high = BOUNDS[case]
    got = shape.bounds()
    if low is None:
        high = np.full(2, np.sqrt((100 + 25) / 2))
        low = -high
    assert np.allclose(got[0], low, rtol=1e-12, atol=1e-18)
    assert np.allclose(got[1], high, rtol=1e-12, atol=1e-18)


def test_slanted_sides_meet_exactly_far_from_the_origin() -> None:
    corner = plane(1e9, 1e9, 1, 1) & plane(1e9, 1e9, -1, 1)
    assert corner.bounds()[1][1] == 1e9


def test_importing_the_tree_is_light() -> None:
    import subprocess
    import sys

    code = (
        "import csgmesh as cm, sys; s = cm.Box((0, 0), (1, 1)) - cm.Disk((0, 0), 1);"
        "s.contains([(0, 0)]); s.bounds(); hash(s); repr(s);"
        "print([m for m in ('numba', 'scipy', 'matplotlib', 'shapely') if m in sys.modules])"
    )
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "[]"

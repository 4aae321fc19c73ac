"""Exact areas against an independent construction, and trees of ten thousand leaves."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import csgmesh as cm


def union_area(centres: np.ndarray, radii: np.ndarray) -> float:
    """Area of a union of disks by Green's theorem over the uncovered arcs of each circle."""
    total = 0.0
    for k, (c, r) in enumerate(zip(centres, radii, strict=True)):
        # Only neighbours can cover a circle.
        near = np.flatnonzero(np.hypot(*(centres - c).T) < r + radii)
        total += uncovered(c, r, centres[near[near != k]] - c, radii[near[near != k]])
    return total


def uncovered(c: np.ndarray, r: float, d: np.ndarray, s: np.ndarray) -> float:
    """Green's terms of the arcs of a circle that disks of radii s at offsets d leave free."""
    gap = np.hypot(*d.T)
    if (gap <= s - r).any():
        return 0.0
    d, s, gap = (x[gap > r - s] for x in (d, s, gap))
    half = np.arccos((gap**2 + r**2 - s**2) / (2 * gap * r))
    a = (np.arctan2(d[:, 1], d[:, 0]) - half) % (2 * np.pi)
    spans = [(x, min(x + 2 * h, 2 * np.pi)) for x, h in zip(a, half, strict=True)]
    spans += [(0.0, x + 2 * h - 2 * np.pi) for x, h in zip(a, half, strict=True)]
    total, at = 0.0, 0.0
    for x, y in [*sorted(spans), (2 * np.pi, 2 * np.pi)]:
        if x > at:
            bow = c[0] * (np.sin(x) - np.sin(at)) - c[1] * (np.cos(x) - np.cos(at))
            total += 0.5 * r * r * (x - at) + 0.5 * r * bow
        at = max(at, y)
    return float(total)


@pytest.mark.parametrize("seed", range(5))
def test_thirty_random_overlapping_disks(seed):
    rng = np.random.default_rng(seed)
    centres, radii = rng.random((30, 2)), 0.05 + 0.15 * rng.random(30)
    disks = cm.union(cm.Disk(tuple(c), r) for c, r in zip(centres, radii, strict=True))
    square = cm.Box((-1, -1), (2, 2))
    exact = union_area(centres, radii)
    assert cm.evaluate(disks).areas()[0] == pytest.approx(exact, rel=1e-13)
    assert cm.evaluate(square - disks).areas()[0] == pytest.approx(9 - exact, rel=1e-13)
    clipped = cm.evaluate(cm.Box((0, 0), (1, 1)) - disks)
    sample = np.random.default_rng(seed + 100).random((1_000_000, 2))
    share = (cm.Box((0, 0), (1, 1)) - disks).contains(sample).mean()
    assert clipped.areas()[0] == pytest.approx(share, abs=5 * np.sqrt(0.25 / len(sample)))


def random_disks(n: int, size: float, seed: int) -> list[cm.Disk]:
    rng = np.random.default_rng(seed)
    centres, radii = rng.random((n, 2)) * size, 0.2 + rng.random(n)
    return [cm.Disk(tuple(c), float(r)) for c, r in zip(centres.tolist(), radii, strict=True)]


def test_ten_thousand_terms_one_by_one():
    disks = random_disks(10_000, 150.0, seed=3)
    shape = disks[0]
    for disk in disks[1:]:
        shape = shape | disk
    assert hash(shape) == hash(cm.union(disks))
    assert pickle.loads(pickle.dumps(shape)) == shape
    assert len(str(shape)) < 10_000
    pslg = cm.evaluate(shape)
    centres = np.array([d.center for d in disks])
    radii = np.array([d.radius for d in disks])
    assert pslg.areas()[0] == pytest.approx(union_area(centres, radii), rel=1e-11)


def test_a_deep_tree_that_does_not_flatten():
    disks = random_disks(2_000, 150.0, seed=4)
    shape = cm.Box((0, 0), (150, 150))
    for k, disk in enumerate(disks):
        shape = shape | disk if k % 2 else shape - disk
    pslg = cm.evaluate(shape)
    points = np.random.default_rng(0).random((200_000, 2)) * 154 - 2
    area = 154.0**2 * shape.contains(points).mean()
    assert pslg.areas()[0] == pytest.approx(area, rel=0.01)


def test_a_plate_with_many_holes_names_each():
    holes = [cm.Disk((i + 0.5, j + 0.5), 0.3) for i in range(40) for j in range(40)]
    pslg = cm.evaluate(cm.difference(cm.Box((0, 0), (40, 40)), *holes))
    assert len(pslg.boundary_names) == 4 + 1600
    assert pslg.areas()[0] == pytest.approx(1600 * (1 - np.pi * 0.09), rel=1e-13)


def test_a_polygon_of_many_vertices():
    t = np.linspace(0, 2 * np.pi, 50_000, endpoint=False)
    r = 1 + 0.1 * np.sin(7 * t) + 1e-5 * np.random.default_rng(0).standard_normal(len(t))
    points = np.column_stack([r * np.cos(t), r * np.sin(t)])
    x, y = points.T
    exact = 0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()
    assert cm.evaluate(cm.Polygon(points)).areas()[0] == pytest.approx(exact, rel=1e-12)

"""Solids of 10⁵ facets and more for the section evaluation, as trees and as manifold3d's own.

manifold3d's primitives get as many facets as ours have, so that both cut the same amount.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import csgmesh as cm


@dataclass(frozen=True)
class Model:
    """A tree, the deviation it is evaluated with, and manifold3d's boolean of the like."""

    shape: Any
    deviation: float
    manifold3d: Callable[[], Any]
    leaves: int


def balls(count: int, side: float, deviation: float) -> Model:
    """A union of balls with centres in a cube."""
    center, radius = _scattered(count, side)
    return Model(cm.union(_our_balls(center, radius)), deviation,
                 lambda: _union(_their_balls(center, radius, deviation)), count)  # fmt: skip


def balls_and_boxes(count: int, side: float, deviation: float) -> Model:
    """A union of half balls, half boxes."""
    center, radius = _scattered(count // 2, side)
    rng = np.random.default_rng(7)
    low = rng.random((count // 2, 3)) * side
    size = 0.2 + 0.5 * rng.random((count // 2, 3))
    boxes = [cm.Box(p, q) for p, q in zip(low.tolist(), (low + size).tolist(), strict=True)]

    def theirs() -> Any:
        from manifold3d import Manifold

        corners = zip(low.tolist(), size.tolist(), strict=True)
        cubes = [Manifold.cube(tuple(s)).translate(p) for p, s in corners]
        return _union([*_their_balls(center, radius, deviation), *cubes])

    return Model(cm.union([*_our_balls(center, radius), *boxes]), deviation, theirs, count)


def cylinders(count: int, side: float, deviation: float) -> Model:
    """A union of cylinders that lie askew."""
    rng = np.random.default_rng(5)
    base = rng.random((count, 3)) * side
    axis = rng.normal(size=(count, 3))
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    length, radius = 1.0 + rng.random(count), 0.1 + 0.2 * rng.random(count)
    top = base + length[:, None] * axis
    rows = list(zip(base.tolist(), top.tolist(), radius.tolist(), strict=True))

    def theirs() -> Any:
        from manifold3d import Manifold

        found = []
        for (p, q, r), w in zip(rows, axis, strict=True):
            u = np.cross(w, np.eye(3)[np.argmin(np.abs(w))])
            u /= np.linalg.norm(u)
            place = np.column_stack([u, np.cross(w, u), w, p])
            height = float(np.linalg.norm(np.subtract(q, p)))
            solid = Manifold.cylinder(height, r, r, _around(r, deviation))
            found.append(solid.transform(place))
        return _union(found)

    return Model(cm.union([cm.Cylinder(*row) for row in rows]), deviation, theirs, count)


def drilled_plate(count: int, deviation: float) -> Model:
    """A plate with so many holes a side."""
    r = 0.3
    holes = [(i + 0.5, j + 0.5) for i in range(count) for j in range(count)]
    bores = [cm.Cylinder((x, y, -1), (x, y, 2), r) for x, y in holes]

    def theirs() -> Any:
        from manifold3d import Manifold

        around = _around(r, deviation)
        drills = [Manifold.cylinder(3.0, r, r, around).translate((x, y, -1)) for x, y in holes]
        return Manifold.cube((count, count, 1)) - _union(drills)

    plate = cm.Box((0, 0, 0), (count, count, 1))
    return Model(plate - cm.union(bores), deviation, theirs, 1 + len(holes))


MODELS: dict[str, Callable[[float], Model]] = {
    "100 balls": lambda share: balls(100, 4.0, 2e-3 / share),
    "100 balls, finer": lambda share: balls(100, 4.0, 2e-4 / share),
    "1,000 balls": lambda share: balls(1000, 10.0, 2e-3 / share),
    "300 cylinders": lambda share: cylinders(300, 4.0, 5e-4 / share),
    "plate with 400 holes": lambda share: drilled_plate(20, 2e-4 / share),
    "100 balls, 100 boxes": lambda share: balls_and_boxes(200, 4.0, 1e-3 / share),
}


def _scattered(count: int, side: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    return rng.random((count, 3)) * side, 0.3 + 0.2 * rng.random(count)


def _our_balls(center: np.ndarray, radius: np.ndarray) -> list[Any]:
    rows = zip(center.tolist(), radius.tolist(), strict=True)
    return [cm.Ball(tuple(c), r) for c, r in rows]


def _their_balls(center: np.ndarray, radius: np.ndarray, deviation: float) -> list[Any]:
    from manifold3d import Manifold

    found = []
    for c, r in zip(center.tolist(), radius.tolist(), strict=True):
        # Ours have about the square of that many facets, theirs half the square of theirs.
        around = int(np.ceil(np.sqrt(2.0) * _around(r, 0.5 * deviation)))
        found.append(Manifold.sphere(r, around).translate(c))
    return found


def _around(radius: float, deviation: float) -> int:
    """Into how many pieces we cut a turn."""
    return -(-int(np.ceil(np.pi / np.arccos(1.0 - deviation / radius))) // 4) * 4


def _union(solids: Sequence[Any]) -> Any:
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean(list(solids), OpType.Add)

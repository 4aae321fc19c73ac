"""Random trees by number: half of them on a lattice, where coincidences are the rule."""

from __future__ import annotations

from collections.abc import Callable
from math import pi

import numpy as np

import csgmesh as cm

#: Distances by which a leaf on the lattice may be off it: below and above the snap distance.
JITTER = (0.0, 0.0, 0.0, 1e-13, 1e-10, 1e-8, 1e-5)


class Dice:
    """Coordinates of one tree."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.on_lattice = bool(self.rng.random() < 0.5)

    def number(self, low: float, high: float) -> float:
        value = self.rng.uniform(low, high)
        if not self.on_lattice:
            return float(value)
        return float(np.ceil(4 * value) / 4 + self.rng.choice(JITTER))

    def point(self) -> tuple[float, float]:
        return self.number(-4, 4), self.number(-4, 4)

    def length(self) -> float:
        return self.number(0.1, 3)

    def degrees(self) -> float:
        return float(15 * self.rng.integers(24)) if self.on_lattice else self.number(0, 360)

    def name(self) -> str | None:
        return (None, "a", "b", "plate")[self.rng.integers(4)]


def box(dice: Dice) -> cm.Shape:
    x, y = dice.point()
    return cm.Box((x, y), (x + dice.length(), y + dice.length()), name=dice.name())


def star(dice: Dice) -> cm.Shape:
    n = int(dice.rng.integers(3, 12))
    t = 2 * pi * np.arange(n) / n
    r = [dice.length() for _ in range(n)]
    return cm.Polygon(np.add(dice.point(), np.column_stack([r * np.cos(t), r * np.sin(t)])))


def leaf_outline(dice: Dice) -> cm.Shape:
    points = [dice.point() for _ in range(9)]
    wave = [points[0], ("cubic", *points[1:4]), ("quadratic", *points[4:6])]
    x, y, r = *points[6], dice.length()
    round_end = [(x, y), ("arc", (x + r, y + r), (x, y + 2 * r))]
    return cm.Outline([wave, round_end], ("nonzero", "evenodd")[dice.rng.integers(2)])


LEAVES: tuple[Callable[[Dice], cm.Shape], ...] = (
    box,
    box,
    lambda d: cm.Disk(d.point(), d.length(), name=d.name()),
    lambda d: cm.Disk(d.point(), d.length(), name=d.name()),
    lambda d: cm.Ellipse(d.point(), (d.length(), d.length()), d.degrees(), name=d.name()),
    lambda d: cm.RegularPolygon(d.point(), d.length(), int(d.rng.integers(3, 9)), name=d.name()),
    lambda d: cm.HalfSpace(d.point(), (1.0, d.number(-2, 2)), name=d.name()),
    star,
    leaf_outline,
)

PAIRS: tuple[Callable[[cm.Shape, cm.Shape], cm.Shape], ...] = (
    lambda a, b: a | b,
    lambda a, b: a | b,
    lambda a, b: a - b,
    lambda a, b: a - b,
    lambda a, b: a & b,
    lambda a, b: a ^ b,
    lambda a, b: a & ~b,
)

CHANGES: tuple[Callable[[Dice, cm.Shape], cm.Shape], ...] = (
    lambda d, s: s,
    lambda d, s: s,
    lambda d, s: s,
    lambda d, s: s.rotate(d.degrees(), center=d.point()),
    lambda d, s: s.translate(d.point()),
    lambda d, s: s.scale((d.length(), -d.length())),
    lambda d, s: s.mirror(d.point(), (1, 2)),
)


def tree(seed: int) -> cm.Shape:
    """Tree number `seed`, of 1 to 12 leaves."""
    dice = Dice(seed)

    def pick(options: tuple) -> Callable:
        return options[dice.rng.integers(len(options))]

    shapes = [pick(LEAVES)(dice) for _ in range(dice.rng.integers(1, 13))]
    while len(shapes) > 1:
        # Mostly the last two: trees both deep and bushy.
        first = shapes.pop(dice.rng.integers(max(len(shapes) - 3, 0), len(shapes)))
        second = pick(CHANGES)(dice, shapes.pop())
        shapes.append(pick(PAIRS)(first, second))
    return shapes[0]


def domain(seed: int) -> cm.Shape | cm.Regions:
    """Tree number `seed`; every fourth is two regions instead, the second inside or across."""
    shape = tree(seed)
    if seed % 4:
        return shape
    return cm.Regions({"first": shape, "second": tree(seed + 10**6)})

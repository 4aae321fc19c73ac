"""Where the layers of a sweep begin and end: by the size wanted along it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from csgmesh.domain.names import find_names
from csgmesh.domain.plc import Plc
from csgmesh.domain.sweep import SweptDomain
from csgmesh.errors import BudgetError
from csgmesh.mesh import Mesh
from csgmesh.size.combinations import (
    CallableSize,
    ClampedSize,
    MinimumSize,
    ProductSize,
    as_field,
)
from csgmesh.size.field import Source, UniformSize
from csgmesh.size.near import GRADATION

#: Fewest layers of a full turn: with fewer its cells would be thinner at the axis than at the rim
#: by more than a right angle.
_FEWEST_AROUND = 8

#: Places along the sweep where a size is looked at, at first; and the most of them.
_SAMPLES, _MOST_SAMPLES = 65, 4097

#: Values of a size taken in all, so that large profiles are looked at in fewer points.
_MOST_VALUES = 4_000_000

#: Steps that differ by less, relatively, are one step: rounding of a size that does not vary.
_EVEN = 1e-9


def stations(
    flat: Mesh,
    sweep: SweptDomain,
    domain: Plc,
    size: Any,
    layers: int | None,
    max_points: int,
    multiple: int = 1,
) -> np.ndarray:
    """Places that the layers end at.

    The step at a place is the smallest wanted there over the profile; towards ends with sizes of
    their own it falls to theirs; it changes by at most 0.3 per unit of length. Layers share the
    integral of its inverse evenly; they are even where the step is.

    Parameters
    ----------
    flat : Mesh
        Of the profile; its points are where sizes are looked at.
    sweep : SweptDomain
    domain : Plc
        Whose names a size may have.
    size : None, float, mapping, callable or SizeField
    layers : int or None
        How many; None: by the size.
    max_points : int
        Most points of all layers.
    multiple : int
        What the number of layers is to be a multiple of, where the size says it.

    Returns
    -------
    (n + 1,) float64
        From 0 to the sweep's amount, increasing, in its unit.

    Raises
    ------
    BudgetError
        If the layers would have more than `max_points` points.
    """
    demand = _Demand.of(flat, sweep, domain, size)
    place, step = demand.steps()
    even = step.max() <= step.min() * (1.0 + _EVEN)
    share = np.diff(place) * (0.5 / step[1:] + 0.5 / step[:-1])
    passed = np.concatenate([[0.0], np.cumsum(share)])
    n = layers
    if n is None:
        wanted = sweep.amount / step[0] if even else np.ceil(passed[-1] * (1.0 - _EVEN))
        fewest = np.ceil(_FEWEST_AROUND * sweep.amount / 360.0) if sweep.is_turned else 1
        n = -(-int(max(round(float(wanted)), fewest)) // multiple) * multiple
    if (n + 1) * flat.n_points > max_points:
        raise BudgetError(
            f"{n} layers of {flat.n_points} points each would have {(n + 1) * flat.n_points} "
            f"points; max_points is {max_points}"
        )
    if even:
        return np.asarray(sweep.amount * np.arange(n + 1) / n)
    at = np.interp(passed[-1] * np.arange(n + 1) / n, passed, place)
    at[0], at[-1] = 0.0, sweep.amount
    return np.asarray(at)


def source_of_place(value: Any, what: str, domain: Plc) -> Source | None:
    """A size as a function of points in space; None for one that is tied to curves or regions."""
    field = as_field(value, what)
    return field.bind(domain) if _is_of_place(field) else None  # type: ignore[arg-type]


def _is_of_place(field: Any) -> bool:
    """Whether a field is made of numbers and functions of points alone."""
    if isinstance(field, MinimumSize):
        return all(_is_of_place(size) for size in field.sizes)
    if isinstance(field, ProductSize):
        return _is_of_place(field.size) and _is_of_place(field.factor)
    if isinstance(field, ClampedSize):
        return _is_of_place(field.size)
    return isinstance(field, (CallableSize, UniformSize))


@dataclass(frozen=True, eq=False)
class _Demand:
    """What is wanted along a sweep.

    Attributes
    ----------
    sweep : SweptDomain
    points : (n, 2) float64
        Of the profile, off the axis.
    speed : (n,) float64
        Length that they are moved by a unit of the sweep, at the most.
    everywhere : callable or float
        The size, or a step.
    ends : tuple of two callables or None
        The sizes at the start and the end.
    """

    sweep: SweptDomain
    points: np.ndarray
    speed: np.ndarray
    everywhere: Source | float
    ends: tuple[Source | None, Source | None]

    @classmethod
    def of(cls, flat: Mesh, sweep: SweptDomain, domain: Plc, size: Any) -> _Demand:
        points, speed = flat.points, np.ones(flat.n_points)
        if sweep.is_turned:
            points = points[points[:, 0] > sweep.profile.snap]
            speed = np.radians(points[:, 0])
        base, ends = _asked(size, sweep, domain)
        everywhere: Source | float
        if base is None:
            everywhere = _median_edge(flat) / float(speed.max())
        else:
            everywhere = base
        plane = sweep.matrix[:, :2] if sweep.is_turned else sweep.matrix[:, 2:]
        return cls(sweep, points, speed * np.linalg.norm(plane, 2), everywhere, ends)

    def steps(self) -> tuple[np.ndarray, np.ndarray]:
        """Places along the sweep, and the step wanted at each; linear between them."""
        amount = self.sweep.amount
        place, step = self._sampled()
        caps = [None if s is None else self._least(s, a) for s, a in self._ends_at()]
        if any(cap is not None for cap in caps):
            close = [_growing(cap, amount) for cap in caps if cap is not None]
            both = [place, *close, *(amount - near for near in close)]
            finer = np.unique(np.concatenate(both))
            step = np.interp(finer, place, step)
            place = finer
        for cap, away in zip(caps, (place, amount - place), strict=True):
            if cap is not None:
                step = np.minimum(step, cap + GRADATION * away)
        return place, _graded(place, step, amount if self.sweep.is_closed else None)

    def _ends_at(self) -> list[tuple[Source | None, float]]:
        return [(self.ends[0], 0.0), (self.ends[1], self.sweep.amount)]

    def _sampled(self) -> tuple[np.ndarray, np.ndarray]:
        amount, n = self.sweep.amount, _SAMPLES
        if isinstance(self.everywhere, float):
            return np.array([0.0, amount]), np.full(2, self.everywhere)
        if isinstance(self.everywhere, UniformSize):
            even = self.everywhere.value / float(self.speed.max())
            return np.array([0.0, amount]), np.full(2, even)
        while True:
            place = np.linspace(0.0, amount, n)
            stride = -(-n * len(self.points) // _MOST_VALUES)
            step = np.array([self._least(self.everywhere, float(a), stride) for a in place])
            if step.min() >= 2.0 * amount / n or n >= _MOST_SAMPLES:
                return place, step
            n = 2 * n - 1

    def _least(self, size: Source, at: float, stride: int = 1) -> float:
        points, speed = self.points[::stride], self.speed[::stride]
        wanted = np.asarray(size(self.sweep.carried(points, at)))
        return float((wanted / speed).min())


def _asked(
    size: Any, sweep: SweptDomain, domain: Plc
) -> tuple[Source | None, tuple[Source | None, Source | None]]:
    """The size everywhere, and those of the two ends."""
    if size is None:
        return None, (None, None)
    if not isinstance(size, Mapping):
        return source_of_place(size, "size", domain), (None, None)
    base = start = end = None
    for key, value in size.items():
        source = source_of_place(value, f"size of {key!r}", domain)
        if key == "default":
            base = source if base is None else base
            continue
        names = find_names(key, [*domain.names, *domain.region_names])
        base = source if set(names).intersection(domain.region_names) else base
        start = source if sweep.start in names else start
        end = source if sweep.end in names else end
    return base, (start, end)


def _median_edge(flat: Mesh) -> float:
    corners = flat.points[next(iter(flat.cells.values()))]
    return float(np.median(np.sqrt(((corners[:, 1] - corners[:, 0]) ** 2).sum(axis=1))))


def _growing(first: float, amount: float) -> np.ndarray:
    """Places at which a step that grows from `first` does so by a fiftieth each."""
    most = np.log1p(GRADATION * amount / first)
    place = first / GRADATION * np.expm1(np.arange(0.0, most, 0.02))
    return np.asarray(place[place <= amount])


def _graded(place: np.ndarray, step: np.ndarray, period: float | None) -> np.ndarray:
    """The largest steps below those given that grow no faster than the gradation."""
    n = len(place)
    if period is not None:
        place = np.concatenate([place - period, place, place + period])
        step = np.tile(step, 3)
    rise = GRADATION * place
    step = np.minimum.accumulate(step - rise) + rise
    step = np.minimum.accumulate((step + rise)[::-1])[::-1] - rise
    return step if period is None else step[n : 2 * n]

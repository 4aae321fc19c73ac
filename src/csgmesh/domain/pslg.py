"""The planar straight-line graph: all that a mesher of the plane may know of a domain."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from csgmesh.domain.curves import Curves, cross
from csgmesh.domain.periodic import PeriodicSides
from csgmesh.domain.report import Report


class Oracle(Protocol):
    """What a mesher may ask of the domain beyond its boundary."""

    def region(self, points: np.ndarray) -> np.ndarray:
        """Region of each point, (n,) int64, -1 outside."""


@dataclass(frozen=True, eq=False, init=False)
class Pslg:
    """A planar straight-line graph whose segments know their names, regions and exact curves.

    `csgmesh.evaluate` makes one from a shape. The constructor makes one from a discretised boundary
    that comes from elsewhere.

    Parameters
    ----------
    points : (n, 2) array_like
        Coordinates.
    segments : (m, 2) array_like of int
        Point numbers; segments may meet at common points only.
    holes : (k, 2) array_like, optional
        A point in each hole. Without `holes` and `regions`, a loop inside a loop bounds a hole, a
        loop inside that an island, and so on.
    regions : mapping of str to (2,) or (k, 2) array_like, optional
        Points in each region; what holds none of them is outside.
    names : mapping of str to sequence of int, optional
        Names of boundaries, each with its segment numbers; a segment may have several. A segment
        without a name is called ``boundary``.

    Raises
    ------
    InputError
        If coordinates are not finite, points repeat, segments cross or end in the open, a number is
        out of range, or a hole or region point lies outside.

    Attributes
    ----------
    segment_curve : (m,) int64
        Exact curve of each segment in `curves`; -1 where the segment itself is exact.
    segment_interval : (m, 2) float64
        Parameters of the curve at both ends of each segment.
    segment_marker : (m,) int64
        Entry of `boundary_names`, each a tuple of all the names of a segment.
    segment_region : (m, 2) int64
        Regions on the left and right, -1 outside. The domain is on the left of an outer segment,
        the region of lower number on the left of an interface.
    point_marker : (n,) int64
        Entry of `boundary_names` for embedded points, -1 for others.
    periodic : tuple of PeriodicSides
        Sides that must be meshed alike; none in a domain of arrays.

    Examples
    --------
    >>> square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> square.areas()
    array([1.])
    """

    points: np.ndarray
    segments: np.ndarray
    segment_curve: np.ndarray
    segment_interval: np.ndarray
    segment_marker: np.ndarray
    segment_region: np.ndarray
    point_marker: np.ndarray
    boundary_names: tuple[tuple[str, ...], ...]
    region_names: tuple[str, ...]
    curves: Curves
    deviation: float
    snap: float
    report: Report
    oracle: Oracle | None
    periodic: tuple[PeriodicSides, ...]

    def __init__(
        self,
        points: Any,
        segments: Any,
        holes: Any = (),
        regions: Mapping[str, Any] | None = None,
        names: Mapping[str, Iterable[int]] | None = None,
    ) -> None:
        from csgmesh.domain.handmade import pslg_fields

        self._fill(pslg_fields(points, segments, holes, regions, names))

    @classmethod
    def build(cls, **values: Any) -> Pslg:
        """A Pslg of ready fields, not validated: for evaluation, tests and file readers."""
        pslg = cls.__new__(cls)
        n, m = len(values["points"]), len(values["segments"])
        defaults: dict[str, Any] = {
            "segment_curve": np.full(m, -1),
            "segment_interval": np.tile([0.0, 1.0], (m, 1)),
            "point_marker": np.full(n, -1),
            "region_names": ("domain",),
            "curves": Curves.empty(),
            "deviation": 0.0,
            "snap": 0.0,
            "report": Report(),
            "oracle": None,
            "periodic": (),
        }
        pslg._fill(defaults | values)
        return pslg

    def _fill(self, values: Mapping[str, Any]) -> None:
        integers = {"segments", "segment_curve", "segment_marker", "segment_region", "point_marker"}
        floats = {"points", "segment_interval"}
        for field in fields(self):
            value = values[field.name]
            if field.name in integers | floats:
                kind = np.int64 if field.name in integers else np.float64
                value = np.ascontiguousarray(value, dtype=kind).view()
                value.flags.writeable = False
            object.__setattr__(self, field.name, value)

    @property
    def dim(self) -> int:
        """2."""
        return 2

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_segments(self) -> int:
        """Number of segments."""
        return len(self.segments)

    @property
    def names(self) -> tuple[str, ...]:
        """All names of boundaries, each once, in the order of their markers."""
        return tuple(dict.fromkeys(n for names in self.boundary_names for n in names))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of the points' box, each (2,)."""
        return self.points.min(axis=0), self.points.max(axis=0)

    @cached_property
    def diagonal(self) -> float:
        """Length of the box's diagonal."""
        lo, hi = self.bounds()
        return float(np.hypot(*(hi - lo)))

    def chord_areas(self) -> np.ndarray:
        """Area of each region as its straight segments bound it, (n_regions,)."""
        a, b = (self.points[self.segments[:, k]] - self._centre() for k in (0, 1))
        return self._sum_sides(0.5 * cross(a, b))

    def areas(self) -> np.ndarray:
        """Exact area of each region, integrated over the exact curves, (n_regions,)."""
        a, b = (self.points[self.segments[:, k]] - self._centre() for k in (0, 1))
        terms = 0.5 * cross(a, b)
        bent = np.flatnonzero(self.segment_curve >= 0)
        if len(bent):
            begin, end = self.segment_interval[bent].T
            terms[bent] = self.curves.area_terms(
                self.segment_curve[bent], begin, end, self._centre()
            )
        return self._sum_sides(terms)

    def lengths(self) -> np.ndarray:
        """Exact length of each segment along its curve, (m,)."""
        out = np.hypot(*(self.points[self.segments[:, 1]] - self.points[self.segments[:, 0]]).T)
        bent = np.flatnonzero(self.segment_curve >= 0)
        if len(bent):
            begin, end = self.segment_interval[bent].T
            out[bent] = self.curves.lengths(self.segment_curve[bent], begin, end)
        return out

    def __repr__(self) -> str:
        regions, boundaries = (
            ", ".join(names[:6]) + (", …" if len(names) > 6 else "")
            for names in (self.region_names, self.names)
        )
        return (
            f"<Pslg: {self.n_points} points, {self.n_segments} segments, "
            f"regions {regions}; boundaries {boundaries}>"
        )

    def _centre(self) -> np.ndarray:
        lo, hi = self.bounds()
        return 0.5 * (lo + hi)

    def _sum_sides(self, terms: np.ndarray) -> np.ndarray:
        # Slivers are small differences of large areas: sum without rounding.
        region = np.concatenate([self.segment_region[:, 0], self.segment_region[:, 1]])
        signed = np.concatenate([terms, -terms])
        order = np.argsort(region, kind="stable")
        bounds = np.searchsorted(region[order], np.arange(len(self.region_names) + 1))
        signed = signed[order]
        return np.array([math.fsum(signed[i:j].tolist()) for i, j in pairwise(bounds.tolist())])


def marker_table(
    per_segment: Sequence[tuple[str, ...]],
) -> tuple[np.ndarray, tuple[tuple[str, ...], ...]]:
    """Number the distinct tuples of names by first appearance.

    Examples
    --------
    >>> marker_table([("a",), ("b",), ("a",)])
    (array([0, 1, 0]), (('a',), ('b',)))
    """
    table: dict[tuple[str, ...], int] = {}
    markers = np.array([table.setdefault(names, len(table)) for names in per_segment], np.int64)
    return markers, tuple(table)

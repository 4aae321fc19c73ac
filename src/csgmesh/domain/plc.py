"""The piecewise linear complex: all that a mesher of space may know of a domain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from csgmesh.domain.names import find_markers
from csgmesh.domain.pslg import Oracle
from csgmesh.domain.report import Report
from csgmesh.domain.surfaces import Surfaces
from csgmesh.domain.sweep import SweptDomain


@dataclass(frozen=True, eq=False, init=False)
class Plc:
    """A piecewise linear complex whose facets know their names, regions and exact surfaces.

    `csgmesh.evaluate` makes one from a solid.

    Attributes
    ----------
    points : (n, 3) float64
        On the exact surfaces of all facets around them.
    facets : (m, 3) int64
        Triangles, counterclockwise seen from outside their first region.
    facet_surface : (m,) int64
        Into `surfaces`. Facets of one flat or curved face have one number.
    facet_marker : (m,) int64
        Entry of `boundary_names`, each a tuple of all the names of a facet.
    facet_region : (m, 2) int64
        Regions behind and in front of each facet, -1 outside.
    boundary_names : tuple of tuple of str
    region_names : tuple of str
    surfaces : Surfaces
    deviation : float
        Largest distance of a facet from its exact surface.
    snap : float
        Distance below which points were merged.
    report : Report
    oracle : Oracle or None
    sweep : SweptDomain or None
        What sweeps the domain, if a planar one does.
    finer : callable or None
        The same domain with finer facets around places (k, 3), for those who find that facets do
        not meet there as the exact surfaces do.
    """

    points: np.ndarray
    facets: np.ndarray
    facet_surface: np.ndarray
    facet_marker: np.ndarray
    facet_region: np.ndarray
    boundary_names: tuple[tuple[str, ...], ...]
    region_names: tuple[str, ...]
    surfaces: Surfaces
    deviation: float
    snap: float
    report: Report
    oracle: Oracle | None
    sweep: SweptDomain | None
    finer: Callable[[np.ndarray], Plc] | None

    @classmethod
    def build(cls, **values: Any) -> Plc:
        """A Plc of ready fields, not validated."""
        plc = cls.__new__(cls)
        for field in fields(cls):
            value = values[field.name]
            if isinstance(value, np.ndarray):
                value = np.ascontiguousarray(value).view()
                value.flags.writeable = False
            object.__setattr__(plc, field.name, value)
        return plc

    @property
    def dim(self) -> int:
        """3."""
        return 3

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_facets(self) -> int:
        """Number of facets."""
        return len(self.facets)

    @property
    def names(self) -> tuple[str, ...]:
        """All names of boundaries, each once, in the order of their markers."""
        return tuple(dict.fromkeys(n for names in self.boundary_names for n in names))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of the points' box, each (3,)."""
        return self.points.min(axis=0), self.points.max(axis=0)

    @property
    def diagonal(self) -> float:
        """Length of the box's diagonal."""
        lo, hi = self.bounds()
        return float(np.sqrt(((hi - lo) ** 2).sum()))

    def facet_areas(self) -> np.ndarray:
        """Area of each flat facet, (m,)."""
        a, b, c = (self.points[self.facets[:, k]] for k in range(3))
        return 0.5 * np.sqrt((np.cross(b - a, c - a) ** 2).sum(axis=1))

    def area(self, name: str) -> float:
        """Area of the facets with a name, prefix or glob.

        Raises
        ------
        NameLookupError
            If nothing is called so.
        """
        marker = find_markers(name, self.boundary_names)
        return float(self.facet_areas()[np.isin(self.facet_marker, marker)].sum())

    def volumes(self) -> np.ndarray:
        """Volume of each region as its flat facets bound it, (n_regions,)."""
        lo, hi = self.bounds()
        a, b, c = (self.points[self.facets[:, k]] - 0.5 * (lo + hi) for k in range(3))
        terms = (a * np.cross(b, c)).sum(axis=1) / 6.0
        out = np.zeros(len(self.region_names))
        for side, sign in ((0, 1.0), (1, -1.0)):
            region = self.facet_region[:, side]
            np.add.at(out, region[region >= 0], sign * terms[region >= 0])
        return out

    @cached_property
    def _edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Edges (k, 2) with lower point first, and the facets that begin and end in each run."""
        pairs = self.facets[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        low, high = pairs.min(axis=1), pairs.max(axis=1)
        order = np.lexsort((high, low))
        new = (np.diff(low[order], prepend=-1) != 0) | (np.diff(high[order], prepend=-1) != 0)
        start = np.flatnonzero(new)
        edges = np.column_stack([low[order][start], high[order][start]])
        return edges, order // 3, start

    def feature_edges(self) -> np.ndarray:
        """Edges where different faces meet, or more than two facets, (k, 2).

        A face is all that lies on one exact surface between the same regions.
        """
        edges, facet, start = self._edges
        count = np.diff(np.append(start, len(facet)))
        face = np.column_stack([self.facet_surface, self.facet_marker, self.facet_region])
        own = face[facet]
        first = np.repeat(own[start], count, axis=0)
        differs = np.logical_or.reduceat((own != first).any(axis=1), start)
        return edges[differs | (count != 2)]

    def corners(self) -> np.ndarray:
        """Points where other than two feature edges meet, or two of different faces, (k,)."""
        edges = self.feature_edges()
        degree = np.bincount(edges.ravel(), minlength=len(self.points))
        return np.flatnonzero((degree != 0) & (degree != 2))

    def euler_characteristic(self) -> int:
        """Points less edges plus facets: 2 for a ball, 0 for a torus; handles take 2 away each."""
        return len(np.unique(self.facets)) - len(self._edges[0]) + len(self.facets)

    def __repr__(self) -> str:
        regions, boundaries = (
            ", ".join(names[:6]) + (", …" if len(names) > 6 else "")
            for names in (self.region_names, self.names)
        )
        return (
            f"<Plc: {self.n_points} points, {self.n_facets} facets, "
            f"regions {regions}; boundaries {boundaries}>"
        )

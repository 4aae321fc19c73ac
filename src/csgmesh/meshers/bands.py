"""Lattices between the level sets of a size: one for each band in which it hardly varies."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.background import Background
from csgmesh.meshers.lattice import (
    Blocks,
    Events,
    Frame,
    extent,
    is_coarse_enough,
    keep_from_boundary,
)
from csgmesh.meshers.subdivision import Subdivision

#: Lattice points nearer than this to a level set are left out (share of the size): then no
#: circumcircle, of radius 0.5774, reaches into another band, where another lattice may lie.
FROM_LEVEL = 0.578
#: Where sizes sink below this share of the smallest lattice's, it ends.
NEARLY = 0.95
#: Sizes of neighbouring lattices differ by a factor between these, such that a band is about so
#: many edges across. With the larger one a lattice's triangles are not yet too large for refinement
#: where sizes are smallest.
LEAST_STEP, MOST_STEP = 1.25, 1.5
EDGES_ACROSS = 10.0
#: Sizes that differ by a smaller factor share a lattice.
SAME_SIZE = 1.02
#: A band is left to refinement if it would hold fewer points, in all or for each edge along it.
FEWEST_POINTS = 100
ROWS_ACROSS = 3.5


@dataclass(frozen=True, eq=False)
class Levels:
    """Level sets of a size that is linear on the triangles of a coarse mesh.

    Attributes
    ----------
    values : (k,)
        Sizes, rising.
    chord : (n, 2, 2)
        Pieces of the level sets, smaller sizes on their left.
    of : (n,)
        The level of each, rising.
    rim : (m, 2)
        Vertices of the mesh's boundary edges, the domain on their left.
    xy, size : (p, 2), (p,)
        Of the mesh's vertices.
    """

    values: np.ndarray
    chord: np.ndarray
    of: np.ndarray
    rim: np.ndarray
    xy: np.ndarray
    size: np.ndarray

    @classmethod
    def of_mesh(cls, ground: Background, values: np.ndarray) -> Levels:
        """All pieces of some level sets."""
        corners, rim = ground.triangles()
        xy, size = ground.points.reshape(-1, 2), ground.size
        h = size[corners]
        least, most = (f(f(h[:, 0], h[:, 1]), h[:, 2]) for f in (np.minimum, np.maximum))
        first = np.searchsorted(values, least, side="right")
        count = np.searchsorted(values, most, side="right") - first
        at = np.repeat(np.arange(len(corners)), count)
        of = first[at] + np.arange(len(at)) - (np.cumsum(count) - count)[at]
        order = np.argsort(of, kind="stable")
        at, of = at[order], of[order]
        low = h[at] < values[of, None]
        after = np.roll(low, -1, axis=1)
        leaves = (low & ~after).argmax(axis=1)
        enters = (~low & after).argmax(axis=1)
        chord = np.empty((len(at), 2, 2))
        for end, edge in ((0, leaves), (1, enters)):
            a, b = corners[at, edge], corners[at, (edge + 1) % 3]
            chord[:, end] = crossing(xy, size, a, b, values[of])
        return cls(values, chord, of, rim, xy, size)

    def between(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Boundary of the band from level k to the next, and whether rows enter it there or leave.

        Beyond the last level the band has no end.
        """
        i, j, end = np.searchsorted(self.of, [k, k + 1, k + 2])
        low = self.values[k]
        high = self.values[k + 1] if k + 1 < len(self.values) else np.inf
        h = self.size[self.rim]
        a, b = self.rim[(h.max(axis=1) >= low) & (h.min(axis=1) < high)].T
        rim = np.stack([self._clipped(a, b, low, high), self._clipped(b, a, low, high)], axis=1)
        steps = np.concatenate([np.ones(j - i, np.int64), np.full(end - j + len(rim), -1)])
        return np.concatenate([self.chord[i:end], rim]), steps

    def _clipped(self, a: np.ndarray, b: np.ndarray, low: float, high: float) -> np.ndarray:
        """The ends a of edges a–b, moved to where their sizes are between low and high."""
        out, h = self.xy[a], self.size[a]
        for level, out_of in ((low, h < low), (high, h >= high)):
            at = np.flatnonzero(out_of)
            out[at] = crossing(self.xy, self.size, a[at], b[at], level)
        return out


def crossing(
    xy: np.ndarray, size: np.ndarray, a: np.ndarray, b: np.ndarray, level: np.ndarray | float
) -> np.ndarray:
    """Where edges a–b have a size; the same to the last bit from either side."""
    a, b = np.minimum(a, b), np.maximum(a, b)
    share = ((level - size[a]) / (size[b] - size[a]))[:, None]
    return (1.0 - share) * xy[a] + share * xy[b]


def lay_bands(
    domain: Pslg, cut: Subdivision, ground: Background, fixed: np.ndarray
) -> Blocks | None:
    """Lattices over a domain cut into pieces, as far as they are worth it.

    ground: the size all over the domain; fixed: sizes that hold on plateaus, where lattices are to
    have just these.
    """
    demand = Demand.of(ground)
    sizes = demand.lattices(fixed)
    limits = np.concatenate([NEARLY * sizes[:1], np.sqrt(sizes[1:] * sizes[:-1])])
    bands = [k for k in demand.worthwhile(limits) if is_coarse_enough(domain, sizes[k])]
    if not bands:
        return None
    levels = Levels.of_mesh(ground, limits)
    near = Near(cut)
    found = []
    for k in bands:
        size = float(sizes[k])
        ends, steps = levels.between(k)
        events = Events.over(Frame.of(domain, size), ends.reshape(-1, 2))
        n_level = int(np.diff(np.searchsorted(levels.of, [k, k + 2]))[0])
        events.keep_from_segments(ends[:n_level], steps[:n_level], FROM_LEVEL * size)
        events.keep_from_points(ends[:n_level].reshape(-1, 2), FROM_LEVEL * size)
        events.keep_from_segments(ends[n_level:], steps[n_level:], 0.0)
        keep_from_boundary(events, *near.box(ends.reshape(-1, 2), size))
        found.append(events.runs())
    return Blocks.together(found)


@dataclass(frozen=True, eq=False)
class Demand:
    """How many points each triangle of a coarse mesh asks for, its size, and how steep that is."""

    points: np.ndarray
    size: np.ndarray
    slope: np.ndarray

    @classmethod
    def of(cls, ground: Background) -> Demand:
        """Of a coarse mesh."""
        corners, _ = ground.triangles()
        xy, h = ground.points.reshape(-1, 2)[corners], ground.size[corners]
        u, v = xy[:, 1] - xy[:, 0], xy[:, 2] - xy[:, 0]
        du, dv = h[:, 1] - h[:, 0], h[:, 2] - h[:, 0]
        twice = np.maximum(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.finfo(float).tiny)
        slope = np.hypot(du * v[:, 1] - dv * u[:, 1], dv * u[:, 0] - du * v[:, 0]) / twice
        size = (h[:, 0] + h[:, 1] + h[:, 2]) / 3.0
        return cls(twice / (np.sqrt(3.0) * size**2), size, slope)

    def lattices(self, fixed: np.ndarray) -> np.ndarray:
        """Edge lengths of lattices, rising: the fixed ones, and steps between them."""
        least, most = float(self.size.min()), float(self.size.max())
        steep = float((self.points * self.slope).sum() / self.points.sum())
        step = np.log(min(max(np.exp(EDGES_ACROSS * steep), LEAST_STEP), MOST_STEP))
        kept = fixed[(fixed > least / SAME_SIZE) & (fixed < most * SAME_SIZE)]
        apart = [h for h in (least, most) if (np.abs(np.log(kept / h)) > np.log(SAME_SIZE)).all()]
        stops = np.log(np.unique(np.concatenate([kept, apart])))
        stops = stops[np.diff(stops, prepend=-np.inf) > np.log(SAME_SIZE)]
        parts = [
            np.linspace(a, b, max(round((b - a) / step), 1), endpoint=False)
            for a, b in pairwise(stops)
        ]
        return np.exp(np.concatenate([*parts, stops[-1:]]))

    def worthwhile(self, limits: np.ndarray) -> np.ndarray:
        """The bands between limits, counted, that are wide enough for a lattice.

        A level set is as long as the integral of the slope over the band, divided by the
        difference of the sizes on both sides.
        """
        n = len(limits)
        band = np.maximum(np.searchsorted(limits, self.size, side="right") - 1, 0)
        points = np.bincount(band, self.points, n)
        climb = np.bincount(band, self.points * self.slope * self.size, n)
        seam = climb / np.diff(limits, append=max(float(self.size.max()), 1.01 * limits[-1]))
        return np.flatnonzero((points > FEWEST_POINTS) & (points > ROWS_ACROSS * seam))


class Near:
    """The points and the pieces of a domain's boundary in the boxes of its parts."""

    def __init__(self, cut: Subdivision) -> None:
        self.points, self.ends = cut.points, cut.points[cut.ends]
        # Columns by themselves: comparing these is several times as fast as comparing pairs.
        self.columns = np.ascontiguousarray(cut.points.T)
        first, second = (self.columns[:, cut.ends[:, k]] for k in (0, 1))
        self.least, self.most = np.minimum(first, second), np.maximum(first, second)

    def box(self, within: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 2) and pieces (k, 2, 2) in the box of `within`, which reaches farther."""
        low, high = extent(within)
        low, high = low - reach, high + reach
        points = np.ones(len(self.points), bool)
        pieces = np.ones(len(self.ends), bool)
        for k in (0, 1):
            points &= (self.columns[k] > low[k]) & (self.columns[k] < high[k])
            pieces &= (self.most[k] > low[k]) & (self.least[k] < high[k])
        return self.points[points], self.ends[pieces]

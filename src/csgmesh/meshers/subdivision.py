"""The domain's segments cut into the pieces that a triangulation starts from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from csgmesh.domain.pslg import Pslg

#: Largest turn of a curve along a subsegment, in radians: below 60 degrees the curve lies inside
#: the subsegment's diametral circle, which then protects it.
LARGEST_TURN = np.radians(50.0)
SAMPLES = 9


@dataclass(frozen=True, eq=False)
class Subdivision:
    """Points, and subsegments between them.

    Attributes
    ----------
    points : (n, 2)
        The domain's points, then those that cut its segments.
    ends : (k, 2) int64
        Subsegments, along their segments.
    segment : (k,) int64
        The segment of each.
    interval : (k, 2) float64
        Parameters on the segment's exact curve; on [0, 1] along a segment without one.
    share : (k, 2) float64
        Begin and end as shares of the segment.
    """

    points: np.ndarray
    ends: np.ndarray
    segment: np.ndarray
    interval: np.ndarray
    share: np.ndarray

    @property
    def is_whole(self) -> np.ndarray:
        """Which subsegments are whole segments, (k,) bool."""
        return (self.share[:, 0] == 0.0) & (self.share[:, 1] == 1.0)

    def with_points(self, points: np.ndarray) -> Subdivision:
        """The same with more points (k, 2) at the end, which lie on no segment."""
        return replace(self, points=np.concatenate([self.points, points]))

    def cut(self, k: int, point: int, where: float) -> Subdivision:
        """Cut straight subsegment k at a point that lies on it, `where` of its way."""
        t0, t1 = self.interval[k]
        s0, s1 = self.share[k]
        t, s = t0 + where * (t1 - t0), s0 + where * (s1 - s0)
        ends, interval, share = self.ends.copy(), self.interval.copy(), self.share.copy()
        b = ends[k, 1]
        ends[k, 1], interval[k, 1], share[k, 1] = point, t, s
        return Subdivision(
            self.points,
            np.vstack([ends, [[point, b]]]),
            np.r_[self.segment, self.segment[k]],
            np.vstack([interval, [[t, t1]]]),
            np.vstack([share, [[s, s1]]]),
        )


#: Maps shares of segments, (k,) segments and (k,) shares, to other shares of them.
Spaced = Callable[[np.ndarray, np.ndarray], np.ndarray]


def subdivide(domain: Pslg, pieces: np.ndarray, spacing: Spaced | None = None) -> Subdivision:
    """Cut each segment into `pieces` (m,) parts on the exact curve.

    They are of equal parameter length, unless `spacing` moves their ends.
    """
    m = len(domain.segments)
    interval = np.where(
        domain.segment_curve[:, None] >= 0, domain.segment_interval, np.array([[0.0, 1.0]])
    )
    whole = np.tile([0.0, 1.0], (m, 1))
    if (pieces <= 1).all():
        return Subdivision(domain.points, domain.segments, np.arange(m), interval, whole)
    segment = np.repeat(np.arange(m), pieces)
    first = np.cumsum(pieces) - pieces
    step = np.arange(len(segment)) - first[segment]
    share = np.column_stack([step, step + 1]) / pieces[segment, None]
    is_last = step == pieces[segment] - 1
    if spacing is not None:
        end = np.where(is_last, 1.0, spacing(segment, share[:, 1]))
        share = np.column_stack([np.where(step == 0, 0.0, np.roll(end, 1)), end])
    t = (1.0 - share) * interval[segment, :1] + share * interval[segment, 1:]
    new = np.flatnonzero(~is_last)
    number = np.full(len(segment), -1)
    number[new] = len(domain.points) + np.arange(len(new))
    ends = np.column_stack([np.roll(number, 1), number])
    ends[first, 0] = domain.segments[:, 0]
    ends[is_last, 1] = domain.segments[:, 1]
    points = np.concatenate(
        [domain.points, points_on(domain, segment[new], t[new, 1], share[new, 1])]
    )
    return Subdivision(points, ends, segment, t, share)


def points_on(domain: Pslg, segment: np.ndarray, t: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Points of segments at parameters t of their exact curves."""
    a, b = (domain.points[domain.segments[segment, k]] for k in (0, 1))
    out = (1.0 - share[:, None]) * a + share[:, None] * b
    curve = domain.segment_curve[segment]
    bent = np.flatnonzero(curve >= 0)
    if len(bent):
        out[bent] = domain.curves.points(curve[bent], t[bent])
    return out


def pieces_by_turning(domain: Pslg) -> np.ndarray:
    """Parts of each segment such that no part of its curve turns by more than `LARGEST_TURN`."""
    pieces = np.ones(len(domain.segments), np.int64)
    bent = np.flatnonzero(domain.segment_curve >= 0)
    bent = bent[domain.curves.kind[domain.segment_curve[bent]] > 0]
    if not len(bent):
        return pieces
    curve = np.repeat(domain.segment_curve[bent], SAMPLES)
    at = np.linspace(0.0, 1.0, SAMPLES)
    t0, t1 = domain.segment_interval[bent].T
    t = (t0[:, None] * (1.0 - at) + t1[:, None] * at).ravel()
    d = domain.curves.derivatives(curve, t).reshape(len(bent), SAMPLES, 2)
    heading = np.arctan2(d[..., 1], d[..., 0])
    turns = np.mod(np.diff(heading, axis=1) + np.pi, 2 * np.pi) - np.pi
    # The parts are of equal parameter length: the sharpest of them decides.
    sharpest = np.abs(turns).max(axis=1) * (SAMPLES - 1)
    pieces[bent] = np.ceil(sharpest / LARGEST_TURN - 1e-9).astype(np.int64)
    return np.maximum(pieces, 1)

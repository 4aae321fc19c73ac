"""Which exact curve of a domain lies under each facet, from coordinates alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.curves import Curves
from csgmesh.domain.pslg import Pslg
from csgmesh.spatial import Boxes

#: Two ends on a curve are the same place if their parameters differ by less than this share of the
#: curve's extent (so that the two ends of a closed curve stay apart) and their points by less than
#: a few tolerances.
SAME_PARAMETER = 1e-6
_SAME_PLACE = 8.0
#: How many times its own length a segment is looked beyond for the ends of a facet.
NEARBY = 2.0


@dataclass(frozen=True, eq=False)
class Track:
    """The segments of a domain as intervals on curves, sorted along them.

    Attributes
    ----------
    curves : Curves
        The domain's, and behind them a line for each segment that is its own curve.
    curve : (m,) int64
        Of each segment.
    interval : (m, 2) float64
        At each segment's start and end.
    extent : (n_curves, 2) float64
        Smallest and largest parameter on each curve.
    """

    curves: Curves
    curve: np.ndarray
    interval: np.ndarray
    extent: np.ndarray

    @staticmethod
    def of(domain: Pslg) -> Track:
        """The track of a domain."""
        straight = np.flatnonzero(domain.segment_curve < 0)
        ends = domain.points[domain.segments[straight]]
        curves = Curves.concatenate([domain.curves, Curves.lines(ends[:, 0], ends[:, 1])])
        curve, interval = domain.segment_curve.copy(), domain.segment_interval.copy()
        curve[straight] = len(domain.curves) + np.arange(len(straight))
        interval[straight] = [0.0, 1.0]
        extent = np.tile([np.inf, -np.inf], (len(curves), 1))
        np.minimum.at(extent[:, 0], curve, interval.min(axis=1))
        np.maximum.at(extent[:, 1], curve, interval.max(axis=1))
        return Track(curves, curve, interval, extent)


@dataclass(frozen=True, eq=False)
class Matching:
    """Where each facet lies on the domain's curves.

    Attributes
    ----------
    track : Track
    curve : (f,) int64
        Into ``track.curves``; -1 where both ends lie on no common curve.
    interval : (f, 2) float64
        Parameters of the facet's two ends.
    distance : (f, 2) float64
        Distances of the two ends from the curve.
    is_vertex : (f, 2) bool
        Which ends are vertices of the domain.
    segment : (f,) int64
        The domain's segment that holds the facet's middle, -1 for none.
    is_reversed : (f,) bool
        Whether the facet runs against its segment.
    """

    track: Track
    curve: np.ndarray
    interval: np.ndarray
    distance: np.ndarray
    is_vertex: np.ndarray
    segment: np.ndarray
    is_reversed: np.ndarray


def match_facets(domain: Pslg, ends: np.ndarray, tolerance: float) -> Matching:
    """Find the curve under each facet.

    Parameters
    ----------
    domain : Pslg
    ends : (f, 2, 2) float64
        Coordinates of the facets' start and end points.
    tolerance : float
        How far an end may be from its curve.
    """
    track = Track.of(domain)
    n = len(ends)
    curve = np.full(n, -1)
    interval, distance = np.zeros((n, 2)), np.zeros((n, 2))
    is_vertex = np.zeros((n, 2), bool)
    boxes = _boxes(domain, track, tolerance)
    facet, segment = _holding(boxes, ends.mean(axis=1))
    found = _within_segments(domain, track, ends, facet, segment, tolerance)
    chosen, which = _best(track, ends, facet, *found[:2], track.curve[segment])
    curve[chosen] = track.curve[segment[which]]
    interval[chosen], distance[chosen] = found[0][which], found[1][which]
    is_vertex[chosen] = found[2][which]
    # A mesh of a finer or coarser outline may have facets that span vertices of this one. They are
    # looked for near the segment first: along hairpins a whole curve has too many near places.
    for is_near in (True, False):
        rest = np.flatnonzero(curve < 0)
        if not len(rest):
            break
        facet, segment = _holding(boxes, ends[rest, 0])
        facet = rest[facet]
        if not is_near:
            pairs = np.stack([facet, track.curve[segment], segment], axis=1)
            first = np.unique(pairs[:, :2], axis=0, return_index=True)[1]
            facet, segment = pairs[first, 0], pairs[first, 2]
        on = track.curve[segment]
        reach = track.extent[on].copy()
        if is_near:
            lo, hi = np.sort(track.interval[segment], axis=1).T
            span = NEARBY * (hi - lo)
            reach = np.clip(np.stack([lo - span, hi + span], axis=1), reach[:, :1], reach[:, 1:])
        t, d = _within_curves(track, ends[facet], on, reach)
        good = np.flatnonzero((d <= tolerance).all(axis=1))
        chosen, which = _best(track, ends, facet[good], t[good], d[good], on[good])
        which = good[which]
        curve[chosen], interval[chosen], distance[chosen] = on[which], t[which], d[which]
    segment, is_reversed = _segments_under(track, curve, interval)
    return Matching(track, curve, interval, distance, is_vertex, segment, is_reversed)


def _boxes(domain: Pslg, track: Track, tolerance: float) -> Boxes | None:
    """Boxes that hold each segment and its curve piece; None for no segments."""
    if not len(track.curve):
        return None
    chord = domain.points[domain.segments]
    lo, hi = chord.min(axis=1), chord.max(axis=1)
    pad = np.zeros(len(lo))
    for share in (0.25, 0.5, 0.75):
        t = track.interval @ [1 - share, share]
        p = track.curves.points(track.curve, t)
        lo, hi = np.minimum(lo, p), np.maximum(hi, p)
        middle = (1 - share) * chord[:, 0] + share * chord[:, 1]
        pad = np.maximum(pad, np.hypot(*(p - middle).T))
    pad = (pad + tolerance)[:, None]
    return Boxes(lo - pad, hi + pad)


def _holding(boxes: Boxes | None, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a point and a segment whose box holds it."""
    if boxes is None or not len(points):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    pairs = boxes.overlapping(points, points)
    return pairs[:, 0], pairs[:, 1]


def _within_segments(
    domain: Pslg,
    track: Track,
    ends: np.ndarray,
    facet: np.ndarray,
    segment: np.ndarray,
    tolerance: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parameters and distances of facets' ends on segments' curves; infinite where off them."""
    t, d = np.zeros((len(facet), 2)), np.zeros((len(facet), 2))
    is_vertex = np.zeros((len(facet), 2), bool)
    on = track.curve[segment]
    for side in (0, 1):
        p = ends[facet, side]
        t[:, side] = track.curves.project(on, p, *track.interval[segment].T)
        for end in (0, 1):
            # A vertex of the domain is on its segments' curves by their intervals, also where
            # merging has moved it by the snap distance.
            vertex = domain.points[domain.segments[segment, end]]
            same = np.hypot(*(p - vertex).T) <= tolerance
            t[same, side] = track.interval[segment[same], end]
            is_vertex[same, side] = True
        d[:, side] = np.hypot(*(track.curves.points(on, t[:, side]) - p).T)
    off = ((d > tolerance) & ~is_vertex).any(axis=1) | (t[:, 0] == t[:, 1])
    d[off] = np.inf
    return t, d, is_vertex


def _within_curves(
    track: Track, ends: np.ndarray, on: np.ndarray, reach: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Parameters and distances of facets' ends on curves, within reach (k, 2) of the parameters.

    The two ends lie on both sides of the middle, which tells the two ends of a closed curve apart.
    """
    lo, hi = reach.T
    middle = _project_onto_halves(track, on, ends.mean(axis=1), lo, hi)
    options = []
    for first, second in (((lo, middle), (middle, hi)), ((middle, hi), (lo, middle))):
        t = np.stack(
            [
                track.curves.project(on, ends[:, 0], *first),
                track.curves.project(on, ends[:, 1], *second),
            ],
            axis=1,
        )
        gap = [track.curves.points(on, t[:, k]) - ends[:, k] for k in (0, 1)]
        options.append((t, np.stack([np.hypot(*g.T) for g in gap], axis=1)))
    (t, d), (other_t, other_d) = options
    better = other_d.max(axis=1) < d.max(axis=1)
    return np.where(better[:, None], other_t, t), np.where(better[:, None], other_d, d)


def _project_onto_halves(
    track: Track, on: np.ndarray, points: np.ndarray, lo: np.ndarray, hi: np.ndarray
) -> np.ndarray:
    """Nearest parameters, also where a closed curve's two ends are equally near."""
    half = 0.5 * (lo + hi)
    t = track.curves.project(on, points, lo, half)
    s = track.curves.project(on, points, half, hi)
    t_gap, s_gap = (track.curves.points(on, x) - points for x in (t, s))
    return np.where(np.hypot(*s_gap.T) < np.hypot(*t_gap.T), s, t)


def _best(
    track: Track,
    ends: np.ndarray,
    facet: np.ndarray,
    t: np.ndarray,
    d: np.ndarray,
    on: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Facets with a candidate, and its number: that whose curve bends least away from the chord."""
    good = np.flatnonzero(np.isfinite(d).all(axis=1))
    middle = track.curves.points(on[good], t[good].mean(axis=1))
    bend = np.hypot(*(middle - ends[facet[good]].mean(axis=1)).T)
    order = np.lexsort((on[good], bend, facet[good]))
    chosen, first = np.unique(facet[good][order], return_index=True)
    return chosen, good[order[first]]


def _segments_under(
    track: Track, curve: np.ndarray, interval: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The segment that holds each facet's middle, and whether the facet runs against it."""
    segment = segments_at(track, curve, interval.mean(axis=1))
    if not len(track.curve):
        return segment, np.zeros(len(segment), bool)
    along = (track.interval[:, 1] - track.interval[:, 0])[segment]
    return segment, (segment >= 0) & (along * (interval[:, 1] - interval[:, 0]) < 0)


def segments_at(track: Track, curve: np.ndarray, t: np.ndarray) -> np.ndarray:
    """The segment at each place on a curve, -1 for none, (k,)."""
    if not len(track.curve):
        return np.full(len(curve), -1)
    lo, hi = track.interval.min(axis=1), track.interval.max(axis=1)
    order = np.lexsort((lo, track.curve))
    at = ranks(track.curve[order], lo[order], curve, t) - 1
    segment = order[np.maximum(at, 0)]
    held = (at >= 0) & (curve >= 0) & (track.curve[segment] == curve) & (t <= hi[segment])
    return np.where(held, segment, -1)


def ranks(
    curve: np.ndarray, t: np.ndarray, query_curve: np.ndarray, query_t: np.ndarray
) -> np.ndarray:
    """How many of the sorted places (curve, t) come before or at each query, (k,)."""
    n = len(curve)
    is_query = np.r_[np.zeros(n, bool), np.ones(len(query_t), bool)]
    order = np.lexsort((is_query, np.r_[t, query_t], np.r_[curve, query_curve]))
    before = np.cumsum(~is_query[order])
    out = np.empty(n + len(query_t), np.int64)
    out[order] = before
    return out[n:]


@dataclass(frozen=True, eq=False)
class Spans:
    """Intervals on curves, sorted along them and joined where they meet.

    Attributes
    ----------
    order : (k,) int64
        The intervals sorted.
    first : (s,) int64
        Place in `order` of the first interval of each span.
    curve, lo, hi : (s,)
        The spans.
    overlapping : (o,) int64
        Intervals that reach back over the one before them.
    """

    order: np.ndarray
    first: np.ndarray
    curve: np.ndarray
    lo: np.ndarray
    hi: np.ndarray
    overlapping: np.ndarray


def join(track: Track, curve: np.ndarray, interval: np.ndarray, tolerance: float) -> Spans:
    """Join intervals on curves that follow each other."""
    lo, hi = interval.min(axis=1), interval.max(axis=1)
    order = np.lexsort((hi, lo, curve))
    c, lo, hi = curve[order], lo[order], hi[order]
    same_curve = c[1:] == c[:-1]
    meets = same_curve & same_place(track, c[1:], lo[1:], hi[:-1], tolerance)
    overlaps = same_curve & ~meets & (lo[1:] < hi[:-1])
    starts = np.flatnonzero(np.r_[True, ~(meets | overlaps)]) if len(c) else np.zeros(0, np.int64)
    reach = np.maximum.reduceat(hi, starts) if len(c) else hi
    return Spans(order, starts, c[starts], lo[starts], reach, order[1:][overlaps])


def same_place(
    track: Track, curve: np.ndarray, t: np.ndarray, s: np.ndarray, tolerance: float
) -> np.ndarray:
    """Whether parameters `t` and `s` mean the same place on curves."""
    extent = np.diff(track.extent[curve], axis=1)[:, 0]
    gap = track.curves.points(curve, t) - track.curves.points(curve, s)
    return (np.abs(t - s) <= SAME_PARAMETER * extent) & (
        np.hypot(*gap.T) <= _SAME_PLACE * tolerance
    )

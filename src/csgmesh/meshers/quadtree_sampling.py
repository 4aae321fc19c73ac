"""Vertices along the domain's curves, as far apart as the leaves of a tree are large."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import graphs, kernels
from csgmesh.domain.curves import ARC
from csgmesh.domain.input_angles import SharpCorners
from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.subdivision import pieces_by_turning, points_on
from csgmesh.tree import LinearTree

#: Longest piece over which the spacing is taken to be the same, as a share of the leaf there.
FINEST = 0.5
#: Pieces that one is cut into at most in one round.
MOST_PIECES = 64
#: Rounds in which strands are cut more finely until their chords keep to the deviation.
ROUNDS = 12
CLOSER = 1.3
#: What halved chords may stray, as a share of what even curves would let them.
UNEVEN = 0.85
#: A point is taken to lie no further across the root than this.
INSIDE = 1 - 1e-12
#: Share of its shortest strand that the shell of a sharp corner may take.
SHELL = 0.45


@dataclass(frozen=True, eq=False)
class Samples:
    """The boundary of a mesh: vertices on exact curves, and the edges between them.

    Attributes
    ----------
    points : (n, 2) float64
        First those of the domain's points that are kept, in their order, then new ones.
    kept : (k,) int64
        Which of the domain's points are kept.
    ends : (m, 2) int64
    segment : (m,) int64
        A segment of the domain with the marker, the regions and the curve of each edge.
    interval : (m, 2) float64
        Parameters on the curve.
    """

    points: np.ndarray
    kept: np.ndarray
    ends: np.ndarray
    segment: np.ndarray
    interval: np.ndarray


class Strands:
    """The domain's segments joined to strands between vertices that have to stay.

    A vertex stays unless one smooth curve goes on through it, with the same names and regions.

    Parameters
    ----------
    domain : Pslg
    rigid : (m,) bool
        Segments whose vertices stay in any case.
    parts : int
        Into how many parts each edge along a curve will be cut afterwards.
    """

    def __init__(self, domain: Pslg, rigid: np.ndarray, parts: int) -> None:
        self.domain, self.parts = domain, parts
        m, n = domain.n_segments, domain.n_points
        first, second, self.is_fixed = _joints(domain, rigid)
        count, label = graphs.components(m, first, second)
        travel = domain.segment_interval[:, 1] - domain.segment_interval[:, 0]
        along = domain.segment_interval[:, 0] * np.sign(travel)
        #: Segments in the order of their strands, and the strand of each.
        self.order = np.lexsort((along, label))
        self.strand = label[self.order]
        self.begin = np.searchsorted(self.strand, np.arange(count))
        self.end = np.r_[self.begin[1:], m]
        self.is_fixed[domain.segments[self.order[self.begin], 0]] = True
        self.is_fixed[domain.segments[self.order[self.end - 1], 1]] = True
        self.is_bent = bent_segments(domain)
        self.closer = np.ones(count)
        used = np.zeros(n, bool)
        used[domain.segments] = True
        self.is_fixed |= domain.point_marker >= 0
        self.is_fixed &= used | (domain.point_marker >= 0)

    def sampled(self, tree: LinearTree, corners: SharpCorners) -> Samples:
        """Vertices along all strands; chords keep to the domain's deviation."""
        pieces = self._pieces(tree)
        for _ in range(ROUNDS):
            samples = self._placed(pieces, tree, corners)
            far = self._strays(samples)
            if not far.any():
                break
            of_segment = np.empty(self.domain.n_segments, np.int64)
            of_segment[self.order] = self.strand
            self.closer[np.unique(of_segment[samples.segment[far]])] *= CLOSER
        return samples

    def _strays(self, samples: Samples) -> np.ndarray:
        """Edges whose exact curve is further away than the domain allows."""
        domain = self.domain
        out = np.zeros(len(samples.ends), bool)
        bent = np.flatnonzero(self.is_bent[samples.segment])
        if domain.deviation <= 0 or not len(bent):
            return out
        # Half a chord strays a quarter as far, or a little more where the curve bends unevenly.
        allowed = domain.deviation if self.parts == 1 else UNEVEN * self.parts**2 * domain.deviation
        a, b = (samples.points[samples.ends[bent, k]] for k in (0, 1))
        chord = b - a
        length = np.maximum(np.hypot(*chord.T), np.finfo(float).tiny)
        for share in (0.25, 0.5, 0.75):
            t = samples.interval[bent] @ [1 - share, share]
            arm = domain.curves.points(domain.segment_curve[samples.segment[bent]], t) - a
            away = np.abs(chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]) / length
            out[bent] |= away > allowed
        return out

    def _pieces(self, tree: LinearTree) -> np.ndarray:
        """Rows (segment, share at begin, share at end, leaf size) of pieces no leaf is half of."""
        domain = self.domain
        length = domain.lengths()
        segment = self.order.copy()
        low, high = np.zeros(len(segment)), np.ones(len(segment))
        while True:
            middle = 0.5 * (low + high)
            size = leaf_sizes(tree, self._points(segment, middle))
            wish = np.ceil(length[segment] * (high - low) / (FINEST * size) - 1e-9)
            parts = np.clip(wish, 1, MOST_PIECES).astype(np.int64)
            if (parts == 1).all():
                return np.column_stack([segment, low, high, size])
            segment = np.repeat(segment, parts)
            step = np.arange(len(segment)) - np.repeat(np.cumsum(parts) - parts, parts)
            width, start = np.repeat((high - low) / parts, parts), np.repeat(low, parts)
            low, high = start + step * width, start + (step + 1) * width

    def _points(self, segment: np.ndarray, share: np.ndarray) -> np.ndarray:
        return points_on(self.domain, segment, self._parameters(segment, share), share)

    def _parameters(self, segment: np.ndarray, share: np.ndarray) -> np.ndarray:
        t0, t1 = self.domain.segment_interval[segment].T
        return (1.0 - share) * t0 + share * t1

    def _placed(self, pieces: np.ndarray, tree: LinearTree, corners: SharpCorners) -> Samples:
        domain = self.domain
        segment = pieces[:, 0].astype(np.int64)
        low, high, size = pieces[:, 1:].T
        length = domain.lengths()
        part = length[segment] * (high - low)
        strand = np.empty(domain.n_segments, np.int64)
        strand[self.order] = self.strand
        # A chord is never much longer than those that the domain found necessary.
        spacing = (
            np.where(self.is_bent[segment], np.minimum(size, self.parts * length[segment]), size)
            / self.closer[strand[segment]]
        )
        turning = pieces_by_turning(domain)[segment] / length[segment]
        density = np.maximum(1.0 / spacing, np.where(turning * length[segment] > 1, turning, 0.0))
        cumulative = np.r_[0.0, np.cumsum(part * density)]
        way = np.r_[0.0, np.cumsum(part)]
        first = np.flatnonzero(np.r_[True, strand[segment[1:]] != strand[segment[:-1]]])
        last = np.r_[first[1:], len(segment)]
        shell = self._shells(tree, corners, way[last] - way[first])
        cuts = self._cuts(first, last, cumulative, way, shell)
        # Between two cuts, equal steps of the integral of 1 / spacing.
        begin, total = cuts[:, :3].ravel(), np.diff(cuts, axis=1).ravel()
        row = np.repeat(np.arange(len(first)), 3)
        whole = total > 1e-9
        begin, total, row = begin[whole], total[whole], row[whole]
        n = np.maximum(np.rint(total), 1).astype(np.int64)
        n = self._enough(n, row, segment, first, last)
        at = np.repeat(begin, n) + (np.arange(n.sum()) - np.repeat(np.cumsum(n) - n, n)) * (
            np.repeat(total / n, n)
        )
        return self._assembled(at, np.repeat(row, n), pieces, cumulative, first, last)

    def _enough(
        self,
        n: np.ndarray,
        row: np.ndarray,
        segment: np.ndarray,
        first: np.ndarray,
        last: np.ndarray,
    ) -> np.ndarray:
        """At least three edges along a closed strand, two along a bent one that is one piece."""
        domain = self.domain
        start = domain.segments[segment[first], 0]
        stop = domain.segments[segment[last - 1], 1]
        count = np.bincount(row, n, len(first))
        least = np.where(start == stop, 3, np.where(self.is_bent[segment[first]], 2, 1))
        short = np.flatnonzero((count < least)[row])
        n = n.copy()
        n[short] = np.maximum(n[short], least[row[short]])
        return n

    def _shells(self, tree: LinearTree, corners: SharpCorners, length: np.ndarray) -> np.ndarray:
        """Distance from its begin and end at which each strand has a vertex, 0 for none, (k, 2)."""
        domain = self.domain
        out = np.zeros((len(self.begin), 2))
        if not len(corners.vertex):
            return out
        of_vertex = np.full(domain.n_points, np.inf)
        of_vertex[corners.vertex] = leaf_sizes(tree, domain.points[corners.vertex])
        edges = self.order[self.begin], self.order[self.end - 1]
        sharp = [corners.is_sharp_end[edge, k] for k, edge in enumerate(edges)]
        vertex = [domain.segments[edge, k] for k, edge in enumerate(edges)]
        for is_sharp, v in zip(sharp, vertex, strict=True):
            np.minimum.at(of_vertex, v[is_sharp], SHELL * length[is_sharp])
        for k in (0, 1):
            out[sharp[k], k] = of_vertex[vertex[k][sharp[k]]]
        return out

    def _cuts(
        self,
        first: np.ndarray,
        last: np.ndarray,
        cumulative: np.ndarray,
        way: np.ndarray,
        shell: np.ndarray,
    ) -> np.ndarray:
        """Begin, end of the first shell, begin of the last one, end of each strand, (k, 4)."""
        begin, end = way[first], way[last]
        there = np.column_stack([begin, begin + shell[:, 0], end - shell[:, 1], end])
        cuts = np.interp(there.ravel(), way, cumulative).reshape(-1, 4)
        cuts[:, 0], cuts[:, 3] = cumulative[first], cumulative[last]
        return cuts

    def _assembled(
        self,
        at: np.ndarray,
        row: np.ndarray,
        pieces: np.ndarray,
        cumulative: np.ndarray,
        first: np.ndarray,
        last: np.ndarray,
    ) -> Samples:
        domain = self.domain
        piece = np.clip(
            np.searchsorted(cumulative, at, side="right") - 1, first[row], last[row] - 1
        )
        part = cumulative[piece + 1] - cumulative[piece]
        within = np.clip((at - cumulative[piece]) / part, 0.0, 1.0)
        segment = pieces[piece, 0].astype(np.int64)
        share = pieces[piece, 1] + within * (pieces[piece, 2] - pieces[piece, 1])
        is_first = np.r_[True, row[1:] != row[:-1]]
        kept = np.flatnonzero(self.is_fixed)
        number = np.full(domain.n_points, -1)
        number[kept] = np.arange(len(kept))
        new = np.flatnonzero(~is_first)
        t = self._parameters(segment, share)
        points = np.concatenate(
            [domain.points[kept], points_on(domain, segment[new], t[new], share[new])]
        )
        vertex = np.empty(len(at), np.int64)
        vertex[new] = len(kept) + np.arange(len(new))
        vertex[is_first] = number[domain.segments[segment[is_first], 0]]
        t[is_first] = domain.segment_interval[segment[is_first], 0]
        stop = self.order[self.end - 1][row]
        is_last = np.r_[row[1:] != row[:-1], True]
        after = np.where(is_last, number[domain.segments[stop, 1]], np.roll(vertex, -1))
        t_after = np.where(is_last, domain.segment_interval[stop, 1], np.roll(t, -1))
        return Samples(
            points, kept, np.column_stack([vertex, after]), segment, np.column_stack([t, t_after])
        )


def bent_segments(domain: Pslg) -> np.ndarray:
    """Which segments stand for pieces of true curves, (m,) bool."""
    out = domain.segment_curve >= 0
    out[out] = domain.curves.kind[domain.segment_curve[out]] > 0
    return out


def leaves_at(tree: LinearTree, points: np.ndarray) -> np.ndarray:
    """Leaf at each point; what sticks out of the root by a rounding belongs to a leaf beside it."""
    inside = np.clip(points, tree.lo, tree.lo + INSIDE * tree.extent)
    leaf = np.empty(len(points), np.int64)
    kernels.find_leaves(tree.key, inside.reshape(-1), tree.unit, leaf)
    return leaf


def leaf_sizes(tree: LinearTree, points: np.ndarray) -> np.ndarray:
    """Larger side of the leaf at each point."""
    level = tree.level[leaves_at(tree, points)]
    return tree.extent.max() * np.exp2(-level.astype(float))


def _joints(domain: Pslg, rigid: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of segments that one smooth curve runs through, and the vertices that stay."""
    n, m = domain.n_points, domain.n_segments
    degree = np.bincount(domain.segments.ravel(), minlength=n)
    into, out_of = np.full(n, -1), np.full(n, -1)
    into[domain.segments[:, 1]] = np.arange(m)
    out_of[domain.segments[:, 0]] = np.arange(m)
    at = np.flatnonzero((degree == 2) & (into >= 0) & (out_of >= 0) & (domain.point_marker < 0))
    f, g = into[at], out_of[at]
    curve, t = domain.segment_curve, domain.segment_interval
    same = (f != g) & (curve[f] >= 0) & (curve[f] == curve[g]) & ~rigid[f] & ~rigid[g]
    same &= (t[f, 1] == t[g, 0]) & ((t[f, 1] - t[f, 0]) * (t[g, 1] - t[g, 0]) > 0)
    same &= domain.segment_marker[f] == domain.segment_marker[g]
    same &= (domain.segment_region[f] == domain.segment_region[g]).all(axis=1)
    is_fixed = np.ones(n, bool)
    is_fixed[at[same]] = False
    return f[same], g[same], is_fixed


def folded(domain: Pslg, samples: Samples) -> np.ndarray:
    """Segments, (m,) bool, of curves whose other side is nearer to some edge than its own."""
    out = np.zeros(domain.n_segments, bool)
    curve = domain.segment_curve[samples.segment]
    at = np.flatnonzero(curve >= 0)
    at = at[domain.curves.kind[curve[at]] > ARC]
    if not len(at):
        return out
    used = np.flatnonzero(domain.segment_curve >= 0)
    extent = np.tile([np.inf, -np.inf], (len(domain.curves), 1))
    np.minimum.at(
        extent[:, 0], domain.segment_curve[used], domain.segment_interval[used].min(axis=1)
    )
    np.maximum.at(
        extent[:, 1], domain.segment_curve[used], domain.segment_interval[used].max(axis=1)
    )
    middle = samples.points[samples.ends[at]].mean(axis=1)
    t = domain.curves.project(curve[at], middle, *extent[curve[at]].T)
    lo, hi = np.sort(samples.interval[at], axis=1).T
    lost = curve[at[(t < lo) | (t > hi)]]
    out[used] = np.isin(domain.segment_curve[used], lost)
    return out

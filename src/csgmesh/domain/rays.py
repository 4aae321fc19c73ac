"""Which segment a ray straight up meets first: how points and loops find their faces."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from csgmesh.spatial import Boxes

#: Heights of segments above a point that differ by less than this share of the largest coordinate
#: are compared exactly: the heights are interpolated and may be a few roundings off.
_TIE_SHARE = 1e-14


class UpwardRays:
    """Segments that meet at common ends only, searchable from below.

    A ray counts as running just right of its point, so that it never meets a vertex or an upright
    segment.

    Parameters
    ----------
    points : (n, 2) float64
    segments : (m, 2) int64

    Examples
    --------
    >>> gable = np.array([[0.0, 2.0], [4.0, 2.0], [4.0, 3.0]])
    >>> rays = UpwardRays(gable, np.array([[1, 0], [0, 2]]))
    >>> rays.first(np.array([[1.0, 0.0], [1.0, 2.1], [5.0, 0.0]]))
    array([ 0,  1, -1])
    """

    def __init__(self, points: np.ndarray, segments: np.ndarray) -> None:
        x = points[segments, 0]
        self._number = np.flatnonzero(x[:, 0] != x[:, 1])
        rightward = (x[:, 0] < x[:, 1])[self._number, None]
        ends = np.where(rightward, segments[self._number], segments[self._number, ::-1])
        self._points, self._left, self._right = points, ends[:, 0], ends[:, 1]
        a, b = points[self._left], points[self._right]
        lo, hi = np.minimum(a, b), np.maximum(a, b)
        self._boxes = Boxes(lo, hi)
        self._top = float(points[:, 1].max())
        spread = hi.max(axis=0) - lo.min(axis=0)
        # About four segments to a window, and at most some dozen widenings.
        self._reach = max(4 * float(np.sqrt(spread[0] * spread[1] / len(a))), 1e-4 * spread[1])
        self._tie = _TIE_SHARE * float(np.abs(points).max())

    def first(
        self,
        starts: np.ndarray,
        group: np.ndarray | None = None,
        segment_group: np.ndarray | None = None,
    ) -> np.ndarray:
        """The number of the first segment above each start or through it, -1 for none, (k,).

        Parameters
        ----------
        starts : (k, 2) float64
        group : (k,) int64, optional
            Segments of the same group as the start, by `segment_group` (m,), are not seen.
        """
        found = np.full(len(starts), -1)
        waiting = np.arange(len(starts))
        reach = self._reach
        while len(waiting):
            low = starts[waiting]
            row, k = self._boxes.overlapping(low, low + np.array([0.0, reach])).T
            start = waiting[row]
            if group is not None and segment_group is not None:
                other = segment_group[self._number[k]] != group[start]
                start, k = start[other], k[other]
            start, k, height = self._lowest_above(starts, start, k)
            # A box may be met whose segment passes above the window: only what lies in it counts.
            over = starts[:, 1] + reach >= self._top
            settled = (height <= starts[start, 1] + reach) | over[start]
            found[start[settled]] = self._number[k[settled]]
            waiting = waiting[~over[waiting] & (found[waiting] < 0)]
            reach *= 2
        return found

    def _lowest_above(
        self, starts: np.ndarray, start: np.ndarray, k: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of (start, segment) pairs the lowest above each start, with its height there."""
        x = starts[start, 0]
        a, b = self._points[self._left[k]], self._points[self._right[k]]
        stabbed = (a[:, 0] <= x) & (x < b[:, 0])
        start, k, x, a, b = start[stabbed], k[stabbed], x[stabbed], a[stabbed], b[stabbed]
        above = sides(a, b, starts[start]) <= 0
        start, k, x, a, b = start[above], k[above], x[above], a[above], b[above]
        height = a[:, 1] + (b[:, 1] - a[:, 1]) * ((x - a[:, 0]) / (b[:, 0] - a[:, 0]))
        order = np.lexsort((height, start))
        start, k, height = start[order], k[order], height[order]
        first = np.flatnonzero(np.r_[True, start[1:] != start[:-1]][: len(start)])
        return start[first], k[self._settled(start, k, height, first)], height[first]

    def _settled(
        self, start: np.ndarray, k: np.ndarray, height: np.ndarray, first: np.ndarray
    ) -> np.ndarray:
        """The row of the really lowest segment of each start, where rounding left several."""
        best = first.copy()
        running = np.arange(len(first))
        step = 1
        while len(running):
            row = first[running] + step
            running, row = running[row < len(start)], row[row < len(start)]
            close = (start[row] == start[first[running]]) & (
                height[row] - height[first[running]] <= self._tie
            )
            running, row = running[close], row[close]
            lower = self._is_below(k[row], k[best[running]])
            best[running[lower]] = row[lower]
            step += 1
        return best

    def _is_below(self, k: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Whether segments run below others, exactly: they keep their order where both are."""
        a, b = self._points[self._left[k]], self._points[self._right[k]]
        c, d = self._points[self._left[other]], self._points[self._right[other]]
        inner = a[:, 0] >= c[:, 0]
        begin = np.where(inner, sides(c, d, a), -sides(a, b, c))
        inner = b[:, 0] <= d[:, 0]
        end = np.where(inner, sides(c, d, b), -sides(a, b, d))
        return np.where(begin != 0, begin, end) < 0


def sides(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Exact sides of points c relative to the lines from a to b: 1 left, -1 right, 0 on it.

    Examples
    --------
    >>> sides(np.array([[0.0, 0.0]]), np.array([[0.1, 0.3]]), np.array([[0.2, 0.6]]))
    array([0])
    """
    left = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1])
    right = (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])
    det = left - right
    out = np.sign(det).astype(np.int64)
    # Shewchuk 1997: the sign is certain beyond this bound.
    bound = 3.3306690738754716e-16 * (np.abs(left) + np.abs(right))
    unsure = (np.abs(det) <= bound) & (a != c).any(axis=1) & (b != c).any(axis=1)
    out[np.abs(det) <= bound] = 0
    for k in np.flatnonzero(unsure).tolist():
        (ax, ay), (bx, by), (cx, cy) = (map(Fraction, p[k].tolist()) for p in (a, b, c))
        exact = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
        out[k] = (exact > 0) - (exact < 0)
    return out

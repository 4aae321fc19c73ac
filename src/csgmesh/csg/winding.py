"""Winding numbers of closed curves about many points, by a grid.

A row of cells knows the winding number along its lower edge: the crossings to the left, summed
once. A point walks from that edge straight up to itself and meets only the pieces in its own cell.
Where the walk leaves the edge, each piece's side is read off the same stored crossing that was
summed, so rounding can err only for points within rounding of a curve.

With n pieces the grid has at most 4n cells, narrow where pieces are tall and flat where they are
wide, so that combs and coastlines alike cost O(n) to enter and a few pieces a point on average.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.curves import ARC, CUBIC, LINE, QUADRATIC, Curves

#: Pairs of a point and a piece looked at together: keeps the working set within some 100 MB.
_PAIRS = 1_000_000

#: Ends nearer than this share of the extent belong together: far above the rounding of an arc's
#: end, far below any gap that a contour could mean.
_JOINED = 1e-9


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Pieces of curves that are monotone in both coordinates, with the ends they share exactly."""

    curves: Curves
    curve: np.ndarray
    t0: np.ndarray
    t1: np.ndarray
    p0: np.ndarray
    p1: np.ndarray

    def at(self, piece: np.ndarray, axis: int, value: np.ndarray) -> np.ndarray:
        """The other coordinate where coordinate `axis` has this value, within the piece's box."""
        a, b = self.p0[piece], self.p1[piece]
        step = b[:, axis] - a[:, axis]
        share = (value - a[:, axis]) / np.where(step == 0.0, 1.0, step)
        other = a[:, 1 - axis] + share * (b[:, 1 - axis] - a[:, 1 - axis])
        (bent,) = np.nonzero(self.curves.kind[self.curve[piece]] != LINE)
        if len(bent):
            which, curve = piece[bent], self.curve[piece[bent]]
            t = _solved(self.curves, curve, axis, value[bent], self.t0[which], self.t1[which])
            other[bent] = self.curves.points(curve, t)[:, 1 - axis]
        low = np.minimum(a[:, 1 - axis], b[:, 1 - axis])
        return np.clip(other, low, np.maximum(a[:, 1 - axis], b[:, 1 - axis]))


@dataclass(frozen=True, eq=False)
class WindingGrid:
    """A grid over closed curves, ready to answer `winding`.

    Examples
    --------
    >>> corners = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    >>> grid = WindingGrid.of(Curves.lines(corners, np.roll(corners, -1, axis=0)))
    >>> grid.winding(np.array([[0.5, 0.5], [2, 0.5]]))
    array([1, 0])
    """

    pieces: _Pieces
    low: np.ndarray
    high: np.ndarray
    size: np.ndarray  # of a cell
    shape: tuple[int, int]  # columns, rows
    before: np.ndarray  # (rows, columns): winding at the lower left corner of each cell
    start: np.ndarray  # entries of cell k are start[k] to start[k + 1]
    entry_piece: np.ndarray
    entry_crossing: np.ndarray  # x where the piece crosses the lower edge of the row, or NaN

    @staticmethod
    def of(curves: Curves) -> WindingGrid:
        """The grid over closed contours; the pieces of a contour follow one another."""
        pieces = _monotone(curves)
        both = np.concatenate([pieces.p0, pieces.p1])
        low, high = both.min(axis=0), both.max(axis=0)
        columns, rows = _resolution(pieces, high - low)
        # Curves along a single line have no extent across it, and one cell of any size there.
        size = np.where(high > low, (high - low) / (columns, rows), 1.0)
        piece, row, crossing = _row_entries(pieces, low, size, rows)
        before = _edge_windings(pieces, piece, row, crossing, low, size, (columns, rows))
        first, last = _column_span(pieces, piece, row, low, high, size, columns)
        repeat = last - first + 1
        column = _ranges(first, repeat)
        cell = np.repeat(row, repeat) * columns + column
        order = np.argsort(cell, kind="stable")
        start = np.zeros(columns * rows + 1, np.int64)
        np.cumsum(np.bincount(cell, minlength=columns * rows), out=start[1:])
        return WindingGrid(
            pieces,
            low,
            high,
            size,
            (columns, rows),
            before,
            start,
            np.repeat(piece, repeat)[order],
            np.repeat(crossing, repeat)[order],
        )

    def winding(self, points: np.ndarray) -> np.ndarray:
        """How often the curves wind counterclockwise about each of the ``(n, 2)`` points."""
        result = np.zeros(len(points), np.int64)
        (near,) = np.nonzero(((points >= self.low) & (points <= self.high)).all(axis=1))
        if len(near) == 0:
            return result
        columns, rows = self.shape
        column = _cell(points[near, 0], self.low[0], self.size[0], columns)
        row = _cell(points[near, 1], self.low[1], self.size[1], rows)
        result[near] = self.before[row, column]
        cell = row * columns + column
        count = self.start[cell + 1] - self.start[cell]
        chunks = np.cumsum(count) // _PAIRS
        for chunk in np.unique(chunks):
            at = np.flatnonzero((chunks == chunk) & (count > 0))
            if len(at):
                local = np.repeat(np.arange(len(at)), count[at])
                entry = _ranges(self.start[cell[at]], count[at])
                lower = self.low[1] + row[at] * self.size[1]
                turns = self._turns(points[near[at]][local], entry, column[at][local], lower[local])
                result[near[at]] += np.bincount(local, turns, len(at)).astype(np.int64)
        return result

    def _turns(
        self, point: np.ndarray, entry: np.ndarray, column: np.ndarray, lower: np.ndarray
    ) -> np.ndarray:
        """What each piece adds along the lower edge within the cell and on the way up from it."""
        pieces, piece = self.pieces, self.entry_piece[entry]
        a, b = pieces.p0[piece], pieces.p1[piece]
        x, y = point[:, 0], point[:, 1]
        crossing = self.entry_crossing[entry]
        crosses = ~np.isnan(crossing)
        known = np.where(crosses, crossing, self.low[0])
        crossing_column = _cell(known, self.low[0], self.size[0], self.shape[0])
        here = crosses & (crossing_column == column)
        right = crosses & ((crossing_column < column) | (here & (crossing <= x)))
        turns = np.where(here & right, np.where(b[:, 1] > a[:, 1], -1.0, 1.0), 0.0)
        rising = (b[:, 0] > a[:, 0]) == (b[:, 1] > a[:, 1])
        starts_below = np.where(crosses, right == rising, np.minimum(a[:, 1], b[:, 1]) > lower)
        (met,) = np.nonzero(((a[:, 0] <= x) != (b[:, 0] <= x)) & starts_below)
        above = y[met] >= np.maximum(a[met, 1], b[met, 1])
        (close,) = np.nonzero(~above & (y[met] >= np.minimum(a[met, 1], b[met, 1])))
        height = pieces.at(piece[met[close]], 0, x[met[close]])
        above[close] = y[met[close]] >= height
        turns[met] += np.where(above, np.where(b[met, 0] > a[met, 0], 1.0, -1.0), 0.0)
        return turns


def _cell(value: np.ndarray, low: float, size: float, count: int) -> np.ndarray:
    return np.clip(np.floor((value - low) / size), 0, count - 1).astype(np.int64)


def _ranges(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """``first[i], first[i] + 1, …`` of `count[i]` numbers each, one after the other."""
    ends = np.cumsum(count)
    total = int(ends[-1]) if len(ends) else 0
    return np.arange(total) + np.repeat(first - (ends - count), count)


def _resolution(pieces: _Pieces, extent: np.ndarray) -> tuple[int, int]:
    """Columns and rows such that pieces enter a few cells each and cells number at most 4n."""
    n = len(pieces.curve)
    travelled = np.abs(pieces.p1 - pieces.p0).sum(axis=0)
    wanted = np.maximum(n * extent / np.maximum(travelled, np.finfo(float).tiny), 1.0)
    limit = 4.0 * n + 16.0
    fewer = wanted * min(np.sqrt(limit / wanted.prod()), 1.0)
    narrow = int(np.argmin(fewer))
    if fewer[narrow] < 1.0:
        fewer[narrow], fewer[1 - narrow] = 1.0, min(wanted[1 - narrow], limit)
    return int(fewer[0]), int(fewer[1])


def _row_entries(
    pieces: _Pieces, low: np.ndarray, size: np.ndarray, rows: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Every piece in every row it enters, and where it crosses the row's lower edge (or NaN)."""
    bottom = np.minimum(pieces.p0[:, 1], pieces.p1[:, 1])
    top = np.maximum(pieces.p0[:, 1], pieces.p1[:, 1])
    first = _cell(bottom, low[1], size[1], rows)
    count = _cell(top, low[1], size[1], rows) - first + 1
    piece = np.repeat(np.arange(len(bottom)), count)
    row = _ranges(first, count)
    lower = low[1] + row * size[1]
    crossing = np.full(len(piece), np.nan)
    (at,) = np.nonzero((bottom[piece] <= lower) & (lower < top[piece]))
    crossing[at] = pieces.at(piece[at], 1, lower[at])
    return piece, row, crossing


def _edge_windings(
    pieces: _Pieces,
    piece: np.ndarray,
    row: np.ndarray,
    crossing: np.ndarray,
    low: np.ndarray,
    size: np.ndarray,
    shape: tuple[int, int],
) -> np.ndarray:
    """Winding at the lower left corner of each cell: the crossings in the columns before it."""
    columns, rows = shape
    at = ~np.isnan(crossing)
    column = _cell(crossing[at], low[0], size[0], columns)
    sign = np.where(pieces.p1[piece[at], 1] > pieces.p0[piece[at], 1], -1.0, 1.0)
    total = np.bincount(row[at] * columns + column, sign, columns * rows)
    summed = np.cumsum(total.reshape(rows, columns), axis=1)
    before = np.zeros((rows, columns), np.int64)
    before[:, 1:] = summed[:, :-1]
    return before


def _column_span(
    pieces: _Pieces,
    piece: np.ndarray,
    row: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    size: np.ndarray,
    columns: int,
) -> tuple[np.ndarray, np.ndarray]:
    """First and last column that a piece can touch within a row."""
    a, b = pieces.p0[piece], pieces.p1[piece]
    left, right = np.minimum(a[:, 0], b[:, 0]), np.maximum(a[:, 0], b[:, 0])
    rise = b[:, 1] - a[:, 1]
    straight = (pieces.curves.kind[pieces.curve[piece]] == LINE) & (rise != 0.0)
    slope = (b[:, 0] - a[:, 0]) / np.where(straight, rise, 1.0)
    lower = low[1] + row * size[1]
    enters = a[:, 0] + slope * (lower - a[:, 1])
    leaves = a[:, 0] + slope * (lower + size[1] - a[:, 1])
    # A thousandth of a cell covers the rounding of the interpolation.
    pad = 1e-3 * size[0] + 1e-9 * (high[0] - low[0])
    narrow = np.maximum(left, np.minimum(enters, leaves) - pad)
    wide = np.minimum(right, np.maximum(enters, leaves) + pad)
    left, right = np.where(straight, narrow, left), np.where(straight, wide, right)
    first = _cell(left, low[0], size[0], columns)
    return first, np.maximum(_cell(right, low[0], size[0], columns), first)


def _monotone(curves: Curves) -> _Pieces:
    """Cut every curve where it turns back in x or y; ends that belong together become equal."""
    n = len(curves)
    start, end = curves.interval[:, 0], curves.interval[:, 1]
    owner, cut = _turning_points(curves)
    share = (cut - start[owner]) / (end - start)[owner]
    inner = (share > 0.0) & (share < 1.0)
    owner = np.concatenate([np.arange(n), owner[inner], np.arange(n)])
    share = np.concatenate([np.zeros(n), share[inner], np.ones(n)])
    t = np.concatenate([start, cut[inner], end])
    order = np.lexsort((share, owner))
    owner, t = owner[order], t[order]
    points = curves.points(owner, t)
    same = owner[1:] == owner[:-1]
    p0, p1 = points[:-1][same].copy(), points[1:][same].copy()
    _join(p0, p1)
    return _Pieces(curves, owner[:-1][same], t[:-1][same], t[1:][same], p0, p1)


def _join(p0: np.ndarray, p1: np.ndarray) -> None:
    """Let every piece start exactly where the one before it in its contour ends."""
    reach = _JOINED * float(np.ptp(np.concatenate([p0, p1]), axis=0).max())
    follows = (np.abs(p0[1:] - p1[:-1]) <= reach).all(axis=1)
    first = np.concatenate([[0], np.flatnonzero(~follows) + 1])
    last = np.append(first[1:], len(p0)) - 1
    previous = np.arange(len(p0)) - 1
    previous[first] = last
    p0[:] = p1[previous]


def _turning_points(curves: Curves) -> tuple[np.ndarray, np.ndarray]:
    """Curve numbers and parameters where a derivative of a coordinate vanishes."""
    blocks = curves.data.reshape(-1, 4, 2)
    owners, cuts = [], []
    for axis in (0, 1):
        (at,) = np.nonzero(curves.kind == ARC)
        u, v = blocks[at, 1, axis], blocks[at, 2, axis]
        angle = np.arctan2(v, u)
        low = curves.interval[at].min(axis=1)
        for turn in range(3):
            # The turning points are angle + kπ; an arc of at most 2π holds at most three.
            owners.append(at)
            cuts.append(angle + np.pi * (np.ceil((low - angle) / np.pi) + turn))
        (at,) = np.nonzero(curves.kind == QUADRATIC)
        first, second = np.diff(blocks[at, :3, axis], axis=1).T
        owners.append(at)
        cuts.append(_ratio(first, first - second))
        (at,) = np.nonzero(curves.kind == CUBIC)
        first, second, third = np.diff(blocks[at, :4, axis], axis=1).T
        # Derivative / 3 = first (1−t)² + 2 second t (1−t) + third t² = a t² − 2 b t + first.
        a, b = first - 2.0 * second + third, first - second
        root = np.sqrt(np.maximum(b * b - a * first, 0.0))
        q = b + np.copysign(root, b)
        owners += [at, at]
        cuts += [_ratio(q, a), _ratio(first, q)]
    return np.concatenate(owners), np.concatenate(cuts)


def _ratio(above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Quotient, or −1 (outside every interval) where there is none."""
    good = below != 0.0
    return np.where(good, above / np.where(good, below, 1.0), -1.0)


def _solved(
    curves: Curves,
    curve: np.ndarray,
    axis: int,
    value: np.ndarray,
    t0: np.ndarray,
    t1: np.ndarray,
) -> np.ndarray:
    """Parameters in [t0, t1] where a monotone coordinate has a value: Newton, else halving."""
    below, above = t0.copy(), t1.copy()
    backwards = curves.points(curve, t0)[:, axis] > curves.points(curve, t1)[:, axis]
    below[backwards], above[backwards] = t1[backwards], t0[backwards]
    t = 0.5 * (below + above)
    active = np.arange(len(t))
    for _ in range(64):
        which = curve[active]
        off = curves.points(which, t[active])[:, axis] - value[active]
        low = off <= 0.0
        below[active[low]], above[active[~low]] = t[active[low]], t[active[~low]]
        slope = curves.derivatives(which, t[active])[:, axis]
        newton = t[active] - off / np.where(slope == 0.0, 1.0, slope)
        left = np.minimum(below[active], above[active])
        right = np.maximum(below[active], above[active])
        good = (slope != 0.0) & (newton >= left) & (newton <= right)
        following = np.where(good, newton, 0.5 * (left + right))
        settled = np.abs(following - t[active]) <= 4e-16 * np.maximum(np.abs(following), 1.0)
        t[active] = following
        active = active[~settled]
        if len(active) == 0:
            break
    return t

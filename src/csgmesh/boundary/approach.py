"""Where two curves of any kind come within the snap distance: subdivision, then Newton's method.

Parameter boxes are halved while the boxes of their curve pieces overlap; along the chord of one
piece the other must overlap as well, which separates nearly parallel curves. What survives until
the pieces are straight to within the snap distance is a crossing, a touching or a near miss.
(Sederberg and Nishita 1990 call the idea of a box along the chord a fat line.)
"""

from __future__ import annotations

import numpy as np

from csgmesh.boundary.pieces import Pieces
from csgmesh.domain.curves import CUBIC, Curves, cross

_DEPTH = 60

#: Curves that cross at a smaller angle (radians) enclose less than the snap distance nearby, and
#: Newton's method finds no more than a stretch of them: they count as touching.
_TANGENT = 1e-6
_SAMPLES = np.linspace(0.0, 1.0, 9)


def approaches(pieces: Pieces, pairs: np.ndarray, snap: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs and parameters at which the pieces cross, touch or nearly touch.

    Returns
    -------
    rows : (k, 2) int64
        Pairs of pieces, repeated as often as they meet.
    t : (k, 2) float64
        Parameters on both.
    """
    if len(pairs):
        pairs = pairs[~_coincide(pieces, pairs, snap)]
    if len(pairs) == 0:
        return pairs.reshape(-1, 2), np.zeros((0, 2))
    row, interval = _subdivide(pieces, pairs, snap)
    known = _at_common_end(pieces, pairs[row], interval, snap)
    return _polish(pieces, pairs[row[~known]], interval[~known], snap)


def _coincide(pieces: Pieces, pairs: np.ndarray, snap: float) -> np.ndarray:
    """Pairs that run along one another wherever they overlap: their ends say all there is."""
    i, j = pairs.T
    local = pieces.local
    a, b = pieces.source[i], pieces.source[j]
    same = (local.kind[a] == local.kind[b]) & (local.data[a] == local.data[b]).all(1)
    # Two stretches of one cubic may cross: it can make a loop.
    apart = (pieces.lo[i] >= pieces.hi[j]) | (pieces.lo[j] >= pieces.hi[i])
    same &= ~(apart & (local.kind[a] == CUBIC))
    # Reversed copies and curves equal up to rounding: compare samples over the overlap.
    at = np.flatnonzero(~same)
    ia, jb = i[at], j[at]
    ends = []
    for t in (pieces.lo[ia], pieces.hi[ia]):
        p = local.points(a[at], t)
        s = local.project(b[at], p, pieces.lo[jb], pieces.hi[jb])
        ends.append((t, np.hypot(*(local.points(b[at], s) - p).T) <= snap))
    for s in (pieces.lo[jb], pieces.hi[jb]):
        p = local.points(b[at], s)
        t = local.project(a[at], p, pieces.lo[ia], pieces.hi[ia])
        ends.append((t, np.hypot(*(local.points(a[at], t) - p).T) <= snap))
    t = np.array([e[0] for e in ends])
    on = np.array([e[1] for e in ends])
    first = np.where(on, t, np.inf).min(0)
    last = np.where(on, t, -np.inf).max(0)
    overlap = np.flatnonzero((on.sum(0) >= 2) & (last - first > 1e-9 * np.abs(t).max(0)))
    if len(overlap):
        k = at[overlap]
        f, g = first[overlap, None], last[overlap, None]
        tt = (f + (g - f) * _SAMPLES).ravel()
        p = local.points(np.repeat(a[k], len(_SAMPLES)), tt)
        bb, jj = np.repeat(b[k], len(_SAMPLES)), np.repeat(j[k], len(_SAMPLES))
        s = local.project(bb, p, pieces.lo[jj], pieces.hi[jj])
        off = np.hypot(*(local.points(bb, s) - p).T).reshape(-1, len(_SAMPLES)).max(1)
        same[k] = off <= snap
    return same


def _subdivide(pieces: Pieces, pairs: np.ndarray, snap: float) -> tuple[np.ndarray, np.ndarray]:
    local = pieces.local
    bend = local.second_derivative_bounds()
    row = np.arange(len(pairs))
    interval = np.stack([pieces.lo[pairs], pieces.hi[pairs]], axis=2)
    done_row, done_interval = [], []
    for _ in range(_DEPTH):
        source = pieces.source[pairs[row]]
        ends = [
            [local.points(source[:, side], interval[:, side, e]) for e in (0, 1)] for side in (0, 1)
        ]
        width = interval[:, :, 1] - interval[:, :, 0]
        sag = width**2 * bend[source] / 8
        alive = _may_meet(ends, sag, snap)
        row, interval, sag, width = row[alive], interval[alive], sag[alive], width[alive]
        straight = (sag <= snap / 4).all(1)
        done_row.append(row[straight])
        done_interval.append(interval[straight])
        row, interval, sag = row[~straight], interval[~straight], sag[~straight]
        if len(row) == 0:
            break
        side = sag.argmax(1)
        k = np.arange(len(row))
        middle = interval[k, side].mean(axis=1)
        lower, upper = interval.copy(), interval
        lower[k, side, 1] = middle
        upper[k, side, 0] = middle
        row, interval = np.concatenate([row, row]), np.concatenate([lower, upper])
    return np.concatenate(done_row), np.concatenate(done_interval)


def _may_meet(ends: list[list[np.ndarray]], sag: np.ndarray, snap: float) -> np.ndarray:
    (a0, a1), (b0, b1) = ends
    alive = np.ones(len(a0), bool)
    reach = (sag.sum(1) + snap)[:, None]
    alive &= (np.minimum(a0, a1) - reach <= np.maximum(b0, b1)).all(1)
    alive &= (np.minimum(b0, b1) - reach <= np.maximum(a0, a1)).all(1)
    for p, q, x, y in ((a0, a1, b0, b1), (b0, b1, a0, a1)):
        along = q - p
        length = np.hypot(*along.T)
        off_x, off_y = cross(along, x - p), cross(along, y - p)
        far = reach[:, 0] * length
        alive &= ~((np.minimum(off_x, off_y) > far) | (np.maximum(off_x, off_y) < -far))
    return alive


def _at_common_end(
    pieces: Pieces, rows: np.ndarray, interval: np.ndarray, snap: float
) -> np.ndarray:
    """Which parameter boxes hold nothing but an end that both pieces have anyway."""
    local = pieces.local
    i, j = pieces.source[rows].T
    out = np.zeros(len(rows), bool)
    for end_i in (pieces.lo, pieces.hi):
        for end_j in (pieces.lo, pieces.hi):
            t, s = end_i[rows[:, 0]], end_j[rows[:, 1]]
            common = (local.points(i, t) == local.points(j, s)).all(1)
            common &= (interval[:, 0, 0] <= t) & (t <= interval[:, 0, 1])
            common &= (interval[:, 1, 0] <= s) & (s <= interval[:, 1, 1])
            k = np.flatnonzero(common)
            # Straight to within the snap distance, they meet once unless they run side by side.
            d_i, d_j = local.derivatives(i[k], t[k]), local.derivatives(j[k], s[k])
            wide = np.abs(cross(d_i, d_j)) > 1e-3 * np.hypot(*d_i.T) * np.hypot(*d_j.T)
            size = (interval[k, 0, 1] - interval[k, 0, 0]) * np.hypot(*d_i.T)
            out[k] |= wide | (size <= 8 * snap)
    return out


def _polish(
    pieces: Pieces, rows: np.ndarray, interval: np.ndarray, snap: float
) -> tuple[np.ndarray, np.ndarray]:
    local = pieces.local
    t, width = interval.mean(axis=2), interval[:, :, 1] - interval[:, :, 0]
    i, j = pieces.source[rows].T
    lo, hi = pieces.lo[rows], pieces.hi[rows]
    crossing = _newton_crossing(local, i, j, t.copy(), lo, hi)
    gap = np.hypot(*(local.points(i, crossing[:, 0]) - local.points(j, crossing[:, 1])).T)
    crossed = (gap <= 1e-14) & (np.abs(crossing - t) <= 2 * width).all(1)
    d_i, d_j = local.derivatives(i, crossing[:, 0]), local.derivatives(j, crossing[:, 1])
    crossed &= np.abs(cross(d_i, d_j)) > _TANGENT * np.hypot(*d_i.T) * np.hypot(*d_j.T)
    best = crossing
    k = np.flatnonzero(~crossed)
    best[k] = _nearest(local, i[k], j[k], t[k], lo[k], hi[k])
    first = _one_of_each(local, i, j, rows, best, crossed, snap)
    rows, best, crossed = rows[first], best[first], crossed[first]
    contact = _slides_to_common_end(pieces, rows, best, snap) & ~crossed
    return rows[~contact], best[~contact]


def _one_of_each(
    local: Curves,
    i: np.ndarray,
    j: np.ndarray,
    rows: np.ndarray,
    t: np.ndarray,
    crossed: np.ndarray,
    snap: float,
) -> np.ndarray:
    """One candidate for each crossing and for each stretch within the snap distance.

    Neighbouring parameter boxes find the same crossing, and a touching is found all along the
    stretch on which the curves are within the snap distance: its closest point stands for it, also
    where the curves cross twice and what they enclose is thinner than that.
    """
    p, q = local.points(i, t[:, 0]), local.points(j, t[:, 1])
    order = np.lexsort((t[:, 0], rows[:, 1], rows[:, 0]))
    a, b = order[:-1], order[1:]
    same = (rows[a] == rows[b]).all(1)
    equal = same & (np.hypot(*(p[a] - p[b]).T) <= snap / 2)
    k = np.flatnonzero(same & ~equal)
    middle = 0.5 * (t[a[k]] + t[b[k]])
    gap = local.points(i[a[k]], middle[:, 0]) - local.points(j[a[k]], middle[:, 1])
    joined = equal
    joined[k] = np.hypot(*gap.T) <= snap
    stretch = np.r_[0, np.cumsum(~joined)] if len(order) else order
    rank = np.lexsort((np.hypot(*(p - q).T)[order], ~crossed[order], stretch))
    first = np.r_[True, stretch[rank][1:] != stretch[rank][:-1]][: len(order)]
    return np.sort(order[rank[first]])


def _slides_to_common_end(
    pieces: Pieces, rows: np.ndarray, t: np.ndarray, snap: float
) -> np.ndarray:
    """Which touchings belong to a common end: between, the pieces keep within the snap distance."""
    local = pieces.local
    i, j = pieces.source[rows].T
    out = np.zeros(len(rows), bool)
    for end_i in (pieces.lo, pieces.hi):
        for end_j in (pieces.lo, pieces.hi):
            e, f = end_i[rows[:, 0]], end_j[rows[:, 1]]
            k = np.flatnonzero((local.points(i, e) == local.points(j, f)).all(1))
            p = local.points(i[k], 0.5 * (e[k] + t[k, 0]))
            s = local.project(j[k], p, np.minimum(f, t[:, 1])[k], np.maximum(f, t[:, 1])[k])
            out[k] |= np.hypot(*(local.points(j[k], s) - p).T) <= snap
    return out


def _newton_crossing(
    local: Curves, i: np.ndarray, j: np.ndarray, t: np.ndarray, lo: np.ndarray, hi: np.ndarray
) -> np.ndarray:
    for _ in range(20):
        r = local.points(i, t[:, 0]) - local.points(j, t[:, 1])
        di, dj = local.derivatives(i, t[:, 0]), local.derivatives(j, t[:, 1])
        turn = cross(di, dj)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.column_stack([cross(r, dj), cross(r, di)]) / turn[:, None]
        t = np.clip(t - np.where(np.isfinite(step), step, 0.0), lo, hi)
    return t


def _nearest(
    local: Curves, i: np.ndarray, j: np.ndarray, t: np.ndarray, lo: np.ndarray, hi: np.ndarray
) -> np.ndarray:
    """Closest approach near `t`: parallel tangents, joined at a right angle, by Newton's method.

    Alternating projections lead there and serve where the curvatures agree, and Newton's fails.
    """
    reach = 2.0**-4 * (hi - lo)
    low, high = np.maximum(t - reach, lo), np.minimum(t + reach, hi)
    for _ in range(8):
        t[:, 1] = local.project(j, local.points(i, t[:, 0]), low[:, 1], high[:, 1])
        t[:, 0] = local.project(i, local.points(j, t[:, 1]), low[:, 0], high[:, 0])
    near = t.copy()
    for _ in range(8):
        r = local.points(i, t[:, 0]) - local.points(j, t[:, 1])
        di, dj = local.derivatives(i, t[:, 0]), local.derivatives(j, t[:, 1])
        ddi, ddj = local.second_derivatives(i, t[:, 0]), local.second_derivatives(j, t[:, 1])
        f, g = (r * di).sum(1), cross(di, dj)
        f_t, f_s = (di * di).sum(1) + (r * ddi).sum(1), -(di * dj).sum(1)
        g_t, g_s = cross(ddi, dj), cross(di, ddj)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.column_stack([f * g_s - g * f_s, g * f_t - f * g_t])
            step /= (f_t * g_s - f_s * g_t)[:, None]
        t = np.clip(t - np.where(np.isfinite(step), step, 0.0), low, high)
    before = local.points(i, near[:, 0]) - local.points(j, near[:, 1])
    after = local.points(i, t[:, 0]) - local.points(j, t[:, 1])
    worse = np.hypot(*after.T) > np.hypot(*before.T) + 1e-16
    t[worse] = near[worse]
    return t

"""Which boxes in space overlap boxes of other groups, by grids of several widths."""

from __future__ import annotations

import numpy as np

#: Grids get wider by this factor from level to level.
_WIDER = 4.0

#: Boxes far smaller than the others share one grid, so that there are few levels.
_SMALL_SHARE = 1.0 / 16.0

#: Pairs looked at together: a few tens of megabytes.
_CHUNK = 1 << 20

_MIX = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)


def overlapping_pairs(lo: np.ndarray, hi: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Pairs i < j of closed boxes that overlap and belong to different groups, (k, 2), sorted.

    Each box is entered in a grid no finer than itself, so in eight cells at the most, and looks for
    others there and in all wider grids. Cells that know one group only are passed over: that is
    most of them where a group is a surface.

    Parameters
    ----------
    lo, hi : (n, 3) float64
    group : (n,) int64

    Examples
    --------
    >>> lo = np.array([[0.0, 0, 0], [0.5, 0.5, 0.5], [3, 0, 0], [0, 0, 0]])
    >>> overlapping_pairs(lo, lo + 1.0, np.array([0, 1, 1, 0]))
    array([[0, 1],
           [1, 3]])
    """
    n = len(lo)
    if n < 2:
        return np.zeros((0, 2), np.int64)
    size = (hi - lo).max(axis=1)
    least = max(float(np.median(size)) * _SMALL_SHARE, float(size.max()) * 1e-12, 1e-300)
    level = np.ceil(np.log(np.maximum(size / least, 1.0)) / np.log(_WIDER)).astype(np.int64)
    found = []
    for k in np.unique(level).tolist():
        width = least * _WIDER**k * (1.0 + 1e-12)
        # Finer boxes look here for wider ones; boxes of this level for one another.
        asking = np.flatnonzero(level <= k)
        cell, box = _cells(lo, hi, asking, width)
        entered = level[box] == k
        own_cell, own_box = cell[entered], box[entered]
        order = np.argsort(own_cell, kind="stable")
        own_cell, own_box = own_cell[order], own_box[order]
        start = np.flatnonzero(np.r_[True, own_cell[1:] != own_cell[:-1]])
        end = np.r_[start[1:], len(own_cell)]
        low = np.minimum.reduceat(group[own_box], start)
        high = np.maximum.reduceat(group[own_box], start)
        at = np.searchsorted(own_cell[start], cell)
        at[at == len(start)] = 0
        mixed = (own_cell[start][at] == cell) & ((low[at] != group[box]) | (high[at] != group[box]))
        at, box = at[mixed], box[mixed]
        found += _met(lo, hi, group, level, box, own_box, start[at], end[at])
    if not found:
        return np.zeros((0, 2), np.int64)
    key = distinct(np.concatenate(found))
    return np.column_stack([key // n, key % n])


def distinct(keys: np.ndarray) -> np.ndarray:
    """Numbers in increasing order, each once.

    By sorting: `numpy.unique` hashes, which takes several times as long for millions of keys.

    Examples
    --------
    >>> distinct(np.array([3, 1, 3]))
    array([1, 3])
    """
    ordered = np.sort(keys)
    return ordered[np.r_[True, ordered[1:] != ordered[:-1]][: len(ordered)]]


def ordered(rows: np.ndarray, n: int) -> np.ndarray:
    """The order of rows of numbers below n, by the first column, then the second and so on, (k,).

    Rows are packed into single numbers as far as these go: sorting by columns takes several times
    as long.

    Examples
    --------
    >>> ordered(np.array([[1, 0, 2], [0, 5, 1], [1, 0, 1]]), 6)
    array([1, 2, 0])
    """
    if n ** rows.shape[1] < 1 << 62:
        key = rows[:, 0].astype(np.int64)
        for column in rows.T[1:]:
            key = key * n + column
        return np.argsort(key, kind="stable")
    return np.lexsort(rows.T[::-1])


def in_use(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points that triangles have, and these with the points' new numbers."""
    used = np.zeros(len(points), bool)
    used[triangles] = True
    number = np.cumsum(used) - 1
    return points[used], number[triangles]


def _cells(
    lo: np.ndarray, hi: np.ndarray, which: np.ndarray, width: float
) -> tuple[np.ndarray, np.ndarray]:
    """Hashed cells that boxes lie in, and the boxes."""
    first = np.floor(lo[which] / width).astype(np.int64)
    last = np.floor(hi[which] / width).astype(np.int64)
    cells, boxes = [], []
    for corner in np.ndindex(2, 2, 2):
        step = np.array(corner)
        reached = ((step == 0) | (last > first)).all(axis=1)
        place = (first[reached] + step).view(np.uint64) * _MIX
        cells.append(place[:, 0] ^ (place[:, 1] >> np.uint64(1)) ^ (place[:, 2] >> np.uint64(2)))
        boxes.append(which[reached])
    return np.concatenate(cells), np.concatenate(boxes)


def _met(
    lo: np.ndarray,
    hi: np.ndarray,
    group: np.ndarray,
    level: np.ndarray,
    box: np.ndarray,
    others: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
) -> list[np.ndarray]:
    """Keys of pairs of each box with the others from start to end that really overlap it."""
    n = len(lo)
    count = end - start
    cuts = np.searchsorted(np.cumsum(count), np.arange(_CHUNK, count.sum() + _CHUNK, _CHUNK))
    out, before = [], 0
    for cut in np.unique(np.append(cuts + 1, len(box))).tolist():
        part = slice(before, min(cut, len(box)))
        before = part.stop
        times = count[part]
        i = np.repeat(box[part], times)
        j = others[np.repeat(start[part] - np.cumsum(times) + times, times) + np.arange(len(i))]
        # Two boxes of one level find each other twice.
        kept = (group[i] != group[j]) & ((level[i] != level[j]) | (i < j))
        i, j = i[kept], j[kept]
        for axis in range(3):
            kept = (lo[i, axis] <= hi[j, axis]) & (lo[j, axis] <= hi[i, axis])
            i, j = i[kept], j[kept]
        out.append(np.minimum(i, j) * n + np.maximum(i, j))
    return out

"""Which squares of a grid shapes pass through; coordinates are in squares from its origin."""

from __future__ import annotations

import numpy as np

#: Share of a square by which a needle is drawn too wide, for rounding.
_MARGIN = 1e-6


def box_squares(lo: np.ndarray, hi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Squares that boxes overlap, which are no wider than a square.

    Returns
    -------
    box, x, y : (k,) int64
        Number of the box, column and row of the square.
    """
    low, high = np.floor(lo).astype(np.int64), np.floor(hi).astype(np.int64)
    rows, x, y = [], [], []
    for dx in (0, 1):
        for dy in (0, 1):
            fits = np.flatnonzero((low[:, 0] + dx <= high[:, 0]) & (low[:, 1] + dy <= high[:, 1]))
            rows.append(fits)
            x.append(low[fits, 0] + dx)
            y.append(low[fits, 1] + dy)
    return np.concatenate(rows), np.concatenate(x), np.concatenate(y)


def needle_squares(
    corners: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Squares that triangles pass through, and perhaps a few beside them.

    Returns
    -------
    triangle, x, y : (k,) int64
        Number of the triangle, column and row of the square.
    """
    bottom = np.maximum(np.floor(corners[:, :, 1].min(axis=1) - _MARGIN), 0.0)
    top = np.floor(corners[:, :, 1].max(axis=1) + _MARGIN)
    rows, x, y = [], [], []
    for step in range(int((top - bottom).max()) + 1):
        at = np.flatnonzero(bottom + step <= top)
        line = bottom[at] + step
        low, high = _within_strip(corners[at], line - _MARGIN, line + 1 + _MARGIN)
        first = np.maximum(np.floor(low - _MARGIN), 0).astype(np.int64)
        count = np.floor(high + _MARGIN).astype(np.int64) - first + 1
        rows.append(np.repeat(at, count))
        within = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
        x.append(np.repeat(first, count) + within)
        y.append(np.repeat(line, count).astype(np.int64))
    return np.concatenate(rows), np.concatenate(x), np.concatenate(y)


def _within_strip(
    corners: np.ndarray, bottom: np.ndarray, top: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest x of triangles where y is within a strip."""
    low, high = np.full(len(corners), np.inf), np.full(len(corners), -np.inf)
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
        reaches = (np.maximum(a[:, 1], b[:, 1]) >= bottom) & (np.minimum(a[:, 1], b[:, 1]) <= top)
        for line in (bottom, top):
            share = np.clip((line - a[:, 1]) / rise, 0.0, 1.0)
            x = a[:, 0] + share * (b[:, 0] - a[:, 0])
            low = np.where(reaches, np.minimum(low, x), low)
            high = np.where(reaches, np.maximum(high, x), high)
        for end in (a, b):
            inside = (end[:, 1] >= bottom) & (end[:, 1] <= top)
            low = np.where(inside, np.minimum(low, end[:, 0]), low)
            high = np.where(inside, np.maximum(high, end[:, 0]), high)
    return low, high

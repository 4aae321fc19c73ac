"""What the search for the worst cells does alike in the plane and in space."""

from __future__ import annotations

import numpy as np

#: Mean edge lengths at a cell's vertices that differ by this factor make a jump in size.
JUMP = 1.8


def lowest(values: np.ndarray, count: int) -> np.ndarray:
    """Where the lowest values are, in order; of equal ones the first."""
    if count >= len(values):
        return np.argsort(values, kind="stable")
    level = np.partition(values, count - 1)[count - 1]
    few = np.flatnonzero(values <= level)
    return few[np.argsort(values[few], kind="stable")][:count]


def mean_edges(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Mean length of the edges from a to b at each vertex."""
    length = np.sqrt(((points[b] - points[a]) ** 2).sum(axis=1))
    total = np.bincount(a, length, len(points)) + np.bincount(b, length, len(points))
    number = np.bincount(a, None, len(points)) + np.bincount(b, None, len(points))
    return total / np.maximum(number, 1)

"""Which boxes overlap, which points are near: the only door to other libraries' search trees."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

#: As many points are compared without a search tree, which has to be imported first.
FEW = 2000
#: So many pairs of boxes are compared sooner than a search tree is built.
FEW_PAIRS = 20_000
#: Width of the cells that near points are looked for in, in units of the distance: few points lie
#: within the distance of a wall.
_CELL = 64.0

_MIX = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)


class Boxes:
    """Axis-parallel boxes, searchable; closed, so boxes that only touch overlap.

    Parameters
    ----------
    lo, hi : (n, 2) float64
        Lower and upper corners.

    Examples
    --------
    >>> Boxes(np.array([[0.0, 0.0], [2.0, 2.0]]), np.array([[1.0, 1.0], [3.0, 3.0]])).pairs()
    array([], shape=(0, 2), dtype=int64)
    """

    def __init__(self, lo: np.ndarray, hi: np.ndarray) -> None:
        self._lo, self._hi = lo, hi

    @cached_property
    def _tree(self) -> Any:
        from shapely import STRtree

        return STRtree(_diagonals(self._lo, self._hi))

    def pairs(self) -> np.ndarray:
        """All pairs i < j of overlapping boxes, (k, 2), sorted."""
        found = self.overlapping(self._lo, self._hi)
        return found[found[:, 0] < found[:, 1]]

    def overlapping(self, lo: np.ndarray, hi: np.ndarray) -> np.ndarray:
        """All pairs (query, box) of the given boxes with these, (k, 2), sorted."""
        if len(lo) * len(self._lo) > FEW_PAIRS:
            return _sorted_rows(self._tree.query(_diagonals(lo, hi)))
        meet = np.ones((len(lo), len(self._lo)), bool)
        for axis in (0, 1):
            meet &= lo[:, axis, None] <= self._hi[:, axis]
            meet &= hi[:, axis, None] >= self._lo[:, axis]
        return np.argwhere(meet)


def nearest_distances(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Distance of each point from the nearest of the others, (n,); infinite if there are none.

    Examples
    --------
    >>> nearest_distances(np.array([[0.0, 0, 0], [4, 0, 0]]), np.array([[1.0, 0, 0], [4, 3, 0]]))
    array([1., 3.])
    """
    from scipy.spatial import cKDTree

    if not len(others):
        return np.full(len(points), np.inf)
    return np.asarray(cKDTree(others).query(points)[0], float)


def near_pairs(points: np.ndarray, distance: float) -> np.ndarray:
    """All pairs i < j of points no further apart than `distance`, (k, 2), sorted.

    Examples
    --------
    >>> near_pairs(np.array([[0.0, 0.0], [1.0, 1.0], [0.0, 0.1]]), 0.2)
    array([[0, 2]])
    """
    if len(points) <= FEW and points.shape[1] == 2:
        return _few_near_pairs(points, distance)
    from scipy.spatial import cKDTree

    some = _in_company(points, distance) if points.shape[1] == 3 else np.arange(len(points))
    found = cKDTree(points[some]).query_pairs(distance, output_type="ndarray").astype(np.int64)
    return _sorted_rows(some[found.reshape(-1, 2)].T)


def _in_company(points: np.ndarray, distance: float) -> np.ndarray:
    """Points that may have another within the distance, (k,): far fewer than all if it is small.

    Points are entered into wide cells; who is near a wall, into those beyond it, too.
    """
    n = len(points)
    reach = 1.01 * distance + 4.0 * np.spacing(np.abs(points).max(initial=0.0))
    width = _CELL * reach
    first, last = (np.floor((points + side * reach) / width) for side in (-1.0, 1.0))
    mix = _MIX[: points.shape[1]]
    low, high = (mix * x.astype(np.int64).view(np.uint64) for x in (first, last))
    reaching = first != last
    cells, who = [np.bitwise_xor.reduce(low, axis=1)], [np.arange(n)]
    several = np.flatnonzero(reaching.any(axis=1))
    low, high, reaching = low[several], high[several], reaching[several]
    for corner in list(np.ndindex((2,) * points.shape[1]))[1:]:
        step = np.array(corner, bool)
        at = np.flatnonzero((reaching | ~step).all(axis=1))
        cells.append(np.bitwise_xor.reduce(np.where(step, high[at], low[at]), axis=1))
        who.append(several[at])
    cell, entered = np.concatenate(cells), np.concatenate(who)
    bits = (8 * len(cell)).bit_length()
    slot = (cell >> np.uint64(64 - bits)).astype(np.int64)
    last_in = np.empty(1 << bits, np.int64)
    last_in[slot] = entered
    shared = np.zeros(1 << bits, bool)
    shared[slot[last_in[slot] != entered]] = True
    found = np.zeros(n, bool)
    found[entered[shared[slot]]] = True
    return np.flatnonzero(found)


def _few_near_pairs(points: np.ndarray, distance: float) -> np.ndarray:
    """The same by sweeping along a direction in which hardly any points lie side by side."""
    direction = 1.0 / np.sqrt(np.arange(points.shape[1]) + 1.37)
    direction /= np.sqrt((direction**2).sum())
    along = points @ direction
    order = np.argsort(along, kind="stable")
    along, ranked = along[order], points[order]
    reach = distance + 4 * np.spacing(np.abs(points).max(initial=0.0))
    found = []
    for step in range(1, len(points)):
        behind = np.flatnonzero(along[step:] - along[:-step] <= reach)
        if not len(behind):
            break
        away = ranked[behind + step] - ranked[behind]
        behind = behind[np.sqrt((away**2).sum(axis=1)) <= distance]
        found.append(np.sort([order[behind], order[behind + step]], axis=0))
    return _sorted_rows(np.concatenate(found, axis=1) if found else np.zeros((2, 0)))


def _diagonals(lo: np.ndarray, hi: np.ndarray) -> np.ndarray:
    # A search tree looks at envelopes only, and a diagonal has its box's envelope.
    from shapely import linestrings

    return linestrings(np.stack([lo, hi], axis=1))


def _sorted_rows(columns: np.ndarray) -> np.ndarray:
    order = np.lexsort((columns[1], columns[0]))
    return np.ascontiguousarray(columns[:, order].T.astype(np.int64))

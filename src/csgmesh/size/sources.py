"""Sizes that grow with the distance from pieces of a boundary, searchable."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels

PER_LEAF = 4
#: Points in one call of the kernel, which takes about a tenth of a second.
_BATCH = 1 << 16
#: Bits of each coordinate in the order of the pieces along a curve.
_BITS = 16


class GradedSources:
    """``h(x) = min over pieces of value + growth * max(0, distance - reach)``.

    A minimum of functions that grow no faster than `growth` grows no faster itself. A point is
    answered by a search tree, in O(log n) as a rule.

    Parameters
    ----------
    pieces : (m, 2, 2) float64
        Both ends of straight pieces, which may be points.
    value : (m,) float64
        Size on each piece.
    reach : (m,) float64 or float
        Distance from the piece up to which its value holds.
    growth : float
        Growth of the size per unit of length beyond.

    Examples
    --------
    >>> wall = GradedSources(np.array([[[0.0, 0.0], [1.0, 0.0]]]), np.array([0.1]), 0.0, 0.5)
    >>> wall(np.array([[0.5, 0.0], [0.5, 0.4], [2.0, 0.0]]))
    array([0.1, 0.3, 0.6])
    """

    def __init__(
        self, pieces: np.ndarray, value: np.ndarray, reach: np.ndarray | float, growth: float
    ) -> None:
        m = len(pieces)
        self.order = along_a_curve(pieces.mean(axis=1))
        n_leaves = 1
        while n_leaves * PER_LEAF < m:
            n_leaves *= 2
        room = n_leaves * PER_LEAF
        self.growth = float(growth)
        self._piece = np.zeros((room, 2, 2))
        self._piece[:m] = pieces[self.order]
        self._value = np.full(room, np.inf)
        self._value[:m] = value[self.order]
        self._reach = np.zeros(room)
        self._reach[:m] = np.broadcast_to(reach, m)[self.order]
        low = np.full((room, 2), np.inf)
        high = np.full((room, 2), -np.inf)
        low[:m], high[:m] = self._piece[:m].min(axis=1), self._piece[:m].max(axis=1)
        self._box = np.concatenate(
            [box_nodes(low, np.minimum, np.inf), box_nodes(high, np.maximum, -np.inf)], axis=1
        )
        self._low = box_nodes(self._value[:, None], np.minimum, np.inf)[:, 0]
        self._far = box_nodes(self._reach[:, None], np.maximum, 0.0)[:, 0]

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Sizes at points (n, 2), as (n,)."""
        return self.lowest(points)[0]

    def lowest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sizes at points (n, 2), and the piece that each is due to."""
        # Neighbours ask in turn: each finds what it needs in the processor's cache.
        turn = along_a_curve(points)
        flat = np.ascontiguousarray(points[turn], float).reshape(-1)
        value, which = np.empty(len(turn)), np.empty(len(turn), np.int64)
        for start in range(0, len(value), _BATCH):
            part = slice(start, start + _BATCH)
            kernels.lowest_sources(
                self._piece.reshape(-1),
                self._value,
                self._reach,
                self._box.reshape(-1),
                self._low,
                self._far,
                self.growth,
                flat[2 * start : 2 * (start + _BATCH)],
                value[part],
                which[part],
            )
        out_value, out_which = np.empty_like(value), np.empty_like(which)
        out_value[turn], out_which[turn] = value, self.order[which]
        return out_value, out_which


def box_nodes(leaf: np.ndarray, reduce: np.ufunc, empty: float) -> np.ndarray:
    """Values of all nodes of a tree, from those of its pieces; node 0 is none."""
    level = reduce.reduce(leaf.reshape(-1, PER_LEAF, leaf.shape[1]), axis=1)
    levels = [level]
    while len(level) > 1:
        level = reduce(level[0::2], level[1::2])
        levels.append(level)
    none = np.full((1, leaf.shape[1]), empty)
    return np.ascontiguousarray(np.concatenate([none, *levels[::-1]]))


def along_a_curve(points: np.ndarray) -> np.ndarray:
    """The order of points along Morton's curve."""
    if not len(points):
        return np.zeros(0, np.int64)
    dim = points.shape[1]
    low = points.min(axis=0)
    extent = float((points.max(axis=0) - low).max())
    scale = ((1 << _BITS) - 1) / extent if extent > 0 else 0.0
    square = ((points - low) * scale).astype(np.int64)
    key = np.zeros(len(points), np.int64)
    for bit in range(_BITS):
        for axis in range(dim):
            key |= ((square[:, axis] >> bit) & 1) << (dim * bit + axis)
    return np.argsort(key, kind="stable")

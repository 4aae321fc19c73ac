"""Sizes that grow with the distance from pieces of a boundary, searchable."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.size.box_tree import GradedTree, along_a_curve

#: Points in one call of the kernel, which takes about a tenth of a second.
_BATCH = 1 << 16


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
        self._tree = GradedTree(pieces, value, reach)
        self.growth = float(growth)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Sizes at points (n, 2), as (n,)."""
        return self.lowest(points)[0]

    def lowest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sizes at points (n, 2), and the piece that each is due to."""
        # Neighbours ask in turn: each finds what it needs in the processor's cache.
        tree, turn = self._tree, along_a_curve(points)
        flat = np.ascontiguousarray(points[turn], float).reshape(-1)
        value, which = np.empty(len(turn)), np.empty(len(turn), np.int64)
        for start in range(0, len(value), _BATCH):
            part = slice(start, start + _BATCH)
            kernels.lowest_sources(
                tree.corners.reshape(-1),
                tree.value,
                tree.reach,
                tree.boxes.reshape(-1),
                tree.low,
                tree.far,
                self.growth,
                flat[2 * start : 2 * (start + _BATCH)],
                value[part],
                which[part],
            )
        out_value, out_which = np.empty_like(value), np.empty_like(which)
        out_value[turn], out_which[turn] = value, tree.order[which]
        return out_value, out_which

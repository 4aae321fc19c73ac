"""Triangles in space, searchable along rays."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.size.sources import PER_LEAF, along_a_curve, box_nodes

#: Rays in one call of the kernel, which takes about a tenth of a second.
_BATCH = 1 << 16


class FacetTree:
    """Triangles in a complete binary tree of boxes, along a space-filling curve.

    Parameters
    ----------
    triangles : (m, 3, 3) float64
        Corners; all three the same, or two of them, for points and straight pieces.

    Attributes
    ----------
    order : (m,) int64
        The triangle at each place of the tree.
    corners : (room, 9) float64
    boxes : (2 n_leaves, 6) float64
        Lower and upper corner of each node, of which number 0 is none.

    Examples
    --------
    >>> floor = FacetTree(np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]]))
    >>> floor.first_met(np.array([[1.0, 1, 3]]), np.array([[0.0, 0, -1]]), 0.0, 9.0)
    (array([3.]), array([0]))
    """

    def __init__(self, triangles: np.ndarray) -> None:
        m = len(triangles)
        a, b, c = (triangles[:, k] for k in range(3))
        self.order = along_a_curve((a + b + c) / 3.0)
        n_leaves = 1
        while n_leaves * PER_LEAF < m:
            n_leaves *= 2
        self.room = n_leaves * PER_LEAF
        self.corners = np.zeros((self.room, 9))
        self.corners[:m] = triangles.reshape(-1, 9)[self.order]
        low = self.places(np.minimum(np.minimum(a, b), c)[self.order], np.inf)
        high = self.places(np.maximum(np.maximum(a, b), c)[self.order], -np.inf)
        self.boxes = np.concatenate(
            [box_nodes(low, np.minimum, np.inf), box_nodes(high, np.maximum, -np.inf)], axis=1
        )
        # No ray meets a box at infinity, while one from infinity to minus infinity is everywhere.
        self.boxes[self.boxes[:, 0] > self.boxes[:, 3]] = np.inf

    def places(self, values: np.ndarray, empty: float) -> np.ndarray:
        """Values (m, k) in the tree's order with those of the places that nothing takes."""
        out = np.full((self.room, values.shape[1]), empty)
        out[: len(values)] = values
        return out

    def first_met(
        self,
        starts: np.ndarray,
        ways: np.ndarray,
        least: float,
        reach: np.ndarray | float,
    ) -> tuple[np.ndarray, np.ndarray]:
        """What rays meet first.

        Parameters
        ----------
        starts, ways : (k, 3) float64
            Where they begin, and unit vectors along them.
        least : float
            Distance from its start up to which a ray sees nothing.
        reach : (k,) float64 or float
            How far each is looked along.

        Returns
        -------
        distance : (k,) float64
            Infinite where nothing was met.
        triangle : (k,) int64
            -1 where nothing was met.
        """
        n = len(starts)
        turn = along_a_curve(starts)
        place = np.ascontiguousarray(starts[turn], float).reshape(-1)
        way = np.ascontiguousarray(ways[turn], float).reshape(-1)
        found = np.array(np.broadcast_to(reach, n)[turn], float)
        met = np.full(n, -1)
        for start in range(0, n, _BATCH):
            stop = min(start + _BATCH, n)
            kernels.first_met(
                self.corners.reshape(-1),
                self.boxes.reshape(-1),
                place[3 * start : 3 * stop],
                way[3 * start : 3 * stop],
                least,
                found[start:stop],
                met[start:stop],
            )
        found[met < 0] = np.inf
        distance, which = np.empty(n), np.empty(n, np.int64)
        distance[turn] = found
        which[turn] = np.where(met >= 0, self.order[met], -1)
        return distance, which

"""Triangles in space, searchable along rays."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.size.box_tree import BoxTree, along_a_curve

#: Rays in one call of the kernel, which takes about a tenth of a second.
_BATCH = 1 << 16


class FacetTree(BoxTree):
    """Triangles in a tree of boxes.

    Parameters
    ----------
    triangles : (m, 3, 3) float64
        Corners; all three the same, or two of them, for points and straight pieces.

    Examples
    --------
    >>> floor = FacetTree(np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]]))
    >>> floor.first_met(np.array([[1.0, 1, 3]]), np.array([[0.0, 0, -1]]), 0.0, 9.0)
    (array([3.]), array([0]))
    """

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

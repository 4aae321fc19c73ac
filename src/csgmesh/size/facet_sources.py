"""Sizes in space that grow with the distance from pieces of a boundary, searchable."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.size.box_tree import GradedTree, along_a_curve
from csgmesh.size.field import Source
from csgmesh.size.sources import GradedSources

#: Points in one call of the kernel, which takes about a tenth of a second.
_BATCH = 1 << 15


class GradedFacets:
    """``h(x) = min over triangles of value + growth * max(0, distance - reach)``, in space.

    As `GradedSources` in the plane.

    Parameters
    ----------
    triangles : (m, 3, 3) float64
        Their corners.
    value : (m,) float64
        Size on each.
    reach : (m,) float64 or float
        Distance up to which its value holds.
    growth : float
        Growth of the size per unit of length beyond.

    Examples
    --------
    >>> floor = np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]]])
    >>> GradedFacets(floor, np.array([0.1]), 0.5, 0.5)(np.array([[1.0, 1, 0], [1, 1, 1.5]]))
    array([0.1, 0.6])
    """

    def __init__(
        self, triangles: np.ndarray, value: np.ndarray, reach: np.ndarray | float, growth: float
    ) -> None:
        self._tree = GradedTree(triangles, value, reach)
        self.growth = float(growth)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Sizes at points (n, 3), as (n,)."""
        tree, turn = self._tree, along_a_curve(points)
        flat = np.ascontiguousarray(points[turn], float).reshape(-1)
        value = np.empty(len(turn))
        for start in range(0, len(value), _BATCH):
            kernels.lowest_facets(
                tree.corners.reshape(-1),
                tree.value,
                tree.reach,
                tree.boxes.reshape(-1),
                tree.low,
                tree.far,
                self.growth,
                flat[3 * start : 3 * (start + _BATCH)],
                value[start : start + _BATCH],
            )
        out = np.empty_like(value)
        out[turn] = value
        return out


def graded(
    pieces: np.ndarray, value: np.ndarray, reach: np.ndarray | float, growth: float
) -> Source:
    """The lowest of sizes that grow from pieces: segments (m, 2, 2) or triangles (m, 3, 3)."""
    if pieces.shape[1] == 2:
        return GradedSources(pieces, value, reach, growth)
    return GradedFacets(pieces, value, reach, growth)

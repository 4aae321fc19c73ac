"""Sizes in space that grow with the distance from pieces of a boundary, searchable."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.size.facet_tree import FacetTree
from csgmesh.size.field import Source
from csgmesh.size.sources import GradedSources, along_a_curve, box_nodes

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
        self._tree = tree = FacetTree(triangles)
        self.growth = float(growth)
        reaches = np.broadcast_to(np.asarray(reach, float), len(triangles))
        self._value = tree.places(value[tree.order][:, None], np.inf)
        self._reach = tree.places(reaches[tree.order][:, None], 0.0)
        self._low = box_nodes(self._value, np.minimum, np.inf).reshape(-1)
        self._far = box_nodes(self._reach, np.maximum, 0.0).reshape(-1)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Sizes at points (n, 3), as (n,)."""
        turn = along_a_curve(points)
        flat = np.ascontiguousarray(points[turn], float).reshape(-1)
        value = np.empty(len(turn))
        for start in range(0, len(value), _BATCH):
            kernels.lowest_facets(
                self._tree.corners.reshape(-1),
                self._value.reshape(-1),
                self._reach.reshape(-1),
                self._tree.boxes.reshape(-1),
                self._low,
                self._far,
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

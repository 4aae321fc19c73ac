"""A size by the curvature of the boundary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.size.bending import curvature_radii
from csgmesh.size.facet_sources import GradedFacets
from csgmesh.size.field import SizeField, Source, UniformSize, positive
from csgmesh.size.near import GRADATION
from csgmesh.size.pieces import FINER, boundary_pieces, is_bent
from csgmesh.size.sources import GradedSources

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg


@dataclass(frozen=True)
class CurvatureSize(SizeField):
    """As many edges as wanted on a full circle of the boundary's curvature, growing away from it.

    On a curve of radius of curvature r the size is ``2 π r / points_per_circle``. Straight segments
    ask for nothing; where there are no curves the size is the domain's diagonal. In space r is the
    smallest radius of curvature of the exact surface, seen in the middle of each facet.

    Parameters
    ----------
    points_per_circle : float, default 24
        Edges on a full circle, at least 3.
    gradation : float, default 0.3
        Growth of the size per unit of distance from the curve.

    Raises
    ------
    SizeError
        If a number is out of range.

    Examples
    --------
    >>> import csgmesh as cm
    >>> plate = cm.Box((0, 0), (4, 2)) - cm.Disk((2, 1), 0.5)
    >>> h = cm.CurvatureSize(points_per_circle=100).bind(cm.evaluate(plate))
    >>> h(np.array([[2.5, 1.0], [3.5, 1.0]])).round(6)
    array([0.031416, 0.331416])
    """

    points_per_circle: float = 24.0
    gradation: float = GRADATION

    def __post_init__(self) -> None:
        number = positive(self.points_per_circle, "CurvatureSize: points_per_circle")
        if number < 3:
            from csgmesh.errors import SizeError

            raise SizeError(f"CurvatureSize: points_per_circle must be at least 3; got {number:g}")
        object.__setattr__(self, "points_per_circle", number)
        object.__setattr__(self, "gradation", positive(self.gradation, "CurvatureSize: gradation"))

    def bind(self, domain: Pslg) -> Source:
        """The size by distance from curves."""
        if isinstance(domain, Plc):
            return self._in_space(domain)
        bent = np.flatnonzero(is_bent(domain))
        if not len(bent):
            return UniformSize(domain.diagonal)
        radius = np.minimum(_radii(domain, bent).ravel(), domain.diagonal)
        value = 2 * np.pi * radius / self.points_per_circle
        return GradedSources(boundary_pieces(domain, bent)[0], value, 0.0, self.gradation)

    def _in_space(self, domain: Plc) -> Source:
        radius = curvature_radii(domain)
        bent = np.flatnonzero(np.isfinite(radius))
        if not len(bent):
            return UniformSize(domain.diagonal)
        value = 2 * np.pi * np.minimum(radius[bent], domain.diagonal) / self.points_per_circle
        facets = domain.points[domain.facets[bent]]
        return GradedFacets(facets, value, 0.0, self.gradation)


def _radii(domain: Pslg, bent: np.ndarray) -> np.ndarray:
    """Smallest radius of curvature on each piece of curved segments, (k, FINER)."""
    # Seen at both ends and in the middle of each piece.
    share = np.linspace(0.0, 1.0, 2 * FINER + 1)
    begin, end = domain.segment_interval[bent].T
    t = (begin[:, None] + (end - begin)[:, None] * share).ravel()
    curve = np.repeat(domain.segment_curve[bent], len(share))
    first, second = domain.curves.derivatives(curve, t), domain.curves.second_derivatives(curve, t)
    turn = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    speed = np.hypot(first[:, 0], first[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = speed**3 / turn
    # Where a curve stops, as at a cusp of a Bézier curve, there is no circle to be measured.
    radius = np.where(speed > 0, radius, np.inf)
    radius = np.where(np.isnan(radius), np.inf, radius).reshape(len(bent), -1)
    return np.minimum.reduce([radius[:, k : k + 2 * FINER : 2] for k in range(3)])

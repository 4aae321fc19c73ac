"""A size by the local feature size: a wanted number of cells across gaps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.size.facet_sources import GradedFacets
from csgmesh.size.field import SizeField, Source, UniformSize, positive
from csgmesh.size.gaps import gaps
from csgmesh.size.near import GRADATION
from csgmesh.size.sources import GradedSources
from csgmesh.size.thickness import walls

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg


#: In space: longest piece of a boundary looked at first, and the narrowest gap that counts, as
#: shares of the diagonal.
_SPACING = 0.05
_LEAST = 1e-3


@dataclass(frozen=True)
class FeatureSize(SizeField):
    """A wanted number of cells across every gap, growing away from it.

    A gap is where two features of the boundary face each other across the domain: its width is the
    diameter of the largest disk in the domain that touches both. Between walls that is Ruppert's
    local feature size on either of them. Features that meet in a corner are no gap there, however
    small their angle (Ruppert counts pairs that are not incident), nor do neighbouring chords of a
    curve make one. In each gap, and in the disk, the size is the width divided by `cells`; from
    there it grows. Where there is no gap at all the size is the domain's diagonal.

    In space the width is the distance along the normal of a facet to what faces it, if faces open
    by less than 45 degrees there, and by less than half of the angle in which they meet in an edge.
    Gaps below a thousandth of the diagonal count as that wide.

    Parameters
    ----------
    cells : float, default 3
        Cells wanted across a gap.
    gradation : float, default 0.3
        Growth of the size per unit of distance from the gap.

    Raises
    ------
    SizeError
        If a number is not positive and finite.

    References
    ----------
    .. [1] J. Ruppert, "A Delaunay refinement algorithm for quality 2-dimensional mesh generation",
       J. Algorithms 18 (1995).
    .. [2] J. Ma, S. W. Bae, S. Choi, "3D medial axis point approximation using nearest neighbors
       and the normal field", The Visual Computer 28 (2012).

    Examples
    --------
    >>> import numpy as np
    >>> import csgmesh as cm
    >>> slot = cm.Box((0, 0), (4, 0.3)) | cm.Box((4, -1), (6, 1))
    >>> h = cm.FeatureSize(cells=3).bind(cm.evaluate(slot))
    >>> h(np.array([[2.0, 0.0], [2.0, 0.15], [2.0, 0.3]])).round(6)
    array([0.1, 0.1, 0.1])
    """

    cells: float = 3.0
    gradation: float = GRADATION

    def __post_init__(self) -> None:
        object.__setattr__(self, "cells", positive(self.cells, "FeatureSize: cells"))
        object.__setattr__(self, "gradation", positive(self.gradation, "FeatureSize: gradation"))

    def bind(self, domain: Pslg) -> Source:
        """The size by distance from the gaps."""
        if isinstance(domain, Plc):
            return self._in_space(domain)
        bridges, widths = gaps(domain)
        if not len(bridges):
            return UniformSize(domain.diagonal)
        return GradedSources(bridges, widths / self.cells, 0.5 * widths, self.gradation)

    def _in_space(self, domain: Plc) -> Source:
        diagonal = domain.diagonal
        found = walls(domain, lambda p: np.full(len(p), diagonal), _SPACING, 1.0, _LEAST * diagonal)
        if not len(found.width):
            return UniformSize(diagonal)
        width = np.maximum(found.width, _LEAST * diagonal)
        return GradedFacets(found.triangles, width / self.cells, 0.5 * width, self.gradation)

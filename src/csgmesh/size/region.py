"""A size in named regions, growing away from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.domain.names import find_names
from csgmesh.domain.plc import Plc
from csgmesh.errors import SizeError
from csgmesh.size.facet_sources import graded
from csgmesh.size.field import SizeField, Source, positive
from csgmesh.size.near import GRADATION
from csgmesh.size.pieces import boundary_pieces

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg


@dataclass(frozen=True)
class RegionSize(SizeField):
    """A size in each of some regions, growing with the distance from them.

    Parameters
    ----------
    sizes : mapping of str to float
        Wanted edge length by name, prefix or glob of regions.
    gradation : float, default 0.3
        Growth of the size per unit of distance from a region.

    Raises
    ------
    SizeError
        If a number is not positive and finite, or nothing is named.
    NameLookupError
        On a domain without such a region.

    Examples
    --------
    >>> import csgmesh as cm
    >>> rock, core = cm.Box((0, 0), (4, 2)), cm.Disk((2, 1), 0.5)
    >>> domain = cm.evaluate(cm.Regions({"rock": rock, "core": core}))
    >>> h = cm.RegionSize({"core": 0.1}).bind(domain)
    >>> h(np.array([[2.0, 1.0], [3.5, 1.0]])).round(6)
    array([0.1, 0.4])
    """

    sizes: Mapping[str, float]
    gradation: float = GRADATION

    def __post_init__(self) -> None:
        given: Any = self.sizes
        if isinstance(given, str) or not isinstance(given, (Mapping, tuple, list)):
            raise SizeError(f"RegionSize: sizes must map names of regions to sizes; got {given!r}")
        pairs = tuple(given.items() if isinstance(given, Mapping) else given)
        if not pairs:
            raise SizeError("RegionSize: sizes must name at least one region; got none")
        checked = tuple((str(n), positive(h, f"RegionSize: size of {n!r}")) for n, h in pairs)
        object.__setattr__(self, "sizes", checked)
        object.__setattr__(self, "gradation", positive(self.gradation, "RegionSize: gradation"))

    def bind(self, domain: Pslg) -> Source:
        """The size by region, and by distance from the regions' boundaries."""
        pieces, values = [], []
        inside = np.full(len(domain.region_names) + 1, np.inf)
        for name, size in dict(self.sizes).items():
            found = find_names(name, domain.region_names, what="region")
            numbers = [k for k, n in enumerate(domain.region_names) if n in found]
            inside[numbers] = np.minimum(inside[numbers], size)
            around = region_pieces(domain, np.array(numbers))
            pieces.append(around)
            values.append(np.full(len(around), size))
        away = graded(np.concatenate(pieces), np.concatenate(values), 0.0, self.gradation)
        # The last entry, that of number -1, is for points outside the domain.
        return lambda points: np.minimum(away(points), inside[regions_at(domain, points)])


def region_pieces(domain: Pslg | Plc, regions: np.ndarray) -> np.ndarray:
    """Pieces (k, 2, 2) of all segments, or all facets, with one of the regions on a side."""
    if isinstance(domain, Plc):
        beside = np.isin(domain.facet_region, regions).any(axis=1)
        return domain.points[domain.facets[beside]]
    beside = np.isin(domain.segment_region, regions).any(axis=1)
    return boundary_pieces(domain, np.flatnonzero(beside))[0]


def regions_at(domain: Pslg | Plc, points: np.ndarray) -> np.ndarray:
    """Region of each point, -1 outside."""
    if domain.oracle is None:
        raise SizeError("sizes by region need a domain that knows the regions of points")
    return domain.oracle.region(points)

"""A size on named boundaries, growing away from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.domain.names import find_markers
from csgmesh.domain.plc import Plc
from csgmesh.errors import SizeError
from csgmesh.size.facet_sources import graded
from csgmesh.size.field import SizeField, Source, positive
from csgmesh.size.pieces import boundary_pieces

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg

#: Growth of a size away from what it is tied to, where nothing else is said: that of the meshers.
GRADATION = 0.3


@dataclass(frozen=True)
class NearSize(SizeField):
    """A size on named boundaries, growing with the distance from them.

    Distances are from chords a sixteenth of `evaluate`'s deviation off the exact curves, in space
    from facets within its deviation of the exact surfaces.

    Parameters
    ----------
    names : str or sequence of str
        Names, prefixes or globs of boundaries, interfaces and embedded entities.
    size : float
        Wanted edge length there.
    gradation : float, default 0.3
        Growth of the size per unit of distance.
    within : float, default 0
        Distance up to which the size holds before it grows.

    Raises
    ------
    SizeError
        If a number is not positive and finite, `within` negative, or there are no names.
    NameLookupError
        On a domain without such a name.

    Examples
    --------
    >>> import csgmesh as cm
    >>> plate = cm.Box((0, 0), (4, 2)) - cm.Disk((2, 1), 0.5, name="hole")
    >>> h = cm.NearSize("hole", 0.03, gradation=0.2).bind(cm.evaluate(plate))
    >>> h(np.array([[2.5, 1.0], [3.5, 1.0]])).round(6)
    array([0.03, 0.23])
    """

    names: str | Sequence[str]
    size: float
    gradation: float = GRADATION
    within: float = 0.0

    def __post_init__(self) -> None:
        names = (self.names,) if isinstance(self.names, str) else tuple(self.names)
        if not names or not all(isinstance(name, str) for name in names):
            raise SizeError(f"NearSize: names must be one or more strings; got {self.names!r}")
        object.__setattr__(self, "names", names)
        object.__setattr__(self, "size", positive(self.size, "NearSize: size"))
        object.__setattr__(self, "gradation", positive(self.gradation, "NearSize: gradation"))
        if self.within != 0:
            object.__setattr__(self, "within", positive(self.within, "NearSize: within"))

    def bind(self, domain: Pslg) -> Source:
        """The size by distance from the boundaries of these names."""
        found = [find_markers(name, domain.boundary_names) for name in self.names]
        markers = np.unique(np.concatenate(found))
        pieces = marked_pieces(domain, markers)
        if not len(pieces):
            listed = ", ".join(map(repr, self.names))
            raise SizeError(f"NearSize: no part and no point of the domain is named {listed}")
        return graded(pieces, np.full(len(pieces), self.size), self.within, self.gradation)


def marked_pieces(domain: Pslg | Plc, markers: np.ndarray) -> np.ndarray:
    """What carries one of some markers: pieces (k, 2, 2) of segments and points, or facets."""
    if isinstance(domain, Plc):
        return domain.points[domain.facets[np.isin(domain.facet_marker, markers)]]
    segments = np.flatnonzero(np.isin(domain.segment_marker, markers))
    probes = domain.points[np.isin(domain.point_marker, markers) & (domain.point_marker >= 0)]
    pieces = boundary_pieces(domain, segments)[0]
    return np.concatenate([pieces, np.stack([probes, probes], axis=1)])

"""Sizes by name as a field: what a mapping means at any point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import SizeError
from csgmesh.size.combinations import as_field
from csgmesh.size.facet_sources import graded
from csgmesh.size.field import SizeField, Source
from csgmesh.size.near import GRADATION, marked_pieces
from csgmesh.size.region import region_pieces, regions_at
from csgmesh.size.resolve import evaluate, meaning

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg


@dataclass(frozen=True)
class NamedSizes(SizeField):
    """A mapping of names to sizes as a field, to be combined with others.

    On its own a mapping is given to `generate` as it is. As a field it says the same at points:
    the default, in the regions named what is said there, and on the boundaries named what is said
    there, growing away from both.

    Parameters
    ----------
    sizes : mapping of str to float, callable or SizeField
        By name, prefix or glob of boundaries and regions, and ``"default"``.
    gradation : float, default 0.3
        Growth away from what is named.

    Raises
    ------
    SizeError
        If a value is no size.
    NameLookupError
        On a domain without such a name.

    Examples
    --------
    >>> import csgmesh as cm
    >>> domain = cm.evaluate(cm.Box((0, 0), (1, 1)))
    >>> h = NamedSizes({"box.left": 0.1, "default": 0.3}).bind(domain)
    >>> h(np.array([[0.0, 0.5], [0.5, 0.5], [1.0, 0.5]])).round(6)
    array([0.1 , 0.25, 0.3 ])
    """

    sizes: Mapping[str, Any]
    gradation: float = GRADATION

    def __post_init__(self) -> None:
        given: Any = self.sizes
        pairs = tuple(given.items() if isinstance(given, Mapping) else given)
        if not all(isinstance(name, str) for name, _ in pairs):
            raise SizeError(f"keys of a size are names of boundaries or regions; got {given!r}")
        checked = tuple((name, as_field(value, f"size of {name!r}")) for name, value in pairs)
        object.__setattr__(self, "sizes", checked)

    def bind(self, domain: Pslg) -> Source:
        """The sizes by place."""
        default: Source | None = None
        regions: list[tuple[np.ndarray, Source]] = []
        pieces, values = [np.zeros((0, domain.dim, domain.dim))], [np.zeros(0)]
        for name, field in dict(self.sizes).items():
            source = field.bind(domain)
            if name == "default":
                default = source
                continue
            markers, numbers = meaning(name, domain)
            around = marked_pieces(domain, markers)
            if len(numbers):
                regions.append((numbers, source))
                around = np.concatenate([around, region_pieces(domain, numbers)])
            pieces.append(around)
            ends = evaluate(source, around.reshape(-1, domain.dim)).reshape(len(around), -1)
            values.append(ends.min(axis=1))
        away = None
        if sum(map(len, pieces)):
            all_pieces, all_values = np.concatenate(pieces), np.concatenate(values)
            away = graded(all_pieces, all_values, 0.0, self.gradation)
        return _Bound(domain, default, tuple(regions), away)


@dataclass(frozen=True, eq=False)
class _Bound:
    """Named sizes on a domain."""

    domain: Pslg
    default: Source | None
    regions: tuple[tuple[np.ndarray, Source], ...]
    away: Source | None

    def __call__(self, points: np.ndarray) -> np.ndarray:
        largest = self.domain.diagonal
        value = np.full(len(points), largest) if self.default is None else self.default(points)
        if self.regions:
            region = regions_at(self.domain, points)
            said = np.full(len(points), np.inf)
            for numbers, source in self.regions:
                at = np.flatnonzero(np.isin(region, numbers))
                said[at] = np.minimum(said[at], source(points[at]))
            value = np.where(np.isfinite(said), said, value)
        return value if self.away is None else np.minimum(value, self.away(points))

"""How fine: size fields, and what a `size=` argument means for a domain."""

from csgmesh.size.field import SizeField, UniformSize
from csgmesh.size.resolve import ResolvedSize, resolve

__all__ = ["ResolvedSize", "SizeField", "UniformSize", "resolve"]

"""Linear trees: the plane cut into leaves, each a quarter of the one it came from."""

from csgmesh.tree.linear import LinearTree

__all__ = ["LinearTree"]

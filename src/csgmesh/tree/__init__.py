"""Linear trees: the plane or space cut into leaves, each a part of the one it came from."""

from csgmesh.tree.linear import LinearTree

__all__ = ["LinearTree"]

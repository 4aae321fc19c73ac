"""Pictures: the only door to matplotlib."""

from csgmesh.viz.drawing import draw

__all__ = ["draw"]

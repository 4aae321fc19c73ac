"""Shapes from other programs' files."""

from csgmesh.io.solids.files import read_shape

__all__ = ["read_shape"]

"""Tetrahedra that conform to a surface mesh."""

from csgmesh.meshers.tetrahedra.conforming import tetrahedralize
from csgmesh.meshers.tetrahedra.result import Tetrahedra

__all__ = ["Tetrahedra", "tetrahedralize"]

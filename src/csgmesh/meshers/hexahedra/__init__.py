"""Hexahedra from a grid: a core of cells inside, sheets along the boundary, relaxation."""

from csgmesh.meshers.hexahedra.mesher import hexahedral_mesh

__all__ = ["hexahedral_mesh"]

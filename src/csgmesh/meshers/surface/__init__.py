"""Meshes of the boundaries of solids."""

from csgmesh.meshers.surface.meshing import surface_mesh

__all__ = ["surface_mesh"]

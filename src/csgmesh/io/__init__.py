"""Mesh files: one module a format, chosen by suffix; shapes' files; other libraries' meshes."""

from csgmesh.io.boundary_surface import to_pyvista, to_trimesh
from csgmesh.io.meshio_mesh import from_meshio, to_meshio
from csgmesh.io.registry import FORMATS, SOLID_FORMATS, read, write
from csgmesh.io.skfem_mesh import to_skfem
from csgmesh.io.solids import read_shape

__all__ = [
    "FORMATS",
    "SOLID_FORMATS",
    "from_meshio",
    "read",
    "read_shape",
    "to_meshio",
    "to_pyvista",
    "to_skfem",
    "to_trimesh",
    "write",
]

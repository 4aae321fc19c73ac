"""Mesh files: one module a format, chosen by suffix; and other libraries' meshes."""

from csgmesh.io.meshio_mesh import from_meshio, to_meshio
from csgmesh.io.registry import FORMATS, read, write
from csgmesh.io.skfem_mesh import to_skfem
from csgmesh.io.solids import read_shape

__all__ = ["FORMATS", "from_meshio", "read", "read_shape", "to_meshio", "to_skfem", "write"]

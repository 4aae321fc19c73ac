"""STL: triangles without names, or as text with a solid a boundary."""

from __future__ import annotations

from pathlib import Path

from csgmesh.errors import InputError
from csgmesh.io import surface_formats, through_meshio
from csgmesh.mesh import Mesh
from csgmesh.options import check_flag


def write(path: Path, mesh: Mesh, *, binary: bool | None = None) -> None:
    """Write the boundary of a mesh of space, or the triangles of a plane one.

    Parameters
    ----------
    binary : bool
        Of meshes of space; default True. Text keeps names: each boundary is a solid.
    """
    if mesh.dim == 2:
        if binary is not None:
            raise InputError("an .stl file of a plane mesh is text; leave out binary")
        through_meshio.write(path, mesh)
    elif binary is None or check_flag("binary", binary):
        surface_formats.write_binary_stl(path, mesh)
    else:
        surface_formats.write_ascii_stl(path, mesh)


def read(path: Path) -> Mesh:
    """Read a plane mesh; solids are shapes, for `read_shape`."""
    return through_meshio.read(path)

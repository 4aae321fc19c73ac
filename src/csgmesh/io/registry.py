"""Which module reads and writes which suffix.

A format is a module with ``write(path, mesh, *, options…)`` and ``read(path) -> Mesh``, and a line
in `FORMATS`. The keyword-only arguments of its ``write`` are the options a user may give.
"""

from __future__ import annotations

import importlib
import inspect
import os
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType, ModuleType

from csgmesh.errors import FileFormatError, InputError
from csgmesh.files import replaced
from csgmesh.mesh import Mesh
from csgmesh.options import check_options, near

_FOREIGN = "csgmesh.io.through_meshio"
_SURFACE = "csgmesh.io.surface_formats"

#: Module of each suffix.
FORMATS: Mapping[str, str] = MappingProxyType(
    {
        ".vtu": "csgmesh.io.vtu",
        ".msh": "csgmesh.io.msh",
        ".npz": "csgmesh.io.npz",
        ".vtk": _FOREIGN,
        ".inp": _FOREIGN,
        ".mesh": _FOREIGN,
        ".bdf": _FOREIGN,
        ".avs": _FOREIGN,
        ".vol": _FOREIGN,
        ".stl": "csgmesh.io.stl",
        ".obj": _SURFACE,
        ".off": _SURFACE,
        ".ply": _SURFACE,
    }
)

#: Formats of solids' surfaces, written only.
SOLID_FORMATS: Mapping[str, str] = MappingProxyType({".3mf": _SURFACE, ".glb": _SURFACE})

_PICTURES = (".png", ".svg", ".pdf", ".jpg", ".jpeg")


def write(path: str | os.PathLike[str], mesh: Mesh, **options: object) -> None:
    """Write a mesh to a file in the format that its suffix names.

    The file appears whole or not at all, and the same mesh gives the same bytes.

    Parameters
    ----------
    path : str or PathLike
        ``.vtu`` (ParaView), ``.msh`` (Gmsh 4.1) and ``.npz`` (everything, lossless) are written
        natively; ``.vtk .inp .mesh .bdf .avs .vol .stl .obj .off .ply`` through meshio. Of a mesh
        of space ``.stl .obj .off .ply .3mf .glb`` hold the outer boundary as triangles: ``.obj``,
        ``.glb`` and text STL with its names as groups, ``.3mf`` with an object a region.
    mesh : Mesh
        What to write.
    **options
        Of the format. ``.vtu``: `compress` (default False), `encoding` ("raw" or "base64"),
        `point_data`, `cell_data` (mappings of names to arrays). ``.msh``: `binary` (default True).
        ``.npz``: `compress`. ``.stl`` of a mesh of space: `binary` (default True). The others have
        none.

    Raises
    ------
    FileFormatError
        If the suffix is unknown, the directory does not exist, or the format cannot hold the mesh.
    InputError
        If an option is unknown.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
    >>> cm.write("/tmp/one.msh", mesh)
    >>> cm.read("/tmp/one.msh").n_cells
    1
    """
    path = Path(path)
    if not isinstance(mesh, Mesh):
        raise InputError(
            f"write({str(path)!r}) needs a Mesh, as csgmesh.generate returns; "
            f"got {type(mesh).__name__}"
        )
    module = _module(path)
    known = [
        p.name
        for p in inspect.signature(module.write).parameters.values()
        if p.kind is inspect.Parameter.KEYWORD_ONLY
    ]
    check_options(options, known, f"a {path.suffix.lower()} file")
    with replaced(path) as temporary:
        module.write(temporary, mesh, **options)


def read(path: str | os.PathLike[str]) -> Mesh:
    """Read a plane mesh, with its names, from a file in the format that its suffix names.

    Facets keep their names; sides that the file does not list are added and called `boundary`, or
    `interface` between two regions. A number without a name becomes `region3` or `boundary3`.

    Parameters
    ----------
    path : str or PathLike
        Suffixes as in `write`; ``.msh`` also of version 2.2.

    Returns
    -------
    Mesh
        Without exact curves, except from ``.npz``.

    Raises
    ------
    FileFormatError
        If there is no such file, or it is not what its suffix says, or is damaged; the message
        says where.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.write("/tmp/one.vtu", cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]}))
    >>> cm.read("/tmp/one.vtu").names
    ('boundary',)
    """
    path = Path(path)
    module = _module(path)
    if path.is_dir():
        raise FileFormatError(f"{path} is a directory, not a file")
    if not path.exists():
        raise FileFormatError(f"{path}: there is no such file")
    try:
        mesh: Mesh = module.read(path)
    except OSError as error:
        raise FileFormatError(f"{path} cannot be read: {error.strerror or error}") from error
    return mesh


def _module(path: Path) -> ModuleType:
    suffix = path.suffix.lower()
    known_formats = {**FORMATS, **SOLID_FORMATS}
    if suffix in known_formats:
        return importlib.import_module(known_formats[suffix])
    if suffix in _PICTURES:
        raise FileFormatError(f"{path}: {suffix} is a picture, not a mesh file; use csgmesh.draw")
    if not suffix:
        raise FileFormatError(f"{path} has no suffix to tell its format; {near('', known_formats)}")
    hint, known = near(suffix, known_formats), ", ".join(known_formats)
    said = f"; {hint}" if hint.startswith("did") else "."
    raise FileFormatError(f"{path}: unknown suffix {suffix!r}{said} Known are {known}")

"""The verb `read_shape`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from csgmesh.csg import Shape
from csgmesh.csg.checks import name as checked_name
from csgmesh.errors import FileFormatError
from csgmesh.options import check_options, check_real, check_whole, near

_SURFACES = (".stl", ".obj", ".ply", ".off", ".3mf")
_SUFFIXES = (*_SURFACES, ".csg")


def read_shape(path: str | os.PathLike[str], *, name: str | None = None, **options: Any) -> Shape:
    """Read a shape from another program's file.

    Surfaces (``.stl .obj .ply .off`` through trimesh, ``.3mf``) become a `FacetedSolid`: vertices
    at one place are merged, triangles without area or given twice dropped, windings made to agree,
    missing triangles and quads filled where they measure at most 15 % of the solid's extent around,
    and coplanar neighbours made one face. Where that does not give a closed surface the file is
    refused with the reason and the place. Groups, objects or solids of the file that close by
    themselves become a union; otherwise they are parts of one boundary. Flat faces have no names
    of their own, unless `split_angle` is given.

    ``.csg`` is the tree that OpenSCAD exports (``openscad -o part.csg part.scad``). Cylinders,
    spheres, circles and revolutions with ``$fn`` of 3 up to `facets_below` are the prisms and
    polyhedra that OpenSCAD makes of them; all others are exact.

    Parameters
    ----------
    path : str or PathLike
    name : str, optional
        Of the whole. Default: what the file calls it, else the file's name without its suffix;
        leaves of a ``.csg`` are called by their kinds.
    split_angle : float, optional
        Of surfaces: degrees. Parts of the boundary end at edges that turn by more than this, and
        are called ``face1``, ``face2``, … in the order of their first triangles.
    facets_below : int, optional
        Of ``.csg``: the largest ``$fn`` that means facets; default 12.

    Returns
    -------
    Shape

    Raises
    ------
    FileFormatError
        If the file is not what its suffix says, encloses no solid, or holds what csgmesh has not
        (``.csg``: with the line).
    InputError
        For unknown options.

    Examples
    --------
    >>> import csgmesh as cm
    >>> text = "difference() { cube(size = [4, 2, 1], center = false); cylinder($fn = 0, $fa = 12,"
    >>> text += " $fs = 2, h = 9, r1 = 0.5, r2 = 0.5, center = true); }"
    >>> _ = open("/tmp/part.csg", "w").write(text)
    >>> cm.read_shape("/tmp/part.csg")
    Box((0, 0, 0), (4, 2, 1)) - Cylinder((0, 0, -4.5), (0, 0, 4.5), 0.5)
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        known = ", ".join(_SUFFIXES)
        raise FileFormatError(f"{path}: shapes are read from {known}; {near(suffix, _SUFFIXES)}")
    if path.is_dir() or not path.exists():
        raise FileFormatError(f"{path}: there is no such file")
    if name is not None:
        checked_name(name, "read_shape")
    known_options = ["facets_below"] if suffix == ".csg" else ["split_angle"]
    check_options(options, known_options, f"a {suffix} file")
    try:
        if suffix == ".csg":
            from csgmesh.io.openscad import openscad_shape

            below = check_whole("facets_below", options.get("facets_below", 12), 0)
            shape = openscad_shape(path, below)
            return shape if name is None else shape.named(name)
        from csgmesh.io.solids.surfaces import surface_solid

        return surface_solid(path, name, _angle(options.get("split_angle")))
    except OSError as problem:
        raise FileFormatError(f"{path} cannot be read: {problem.strerror or problem}") from None


def _angle(value: object) -> float | None:
    if value is None:
        return None
    rule = "more than 0 and less than 180 degrees"
    return check_real("split_angle", value, rule, lambda angle: 0 < angle < 180)

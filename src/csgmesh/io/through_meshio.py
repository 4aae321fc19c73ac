"""Formats that meshio reads and writes, and how names go through them.

==============  ===========  ==============================================================
suffix          format       names
==============  ===========  ==============================================================
``.inp``        Abaqus       element sets of all names, node sets for embedded points; where
                             a region and a boundary share a name, the boundary's set is
                             called ``core.boundary``
``.vtk``        legacy VTK   lost; numbers remain in the cell arrays `region` and `marker`
``.mesh``       Medit        lost; reference r + 1 for region r, and (number of regions) +
                             m + 1 for marker m
``.bdf``        Nastran      lost; property numbers, as for Medit
``.avs``        AVS-UCD      lost; material numbers, as for Medit
``.vol``        Netgen       lost; indices, as for Medit (read as `cd1_1`, `cd2_3`, …)
``.stl .obj``   triangles    lost, with all facets and regions
``.off .ply``
==============  ===========  ==============================================================

A number without a name is read as `region3` or `boundary3`. Gmsh's version 2.2 is read here
too, with its names.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from csgmesh.errors import FileFormatError
from csgmesh.io.meshio_mesh import from_meshio, to_meshio
from csgmesh.mesh import KINDS, Mesh


@dataclass(frozen=True)
class _Foreign:
    """How a format of meshio is used.

    Attributes
    ----------
    module : str
        Of meshio.
    tags : str
        "sets", "arrays", the key of an integer reference, or "" for a format of cells only.
    vertices : bool
        Whether it can list embedded points as cells.
    kinds : tuple of str
        What cells it can hold; empty for all.
    needs : bytes
        A pattern that the file must contain, or meshio would read on at its end for ever.
    """

    module: str
    tags: str
    vertices: bool = False
    kinds: tuple[str, ...] = ()
    needs: bytes = b""


_FORMATS: Mapping[str, _Foreign] = {
    ".vtk": _Foreign("vtk", "arrays", True),
    ".inp": _Foreign("abaqus", "sets"),
    ".mesh": _Foreign("medit", "medit:ref"),
    ".bdf": _Foreign("nastran", "nastran:ref", True, needs=rb"(?s)BEGIN BULK.*^ENDDATA"),
    ".avs": _Foreign("avsucd", "avsucd:material", True),
    ".vol": _Foreign("netgen", "netgen:index", True),
    ".stl": _Foreign("stl", "", kinds=("triangle",)),
    ".obj": _Foreign("obj", "", kinds=("triangle", "quad")),
    ".off": _Foreign("off", "", kinds=("triangle",), needs=rb"(?s)\AOFF\s*$.*^\s*\d"),
    ".ply": _Foreign("ply", "", kinds=("triangle", "quad"), needs=rb"^end_header\s*$"),
    ".msh": _Foreign("gmsh", "gmsh:physical"),
}


def write(path: Path, mesh: Mesh) -> None:
    """Write through meshio; the format is chosen by the suffix."""
    import meshio

    form = _FORMATS[path.suffix.lower()]
    whole = to_meshio(mesh)
    n_blocks = len(whole.cells)
    if not form.tags:
        n_blocks = len(mesh.cells)
    elif not form.vertices:
        n_blocks = len(mesh.cells) + len(mesh.facets)
    blocks = whole.cells[:n_blocks]
    for block in blocks:
        if form.kinds and block.type not in form.kinds:
            raise FileFormatError(
                f"a {path.suffix} file cannot hold cells of kind {block.type!r}; "
                f"only {', '.join(form.kinds)}"
            )
    points = np.zeros((mesh.n_points, 3))
    points[:, : mesh.dim] = mesh.points
    given = meshio.Mesh(
        points,
        [(b.type, b.data.astype(np.int32) if form.module == "ply" else b.data) for b in blocks],
        **_tagged(form, mesh, whole, n_blocks),
    )
    _foreign(path, "written", _library(form).write, given)
    if form.module in ("ply", "obj"):
        _without_date(path)
    if form.module == "abaqus":
        _whole_sets(path)
        if mesh.dim == 3:
            _plain_elements(path)


def read(path: Path) -> Mesh:
    """Read through meshio; the format is chosen by the suffix."""
    form = _FORMATS[path.suffix.lower()]
    if form.needs and not re.search(form.needs, path.read_bytes(), re.MULTILINE):
        raise FileFormatError(f"{path} is no {path.suffix} file, or is cut short")
    return from_meshio(_foreign(path, "read", _library(form).read), path)


def _library(form: _Foreign) -> Any:
    """The module of meshio; Abaqus' pyramids, which it does not know, are told to it."""
    module = importlib.import_module(f"meshio.{form.module}")
    if form.module == "abaqus":
        names = importlib.import_module("meshio.abaqus._abaqus")
        names.meshio_to_abaqus_type.setdefault("pyramid", "C3D5")
        names.abaqus_to_meshio_type.setdefault("C3D5", "pyramid")
    return module


def _tagged(form: _Foreign, mesh: Mesh, whole: Any, n_blocks: int) -> dict[str, Any]:
    data = {key: parts[:n_blocks] for key, parts in whole.cell_data.items()}
    if form.tags == "arrays":
        return {"cell_data": data}
    if form.tags == "sets":
        return {"cell_sets": _sets(mesh, whole, n_blocks), "point_sets": _point_sets(mesh)}
    if not form.tags:
        return {}
    shift = len(mesh.region_names) + 1
    pairs = zip(data["region"], data["marker"], strict=True)
    return {"cell_data": {form.tags: [np.where(r >= 0, r + 1, m + shift) for r, m in pairs]}}


def _sets(mesh: Mesh, whole: Any, n_blocks: int) -> dict[str, list[np.ndarray]]:
    sets: dict[str, list[np.ndarray]] = {}
    empty = [np.zeros(0, np.int64)] * n_blocks
    for name, parts in whole.cell_sets.items():
        for block, members in enumerate(parts[:n_blocks]):
            if len(members):
                is_facet = KINDS[whole.cells[block].type].dim < mesh.dim
                shared = is_facet and name in mesh.region_names
                target = sets.setdefault(f"{name}.boundary" if shared else name, list(empty))
                target[block] = members
    return sets


def _point_sets(mesh: Mesh) -> dict[str, np.ndarray]:
    sets: dict[str, list[int]] = {}
    for point in np.flatnonzero(mesh.point_marker >= 0).tolist():
        for name in mesh.boundary_names[mesh.point_marker[point]]:
            sets.setdefault(name, []).append(point)
    return {name: np.array(points) for name, points in sets.items()}


def _foreign(path: Path, done: str, function: Any, *args: Any) -> Any:
    """Call meshio, whose errors on bad files are of every kind, and now and then an exit."""
    try:
        with np.errstate(all="ignore"):
            return function(str(path), *args)
    except (Exception, SystemExit) as error:
        said = str(error).strip() or type(error).__name__
        raise FileFormatError(f"{path} cannot be {done} as {path.suffix}: {said}") from error


def _without_date(path: Path) -> None:
    """Take the time of writing out of a header: equal meshes must give equal bytes."""
    text = path.read_bytes()
    path.write_bytes(re.sub(rb"(Created by meshio)[^\n]*", rb"\1", text, count=1))


def _whole_sets(path: Path) -> None:
    """Make one set of those that have one name.

    meshio writes a set a kind of cell. Abaqus adds them up; meshio itself, when it reads them,
    keeps the last.
    """
    head, *sets = path.read_text().split("*ELSET, ELSET=")
    if not sets:
        return
    last, star, tail = sets[-1].partition("*NSET")
    sets[-1] = last
    rows: dict[str, list[str]] = {}
    for entry in sets:
        name, _, numbers = entry.partition("\n")
        rows.setdefault(name, []).append(numbers.strip())
    joined = "".join(f"*ELSET, ELSET={k}\n" + ",\n".join(v) + "\n" for k, v in rows.items())
    path.write_text(head + joined + star + tail)


#: Of the names that Abaqus has for elements of one shape, meshio takes the last in its list, such
#: as hybrid or rigid ones. These are the plain ones; facets are shells.
_PLAIN = {
    b"C3D10MH": b"C3D10",
    b"C3D8RH": b"C3D8",
    b"CPE6": b"STRI65",
    b"R3D3": b"S3",
    b"CAX4P": b"S4",
}


def _plain_elements(path: Path) -> None:
    """Give a file of a mesh of space the names of plain elements."""
    text = path.read_bytes()
    path.write_bytes(re.sub(rb"(?<=TYPE=)\w+", lambda found: _PLAIN.get(found[0], found[0]), text))

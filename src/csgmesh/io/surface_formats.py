"""Boundary surfaces of meshes of space: STL, OBJ, PLY, OFF, 3MF and GLB.

==============  ==============================================================================
suffix          names
==============  ==============================================================================
``.stl``        lost; with ``binary=False`` a solid a boundary
``.obj``        a group a boundary
``.glb``        a node and mesh a boundary
``.3mf``        an object a region, interfaces included; in millimetres
``.ply .off``   lost
==============  ==============================================================================

A face of several boundaries belongs to the group of all their names, joined by ``+``. Coordinates
are written as they are. Meshes of the plane go through meshio, as ever.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from csgmesh.errors import FileFormatError, InputError
from csgmesh.io import through_meshio
from csgmesh.io.boundary_surface import BoundarySurface, boundary_surface
from csgmesh.io.solids.threemf import write_parts
from csgmesh.mesh import Mesh

#: Formats for solids only.
_SOLID = (".3mf", ".glb")


def write(path: Path, mesh: Mesh) -> None:
    """Write the boundary of a mesh of space, or a plane mesh."""
    suffix = path.suffix.lower()
    if mesh.dim == 2:
        if suffix in _SOLID:
            raise FileFormatError(f"a {suffix} file holds solids; this mesh lies in the plane")
        through_meshio.write(path, mesh)
        return
    if suffix == ".3mf":
        write_parts(path, _bodies(mesh))
        return
    surface = boundary_surface(mesh)
    if suffix == ".obj":
        path.write_text(_obj(surface, mesh), encoding="utf-8")
        return
    import trimesh

    if suffix == ".glb":
        scene: Any = trimesh.Scene()
        for name, rows in _groups(surface, mesh):
            part = surface.of(rows)
            scene.add_geometry(_trimesh(part), node_name=name, geom_name=name)
        path.write_bytes(scene.export(file_type="glb"))
        return
    data = _trimesh(surface).export(file_type=suffix[1:])
    path.write_bytes(data.encode() if isinstance(data, str) else data)


def read(path: Path) -> Mesh:
    """Read a plane mesh; solids are shapes, for `read_shape`."""
    if path.suffix.lower() in _SOLID:
        raise FileFormatError(f"{path} holds surfaces of solids: use csgmesh.read_shape")
    return through_meshio.read(path)


def write_ascii_stl(path: Path, mesh: Mesh) -> None:
    """STL as text, a solid a boundary."""
    surface = boundary_surface(mesh)
    lines: list[str] = []
    for name, rows in _groups(surface, mesh):
        lines.append(f"solid {name}")
        corner = surface.points[surface.triangles[rows]]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        normal /= np.maximum(np.sqrt((normal**2).sum(axis=1)), 1e-300)[:, None]
        for n, triangle in zip(normal.tolist(), corner.tolist(), strict=True):
            lines.append(f"facet normal {n[0]:.9g} {n[1]:.9g} {n[2]:.9g}\nouter loop")
            lines += [f"vertex {x!r} {y!r} {z!r}" for x, y, z in triangle]
            lines.append("endloop\nendfacet")
        lines.append(f"endsolid {name}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_binary_stl(path: Path, mesh: Mesh) -> None:
    """STL in 50 bytes a triangle, without names."""
    path.write_bytes(_trimesh(boundary_surface(mesh)).export(file_type="stl"))


def _trimesh(surface: BoundarySurface) -> Any:
    import trimesh

    return trimesh.Trimesh(surface.points, surface.triangles, process=False)


def _groups(surface: BoundarySurface, mesh: Mesh) -> list[tuple[str, np.ndarray]]:
    """Triangles by their names, in the order of the markers; nameless ones last."""
    out = []
    for marker in [*range(len(mesh.boundary_names)), -1]:
        rows = np.flatnonzero(surface.marker == marker)
        if len(rows):
            names = mesh.boundary_names[marker] if marker >= 0 else ("boundary",)
            out.append(("+".join(names).replace(" ", "_"), rows))
    return out


def _obj(surface: BoundarySurface, mesh: Mesh) -> str:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in surface.points.tolist()]
    for name, rows in _groups(surface, mesh):
        lines.append(f"g {name}")
        lines += [f"f {a} {b} {c}" for a, b, c in (surface.triangles[rows] + 1).tolist()]
    return "\n".join(lines) + "\n"


def _bodies(mesh: Mesh) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """A closed surface a region."""
    surface = boundary_surface(mesh, interfaces=True)
    if (surface.region[:, 0] < 0).any():
        raise InputError("a .3mf file needs regions on the inner sides of all faces")
    out = []
    for number, name in enumerate(mesh.region_names):
        rows = np.flatnonzero((surface.region == number).any(axis=1))
        if len(rows):
            part = surface.of(rows, surface.region[rows, 0] != number)
            out.append((name, part.points, part.triangles))
    return out

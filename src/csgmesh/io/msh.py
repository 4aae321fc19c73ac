"""Gmsh's mesh format (``.msh``), version 4.1, binary or text.

Every name is a physical group. In MSH 4.1 groups belong to entities, and an entity may be in
several: so facets with the same names and the same regions beside them form one curve entity, which
is in a group for each name. A region is a surface entity, an embedded point a point entity. Numbers
of groups are distinct over all dimensions (regions first), because many readers ignore the
dimension.

Points keep their order, for which they are all listed under the first surface; Gmsh itself does not
mind, and readers that take them as they come get the numbering of the mesh.

Of the mesh of a surface in space its facets are written; regions are volumes without elements,
which know their bounding surfaces.

Periodic pairs go to the section $Periodic, the second side as the slave of the first. Read back,
they are called by the first names of the entities.

Source: Geuzaine and Remacle, Gmsh reference manual, "MSH file format".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from csgmesh.errors import FileFormatError
from csgmesh.io.assemble import INNER, OUTER, Listing
from csgmesh.io.assemble_space import dimension
from csgmesh.io.assemble_surface import lists_surface
from csgmesh.io.msh_parse import FROM_GMSH, GMSH_TYPE, Entity, MshContent, is_version_4_1, parse
from csgmesh.io.msh_periodic import links, pairs
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.lagrange import EQUISPACED
from csgmesh.mesh.nodes import with_nodes
from csgmesh.mesh.surfaces import is_surface, with_facets

_INT, _SIZE, _DOUBLE = "<i4", "<u8", "<f8"

Field = tuple[str, "np.ndarray | Sequence[float]"]


def write(path: Path, mesh: Mesh, *, binary: bool = True) -> None:
    """Write a ``.msh`` file of version 4.1; text with ``binary=False``."""
    mesh = with_nodes(mesh, EQUISPACED)
    if is_surface(mesh):
        mesh = replace(with_facets(mesh), cells={}, cell_region={})
    groups = _Groups(mesh)
    with open(path, "wb") as file:
        sink: _Binary | _Text = _Binary(file) if binary else _Text(file)
        file.write(b"$MeshFormat\n4.1 %d 8\n" % binary)
        if binary:
            file.write(np.array([1], _INT).tobytes() + b"\n")
        file.write(b"$EndMeshFormat\n$PhysicalNames\n%d\n" % len(groups.physical))
        for (dim, name), tag in groups.physical.items():
            file.write(f'{dim} {tag} "{_quotable(name)}"\n'.encode())
        file.write(b"$EndPhysicalNames\n$Entities\n")
        _write_entities(sink, groups)
        file.write(b"$EndEntities\n$Nodes\n")
        _write_nodes(sink, mesh, groups)
        file.write(b"$EndNodes\n$Elements\n")
        _write_elements(sink, mesh, groups)
        file.write(b"$EndElements\n")
        if mesh.periodic:
            file.write(b"$Periodic\n")
            _write_periodic(sink, mesh, groups)
            file.write(b"$EndPeriodic\n")


def read(path: Path) -> Mesh:
    """Read a ``.msh`` file; version 2.2 through meshio."""
    data = path.read_bytes()
    if not is_version_4_1(path, data):
        from csgmesh.io.through_meshio import read as read_foreign

        return read_foreign(path)
    found = parse(path, data)
    listing = Listing(path, found.points)
    kinds = [block.kind for block in found.elements]
    is_skin = lists_surface(kinds, found.points)
    most = 3 if is_skin else dimension(kinds)
    for dim, tag in sorted(found.names):
        if dim == most:
            listing.regions.of(found.names[dim, tag])
    for dim, entity in sorted(found.physical, key=lambda key: (-key[0], key[1])):
        if dim < most:
            listing.markers.of(_boundary(found, dim, entity))
    beside = _beside(found, listing) if is_skin else {}
    rows_of: dict[str, list[tuple[np.ndarray, ...]]] = {}
    for block in found.elements:
        if block.kind not in KINDS or KINDS[block.kind].dim != block.dim:
            raise FileFormatError(f"{path}: {block.kind} elements in an entity of dim {block.dim}")
        if block.dim == most:
            tags = found.physical.get((most, block.entity), ())
            names = [found.names.get((most, tag), f"region{tag}") for tag in tags[:1]]
            number = listing.regions.of(names[0] if names else "")
        else:
            number = listing.markers.of(_boundary(found, block.dim, block.entity))
        numbers = np.full(len(block.rows), number)
        sides = np.tile(beside.get(block.entity, [-1, -1]), (len(block.rows), 1))
        rows_of.setdefault(block.kind, []).append((block.tags, block.rows, numbers, sides))
    for kind, parts in rows_of.items():
        order = np.argsort(np.concatenate([p[0] for p in parts]), kind="stable")
        rows = np.concatenate([p[1] for p in parts])[order]
        listing.add(kind, rows, np.concatenate([p[2] for p in parts])[order])
        if is_skin:
            listing.beside[kind] = [np.concatenate([p[3] for p in parts])[order]]
    mesh = listing.mesh()
    named = [
        (link, (_side(found, link.dim, link.master), _side(found, link.dim, link.entity)))
        for link in found.links
        if link.dim == 1
    ]
    return replace(mesh, periodic=pairs(mesh, named, listing.number)) if named else mesh


def _beside(found: MshContent, listing: Listing) -> dict[int, list[int]]:
    """Regions behind and in front of the surface entities that volumes list."""
    out: dict[int, list[int]] = {}
    for dim, entity in sorted(found.bounding):
        if dim == 3:
            tags = found.physical.get((3, entity), ())
            names = [found.names.get((3, tag), f"region{tag}") for tag in tags[:1]]
            number = listing.regions.of(names[0] if names else f"region{entity}")
            for surface in found.bounding[dim, entity]:
                out.setdefault(abs(surface), [-1, -1])[surface < 0] = number
    return out


def _side(found: MshContent, dim: int, entity: int) -> str:
    return (_boundary(found, dim, entity) or (OUTER,))[0]


def _boundary(found: MshContent, dim: int, entity: int) -> tuple[str, ...]:
    tags = found.physical.get((dim, entity), ())
    return tuple(dict.fromkeys(found.names.get((dim, tag), f"boundary{tag}") for tag in tags))


@dataclass(frozen=True)
class _Curve:
    """A curve entity: facets of one kind, marker and pair of regions."""

    kind: str
    which: np.ndarray
    physical: tuple[int, ...]
    sides: tuple[int, int]


class _Groups:
    """Entities and physical groups of a mesh."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self.dim = mesh.dim
        self.physical: dict[tuple[int, str], int] = {}
        for name in mesh.region_names:
            self._group(self.dim, name)
        self.curves = [c for kind in mesh.facets for c in self._curves(kind)]
        self.points = np.flatnonzero(mesh.point_marker >= 0)
        markers = mesh.point_marker[self.points].tolist()
        self.point_groups = [self._all(0, mesh.boundary_names[m]) for m in markers]
        numbers = [*mesh.cell_region.values()] or [*mesh.facet_region.values()]
        self.regions = sorted({int(r) for n in numbers for r in np.unique(n) if r >= 0})

    def _group(self, dim: int, name: str) -> int:
        return self.physical.setdefault((dim, name), len(self.physical) + 1)

    def _all(self, dim: int, names: Sequence[str]) -> tuple[int, ...]:
        return tuple(self._group(dim, name) for name in names)

    def _curves(self, kind: str) -> list[_Curve]:
        mesh = self.mesh
        marker, sides = mesh.facet_marker[kind], mesh.facet_region[kind]
        if not len(marker):
            return []
        key = np.column_stack([marker, sides])
        order = np.lexsort(key.T[::-1])
        ordered = key[order]
        changes = np.flatnonzero((ordered[1:] != ordered[:-1]).any(axis=1)) + 1
        curves = []
        for which in np.split(order, changes):
            m, left, right = key[which[0]].tolist()
            names = mesh.boundary_names[m] if m >= 0 else ()
            names = names or (OUTER if right < 0 else INNER,)
            groups = self._all(self.dim - 1, names)
            curves.append(_Curve(kind, which, groups, (left, right)))
        return curves

    def bounding(self) -> dict[int, list[int]]:
        """For each region its curves, negative where it lies on their right."""
        around: dict[int, list[int]] = {region: [] for region in self.regions}
        for tag, curve in enumerate(self.curves, 1):
            left, right = curve.sides
            if left != right:
                for region, sign in ((left, 1), (right, -1)):
                    if region in around:
                        around[region].append(sign * tag)
        return around

    def physical_region(self, region: int) -> int:
        """The group of a region."""
        return self.physical[self.dim, self.mesh.region_names[region]]


class _Binary:
    """Numbers as bytes."""

    def __init__(self, file: BinaryIO) -> None:
        self.file = file

    def line(self, *fields: Field) -> None:
        self.file.write(b"".join(np.asarray(values, code).tobytes() for code, values in fields))

    def table(self, code: str, values: np.ndarray) -> None:
        self.file.write(np.ascontiguousarray(values, code).data)

    def end(self) -> None:
        self.file.write(b"\n")


class _Text:
    """Numbers as text that reads back to the same bits."""

    def __init__(self, file: BinaryIO) -> None:
        self.file = file

    def line(self, *fields: Field) -> None:
        texts = (repr(x) for code, values in fields for x in np.asarray(values, code).tolist())
        self.file.write((" ".join(texts) + "\n").encode())

    def table(self, code: str, values: np.ndarray) -> None:
        rows = np.asarray(values, code).reshape(len(values), -1).tolist()
        self.file.write("".join(" ".join(map(repr, row)) + "\n" for row in rows).encode())

    def end(self) -> None:
        """Each line has ended already."""


def _write_entities(sink: _Binary | _Text, groups: _Groups) -> None:
    mesh = groups.mesh
    counts = [0, 0, 0, 0]
    counts[0] += len(groups.points)
    counts[groups.dim - 1] += len(groups.curves)
    counts[groups.dim] += len(groups.regions)
    sink.line((_SIZE, counts))
    xyz = _in_space(mesh.points)
    for tag, (point, physical) in enumerate(
        zip(groups.points, groups.point_groups, strict=True), 1
    ):
        sink.line((_INT, [tag]), (_DOUBLE, xyz[point]), (_SIZE, [len(physical)]), (_INT, physical))
    for tag, curve in enumerate(groups.curves, 1):
        points = mesh.facets[curve.kind][curve.which].ravel()
        _write_entity(sink, tag, xyz[points], curve.physical, [])
    around = groups.bounding()
    for region in groups.regions:
        rows = [c[mesh.cell_region[k] == region].ravel() for k, c in mesh.cells.items()]
        if not rows:
            sides = mesh.facet_region.items()
            rows = [mesh.facets[k][(r == region).any(axis=1)].ravel() for k, r in sides]
        physical = (groups.physical_region(region),)
        _write_entity(sink, region + 1, xyz[np.concatenate(rows)], physical, around[region])
    sink.end()


def _write_entity(
    sink: _Binary | _Text,
    tag: int,
    points: np.ndarray,
    physical: Sequence[int],
    bounding: Sequence[int],
) -> None:
    sink.line(
        (_INT, [tag]),
        (_DOUBLE, [*points.min(axis=0), *points.max(axis=0)]),
        (_SIZE, [len(physical)]),
        (_INT, physical),
        (_SIZE, [len(bounding)]),
        (_INT, bounding),
    )


def _write_nodes(sink: _Binary | _Text, mesh: Mesh, groups: _Groups) -> None:
    n = mesh.n_points
    if not n or not groups.regions:
        sink.line((_SIZE, [0, 0, 0, 0]))
    else:
        sink.line((_SIZE, [1, n, 1, n]))
        entity = [groups.dim, groups.regions[0] + 1] if mesh.cells else [groups.dim - 1, 1]
        sink.line((_INT, [*entity, 0]), (_SIZE, [n]))
        sink.table(_SIZE, np.arange(1, n + 1))
        sink.table(_DOUBLE, _in_space(mesh.points))
    sink.end()


def _write_elements(sink: _Binary | _Text, mesh: Mesh, groups: _Groups) -> None:
    blocks: list[Entity] = []
    next_tag = 1
    for number, point in enumerate(groups.points, 1):
        blocks.append(Entity(0, number, "vertex", np.array([next_tag]), np.array([[point]])))
        next_tag += 1
    # Tags in the order of the mesh, whatever the blocks: so a reader can restore it.
    for kind, rows in mesh.facets.items():
        for number, curve in enumerate(groups.curves, 1):
            if curve.kind == kind:
                tags, dim = next_tag + curve.which, groups.dim - 1
                blocks.append(Entity(dim, number, kind, tags, rows[curve.which]))
        next_tag += len(rows)
    for kind, rows in mesh.cells.items():
        tags = np.arange(next_tag, next_tag + len(rows))
        for region in groups.regions:
            is_in = mesh.cell_region[kind] == region
            whole = bool(is_in.all())
            if is_in.any():
                inside = (tags, rows) if whole else (tags[is_in], rows[is_in])
                blocks.append(Entity(groups.dim, region + 1, kind, *inside))
        next_tag += len(rows)
    sink.line((_SIZE, [len(blocks), next_tag - 1, 1 if blocks else 0, next_tag - 1]))
    for block in blocks:
        sink.line(
            (_INT, [block.dim, block.entity, GMSH_TYPE[block.kind]]), (_SIZE, [len(block.rows)])
        )
        table = np.empty((len(block.rows), 1 + block.rows.shape[1]), _SIZE)
        table[:, 0] = block.tags
        order = FROM_GMSH.get(block.kind)
        rows = block.rows if order is None else block.rows[:, np.argsort(order)]
        np.add(rows, 1, out=table[:, 1:], casting="unsafe")
        sink.table(_SIZE, table)
    sink.end()


def _write_periodic(sink: _Binary | _Text, mesh: Mesh, groups: _Groups) -> None:
    found = links(mesh, [(curve.kind, curve.which) for curve in groups.curves])
    sink.line((_SIZE, [len(found)]))
    for link in found:
        sink.line((_INT, [link.dim, link.entity, link.master]))
        sink.line((_SIZE, [len(link.affine)]), (_DOUBLE, link.affine))
        sink.line((_SIZE, [len(link.nodes)]))
        sink.table(_SIZE, link.nodes + 1)
    sink.end()


def _in_space(points: np.ndarray) -> np.ndarray:
    out = np.zeros((len(points), 3))
    out[:, : points.shape[1]] = points
    return out


def _quotable(name: str) -> str:
    if '"' in name or "\n" in name or "\r" in name:
        raise FileFormatError(f"a .msh file cannot hold the name {name!r}: quotes or line breaks")
    return name

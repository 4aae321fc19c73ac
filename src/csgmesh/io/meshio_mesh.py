"""Meshes of the library meshio, tags mapped both ways."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import FileFormatError, InputError
from csgmesh.io.assemble import Listing
from csgmesh.io.assemble_space import dimension
from csgmesh.io.members import members
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.lagrange import EQUISPACED
from csgmesh.mesh.nodes import with_nodes
from csgmesh.mesh.surfaces import is_surface, with_facets

if TYPE_CHECKING:
    import meshio

#: Integer tags of meshio's formats, in the order in which they are believed.
REFERENCES = (
    *("gmsh:physical", "medit:ref", "su2:tag", "nastran:ref", "avsucd:material", "netgen:index"),
    *("ugrid:ref", "cell_tags", "obj:group_ids"),
)


def to_meshio(mesh: Mesh) -> meshio.Mesh:
    """A `meshio.Mesh` with everything but the exact curves.

    Parameters
    ----------
    mesh : Mesh
        Any mesh.

    Returns
    -------
    meshio.Mesh
        A block a kind of cell, then a block a kind of facet, then embedded points as `vertex`
        cells. ``cell_data["region"]`` numbers the regions (-1 on facets), ``cell_data["marker"]``
        the boundaries (-1 on cells); ``cell_sets`` holds every name. Of a surface in space each
        triangle comes once, with both numbers.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]},
    ...                facets={"line": [[0, 1]]}, facet_marker={"line": [0]},
    ...                boundary_names=[["wall"]])
    >>> sorted(cm.to_meshio(mesh).cell_sets)
    ['domain', 'wall']
    """
    if not isinstance(mesh, Mesh):
        raise InputError(f"to_meshio needs a Mesh, as generate returns; got {type(mesh).__name__}")
    import meshio

    mesh = with_nodes(mesh, EQUISPACED)
    if is_surface(mesh):
        return _skin(with_facets(mesh))
    blocks = [*mesh.cells.items(), *mesh.facets.items()]
    regions = [np.array(r) for r in mesh.cell_region.values()]
    markers = [np.array(m) for m in mesh.facet_marker.values()]
    vertices = np.flatnonzero(mesh.point_marker >= 0)
    if len(vertices):
        blocks.append(("vertex", vertices[:, None]))
        markers.append(mesh.point_marker[vertices])
    region = regions + [np.full(len(m), -1) for m in markers]
    marker = [np.full(len(r), -1) for r in regions] + markers
    return meshio.Mesh(
        np.array(mesh.points),
        [(kind, np.array(rows)) for kind, rows in blocks],
        cell_data={"region": region, "marker": marker},
        cell_sets=_cell_sets(mesh, region, marker),
    )


def _skin(mesh: Mesh) -> meshio.Mesh:
    """The facets of a surface, each with its marker and the region behind."""
    import meshio

    region = [np.array(sides[:, 0]) for sides in mesh.facet_region.values()]
    marker = [np.array(markers) for markers in mesh.facet_marker.values()]
    return meshio.Mesh(
        np.array(mesh.points),
        [(kind, np.array(rows)) for kind, rows in mesh.facets.items()],
        cell_data={"region": region, "marker": marker},
        cell_sets=_cell_sets(mesh, region, marker),
    )


def from_meshio(given: meshio.Mesh, path: Path | str = "the meshio mesh") -> Mesh:
    """A `Mesh` from a plane `meshio.Mesh`.

    Names come from its cell sets, or from physical groups, or from integer tags (`region3`,
    `boundary3`), in this order. Sides without a name are called `boundary` or `interface`.

    Parameters
    ----------
    given : meshio.Mesh
        Triangles and quads, of order 1 to 5 with equispaced nodes, with z = 0.
    path : Path or str
        What errors call it.

    Raises
    ------
    FileFormatError
        If there are no plane cells, or kinds that are not supported.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
    >>> from_meshio(cm.to_meshio(mesh)).names
    ('boundary',)
    """
    listing = Listing(Path(path), np.asarray(given.points))
    dim = dimension([block.type for block in given.cells])
    region_tags, marker_tags = _tags(given, listing)
    for number, block in enumerate(given.cells):
        tags = region_tags[number] if _is_cell(block, dim) else marker_tags[number]
        listing.add(block.type, np.asarray(block.data, np.int64), tags)
    for name, points in given.point_sets.items():
        rows = np.asarray(points, np.int64).reshape(-1, 1)
        listing.add("vertex", rows, np.full(len(rows), listing.markers.of((name,))))
    return listing.mesh()


def _cell_sets(
    mesh: Mesh, region: list[np.ndarray], marker: list[np.ndarray]
) -> dict[str, list[np.ndarray]]:
    sets: dict[str, list[np.ndarray]] = {}
    region_names = [(name,) for name in mesh.region_names]
    for numbers, names in ((region, region_names), (marker, mesh.boundary_names)):
        for block, values in enumerate(numbers):
            for name, found in members(values, names).items():
                empty = [np.zeros(0, np.int64)] * len(numbers)
                # Only on surfaces does a block have both a region and a marker.
                known = sets.setdefault(name, empty)
                known[block] = np.union1d(known[block], found)
    return sets


def _tags(given: Any, listing: Listing) -> tuple[list[np.ndarray], list[np.ndarray]]:
    sets = {k: v for k, v in given.cell_sets.items() if not k.startswith("gmsh:")}
    lengths = [len(block.data) for block in given.cells]
    if any(part is not None and len(part) for parts in sets.values() for part in parts):
        return _tags_from_sets(sets, lengths, given, listing)
    none = [np.full(n, -1) for n in lengths]
    if "region" in given.cell_data and "marker" in given.cell_data:
        data = given.cell_data
        region_of, marker_of = listing.names_in(given.field_data)
        regions = [
            _named(t, region_of, listing.region_number, 0) for t in _integers(data["region"])
        ]
        markers = [
            _named(t, marker_of, listing.marker_number, 0) for t in _integers(data["marker"])
        ]
        return regions, markers
    key = next((key for key in REFERENCES if key in given.cell_data), None)
    if key is None:
        return none, none
    region_of, marker_of = {}, {}
    most = dimension([block.type for block in given.cells])
    for name, value in given.field_data.items():
        if np.shape(value) == (2,):
            tag, dim = int(value[0]), int(value[1])
            if dim == most:
                region_of[tag] = listing.regions.of(name)
            else:
                marker_of[tag] = listing.markers.of((name,))
    tags = _integers(given.cell_data[key])
    is_cell = [_is_cell(block, most) for block in given.cells]
    pairs = list(zip(tags, is_cell, none, strict=True))
    regions = [_named(t, region_of, listing.region_number, 1) if c else e for t, c, e in pairs]
    markers = [e if c else _named(t, marker_of, listing.marker_number, 1) for t, c, e in pairs]
    return regions, markers


def _tags_from_sets(
    sets: Mapping[str, Any], lengths: list[int], given: Any, listing: Listing
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    region = [np.full(n, -1) for n in lengths]
    combination = [np.zeros(n, np.int64) for n in lengths]
    names: list[tuple[str, ...]] = [()]
    dim = dimension([block.type for block in given.cells])
    for name, parts in sets.items():
        for block, found in enumerate(parts[: len(lengths)]):
            if found is None or not len(found):
                continue
            found = np.asarray(found, np.int64)
            if found.min() < 0 or found.max() >= lengths[block]:
                raise FileFormatError(f"{listing.path}: set {name!r} has members outside its block")
            if _is_cell(given.cells[block], dim):
                free = found[region[block][found] < 0]
                region[block][free] = listing.regions.of(name)
            else:
                values, at = np.unique(combination[block][found], return_inverse=True)
                combination[block][found] = (np.arange(len(values)) + len(names))[at]
                names += [(*names[v], name) for v in values.tolist()]
    return region, _combined(combination, names, listing)


def _combined(
    combination: list[np.ndarray], names: list[tuple[str, ...]], listing: Listing
) -> list[np.ndarray]:
    """Markers for the combinations of names that are left after all sets."""
    used = np.unique(np.concatenate([*combination, [0]])).tolist()
    position = {
        name: i for i, name in enumerate(dict.fromkeys(n for entry in names for n in entry))
    }
    for entry in sorted((names[v] for v in used), key=lambda e: [position[n] for n in e]):
        listing.markers.of(entry)
    return [
        np.array([listing.markers.of(names[v]) for v in numbers.tolist()], np.int64)
        for numbers in combination
    ]


def _is_cell(block: Any, dim: int) -> bool:
    return block.type in KINDS and KINDS[block.type].dim >= dim


def _integers(parts: Any) -> list[np.ndarray]:
    return [np.asarray(part).ravel().astype(np.int64) for part in parts]


def _named(tags: np.ndarray, known: dict[int, int], new: Any, lowest: int) -> np.ndarray:
    """Numbers in the listing; tags below `lowest` mean none."""
    values, at = np.unique(tags, return_inverse=True)
    for value in values.tolist():
        if value not in known:
            known[value] = new(value) if value >= lowest else -1
    return np.array([known[v] for v in values.tolist()], np.int64)[at]

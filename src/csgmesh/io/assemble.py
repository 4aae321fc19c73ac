"""From what a file lists to a `Mesh`.

Files differ in what they say about facets: some list every boundary edge, some none, some list an
edge once for each of its names, and hardly any says which regions lie on the two sides. Here the
sides are worked out from the cells, duplicates merge, and what is missing is added.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from csgmesh.errors import FileFormatError, InputError
from csgmesh.io.assemble_space import INNER, OUTER, dimension, space_mesh
from csgmesh.io.assemble_surface import surface_mesh
from csgmesh.io.sides import missing_edges, oriented_edges
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.lagrange import lattice

__all__ = ["INNER", "OUTER", "Listing", "Numbered"]


class Numbered:
    """Numbers for names, or tuples of names, in order of appearance."""

    def __init__(self) -> None:
        self.names: list = []
        self._number: dict = {}

    def of(self, name: str | tuple[str, ...]) -> int:
        """The number of a name, new if need be; -1 for an empty one."""
        if not name:
            return -1
        if name not in self._number:
            self._number[name] = len(self.names)
            self.names.append(name)
        return self._number[name]


@dataclass
class Listing:
    """Blocks of entities in the order of a file; see `add`.

    Of surfaces in space, `beside` has the regions behind and in front of each, (k, 2), block for
    block. Once there is a mesh, `number` holds the number in it of each point, -1 for those left
    out.
    """

    path: Path
    points: np.ndarray
    regions: Numbered = field(default_factory=Numbered)
    markers: Numbered = field(default_factory=Numbered)
    blocks: dict[str, list[tuple[np.ndarray, np.ndarray]]] = field(default_factory=dict)
    beside: dict[str, list[np.ndarray]] = field(default_factory=dict)
    number: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))

    def region_number(self, tag: int) -> int:
        """The region for a number that has no name in the file."""
        return self.regions.of(f"region{tag}")

    def marker_number(self, tag: int) -> int:
        """The marker for a number that has no name in the file."""
        return self.markers.of((f"boundary{tag}",))

    def names_in(self, fields: Mapping[str, np.ndarray]) -> tuple[dict[int, int], dict[int, int]]:
        """Names from the field data of a ``.vtu`` file, which are entered here.

        Returns numbers in the file → numbers here, for regions and for markers.
        """
        names: dict[int, list[str]] = {}
        region_of = {}
        for key, values in fields.items():
            kind, _, name = key.partition(":")
            numbers = np.asarray(values).ravel().tolist()
            if kind == "region" and name:
                region_of.update({int(v): self.regions.of(name) for v in numbers})
            elif kind == "boundary" and name:
                for value in numbers:
                    names.setdefault(int(value), []).append(name)
        return region_of, {v: self.markers.of(tuple(names[v])) for v in sorted(names)}

    def add(self, kind: str, rows: np.ndarray, tags: np.ndarray) -> None:
        """Add entities: cells with region numbers, facets and vertices with markers (-1: none)."""
        if kind not in KINDS:
            known = ", ".join(KINDS)
            raise FileFormatError(f"{self.path}: cells of kind {kind!r}; known are {known}")
        bad = (rows < 0) | (rows >= len(self.points))
        if bad.any():
            at = int(np.argmax(bad.any(axis=1)))
            raise FileFormatError(
                f"{self.path}: {kind} {at} uses point {int(rows[at][bad[at]][0])}, "
                f"but there are {len(self.points)} points"
            )
        self.blocks.setdefault(kind, []).append((rows, tags))

    def of_dim(self, dim: int) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Entities of a dimension and their numbers, by kind."""
        return _of_dim(self, dim)

    def mesh(self) -> Mesh:
        """The mesh; see the module."""
        if dimension(self.blocks) == 3:
            return space_mesh(self)
        return surface_mesh(self) if self.beside else _mesh(self)


def _mesh(listing: Listing) -> Mesh:
    points = _plane(listing)
    cells, regions = _of_dim(listing, 2)
    if not cells:
        raise FileFormatError(f"{listing.path} holds no cells (triangles, quads)")
    cells, regions, doubled = _unique_cells(cells, regions)
    for kind, region in regions.items():
        if (region < 0).any():
            regions[kind] = np.where(region < 0, listing.regions.of("domain"), region)
    cells = _counterclockwise(points, cells)
    facets, markers, sides, loose = _facets(listing, cells, regions)
    point_marker = _vertices(listing)
    used = np.zeros(len(points), bool)
    for rows in cells.values():
        used[rows] = True
    new = np.cumsum(used) - 1
    listing.number = np.where(used, new, -1)
    counts = {"points": int((~used).sum()), "lines": loose, "repeated cells": doubled}
    skipped = {what: n for what, n in counts.items() if n}
    try:
        return Mesh(
            points[used],
            {kind: new[rows] for kind, rows in cells.items()},
            regions,
            tuple(listing.regions.names),
            facets={kind: new[rows] for kind, rows in facets.items()},
            facet_marker=markers,
            boundary_names=tuple(listing.markers.names),
            facet_region=sides,
            point_marker=point_marker[used],
            info={"skipped": skipped} if skipped else {},
        )
    except InputError as error:
        raise FileFormatError(f"{listing.path}: {error}") from error


def _plane(listing: Listing) -> np.ndarray:
    points = np.asarray(listing.points, np.float64)
    if points.ndim != 2 or not len(points) or points.shape[1] not in (2, 3):
        raise FileFormatError(f"{listing.path} holds no points in the plane")
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        raise FileFormatError(f"{listing.path}: point {int(np.argmax(bad))} is not finite")
    if points.shape[1] == 3:
        raised = points[:, 2] != 0
        if raised.any():
            at = int(np.argmax(raised))
            raise FileFormatError(
                f"{listing.path}: point {at} has z = {points[at, 2]:g}; only plane meshes, "
                "with z = 0, can be read; csgmesh.read_shape reads surfaces of solids"
            )
    return np.ascontiguousarray(points[:, :2])


def _of_dim(listing: Listing, dim: int) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    rows, tags = {}, {}
    for kind, blocks in listing.blocks.items():
        if KINDS[kind].dim == dim and any(len(r) for r, _ in blocks):
            rows[kind] = np.concatenate([r for r, _ in blocks]).astype(np.int64, copy=False)
            tags[kind] = np.concatenate([t for _, t in blocks]).astype(np.int64, copy=False)
    return rows, tags


def _unique_cells(
    cells: Mapping[str, np.ndarray], regions: Mapping[str, np.ndarray]
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], int]:
    """Without repeats: Gmsh 2.2 lists a cell once for each of its physical groups."""
    kept, kept_regions, dropped = {}, {}, 0
    for kind, rows in cells.items():
        first = _first_of_each(np.sort(rows, axis=1))
        dropped += len(rows) - len(first)
        whole = len(first) == len(rows)
        kept[kind] = rows if whole else rows[first]
        kept_regions[kind] = regions[kind] if whole else regions[kind][first]
    return kept, kept_regions, dropped


def _first_of_each(rows: np.ndarray) -> np.ndarray:
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    is_new = np.ones(len(rows), bool)
    is_new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    # lexsort is stable, so the first of a group of equals is the first in the file.
    return np.sort(order[is_new])


def _counterclockwise(points: np.ndarray, cells: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Turn a mesh over if all of it is clockwise; a mixture stays, for the check to find."""
    for kind, rows in cells.items():
        p = points[rows[:, : KINDS[kind].n_corners]]
        a, b = p[:, 1:-1] - p[:, :1], p[:, 2:] - p[:, :1]
        if not ((a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]).sum(axis=1) < 0).all():
            return cells
    return {kind: rows[:, _mirrored(kind)] for kind, rows in cells.items()}


def _mirrored(kind: str) -> list[int]:
    n = KINDS[kind].n_corners
    if kind == "quad8":
        return [0, 3, 2, 1, 7, 6, 5, 4]
    # The mirror image across the diagonal through corner 0 exchanges the two coordinates.
    places = lattice(n, KINDS[kind].order).tolist()
    return [places.index([j, i]) for i, j in places]


def _facets(
    listing: Listing, cells: Mapping[str, np.ndarray], regions: Mapping[str, np.ndarray]
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], dict[str, np.ndarray], int]:
    edges = oriented_edges(cells, regions, len(listing.points))
    given, tags = _of_dim(listing, 1)
    facets, markers, sides, loose = {}, {}, {}, 0
    for kind in dict.fromkeys([*given, *(KINDS[c].facet_kinds[0] for c in cells)]):
        rows = given.get(kind, np.zeros((0, KINDS[kind].n_points), np.int64))
        marker = tags.get(kind, np.zeros(0, np.int64))
        rows, marker = _merged(rows, marker, listing.markers)
        rows, region, is_edge = edges.sides(rows)
        loose += int((~is_edge).sum())
        extra, extra_region = missing_edges(edges, rows[is_edge], kind)
        facets[kind] = np.concatenate([rows[is_edge], extra])
        sides[kind] = np.concatenate([region[is_edge], extra_region])
        marker = np.concatenate([marker[is_edge], np.full(len(extra), -1)])
        unnamed = marker < 0
        outer = sides[kind][:, 1] < 0
        for where, name in ((unnamed & outer, OUTER), (unnamed & ~outer, INNER)):
            if where.any():
                marker[where] = listing.markers.of((name,))
        markers[kind] = marker
    return facets, markers, sides, loose


def _merged(
    rows: np.ndarray, marker: np.ndarray, markers: Numbered
) -> tuple[np.ndarray, np.ndarray]:
    """One facet for each edge, with the names of all its listings."""
    if not len(rows):
        return rows, marker
    keys = np.sort(rows[:, :2], axis=1)
    first = _first_of_each(keys)
    if len(first) == len(rows):
        return rows, marker
    names = markers.names
    gathered: dict[tuple[int, int], dict[str, None]] = {}
    for (a, b), m in zip(keys.tolist(), marker.tolist(), strict=True):
        gathered.setdefault((a, b), {}).update(dict.fromkeys(names[m] if m >= 0 else ()))
    merged = [markers.of(tuple(gathered[(a, b)])) for a, b in keys[first].tolist()]
    return rows[first], np.array(merged, np.int64)


def _vertices(listing: Listing) -> np.ndarray:
    marker = np.full(len(listing.points), -1, np.int64)
    names = listing.markers.names
    for rows, tags in listing.blocks.get("vertex", ()):
        for point, tag in zip(rows[:, 0].tolist(), tags.tolist(), strict=True):
            if tag >= 0:
                before = names[marker[point]] if marker[point] >= 0 else ()
                marker[point] = listing.markers.of(tuple(dict.fromkeys([*before, *names[tag]])))
    return marker

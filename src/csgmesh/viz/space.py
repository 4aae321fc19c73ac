"""What a picture of a solid or of a mesh of space shows, cut away where asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.errors import InputError
from csgmesh.measures.space.quality import space_quality
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.description import counted
from csgmesh.mesh.faces import canonical_faces, faces_of
from csgmesh.mesh.surfaces import is_surface, with_facets

if TYPE_CHECKING:
    from csgmesh.viz.drawing import Options

#: A picture's facets and lines are no longer than this part of the solid's diagonal.
_PIECES = 60
#: Beyond so many of them nothing is halved any more.
_MOST_PIECES = 200_000
_NONE = np.zeros(0, np.int64)


@dataclass(frozen=True, eq=False)
class Polygons:
    """What a picture shows: polygons with an outward normal, in the colour of a name or region.

    Attributes
    ----------
    corners : (n, 4, 3) float64
        The last corner twice for triangles.
    marker : (n,) int64
        Into `names`; -1 for faces inside a region, which a cut lays open.
    region : (n,) int64
    names : tuple of tuple of str
    lines : (k, 2, 3) float64
        Drawn on top where their polygons are seen.
    lift : float
        So much nearer to the viewer than they are, to be in front of their own polygons.
    title : str
    """

    corners: np.ndarray
    marker: np.ndarray
    region: np.ndarray
    names: tuple[tuple[str, ...], ...]
    lines: np.ndarray
    lift: float
    title: str
    value: np.ndarray | None = None


def polygons_of_plc(plc: Plc, options: Options) -> Polygons:
    """The facets of a solid and its feature edges."""
    if options.cut is not None:
        raise InputError("draw: cut needs a mesh, whose cells are left out in front of the plane")
    # Facets are drawn from back to front by their middles, which tells little of long ones.
    longest = plc.diagonal / _PIECES
    corners, facet = _pieces(plc.points[plc.facets], longest)
    lines, _ = _pieces(plc.points[_towards(plc, options.view)], longest)
    return Polygons(
        corners[:, [0, 1, 2, 2]],
        plc.facet_marker[facet],
        plc.facet_region[facet, 0],
        plc.boundary_names,
        lines,
        0.7 * longest,
        f"{plc.n_facets:,} facets, {plc.n_points:,} points",
    )


def _pieces(corners: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (n, 3, 3) or lines (n, 2, 3) halved until no edge is longer, and their numbers."""
    number = np.arange(len(corners))
    k = corners.shape[1]
    while True:
        length = ((np.roll(corners, -1, axis=1) - corners) ** 2).sum(axis=2)
        long = np.flatnonzero(length.max(axis=1) > longest * longest)
        if not len(long) or len(corners) > _MOST_PIECES:
            return corners, number
        # The longest edge first, then halved.
        first = np.argmax(length[long], axis=1)
        order = (first[:, None] + np.arange(k)) % k
        turned = np.take_along_axis(corners[long], order[:, :, None], axis=1)
        middle = 0.5 * (turned[:, 0] + turned[:, 1])
        front, back = turned.copy(), turned.copy()
        front[:, 1], back[:, 0] = middle, middle
        corners[long] = front
        corners = np.concatenate([corners, back])
        number = np.concatenate([number, number[long]])


def _towards(plc: Plc, view: tuple[float, float]) -> np.ndarray:
    """Feature edges beside a facet that faces the viewer, (k, 2)."""
    a, b, c = (plc.points[plc.facets[:, k]] for k in range(3))
    front = plc.facets[np.cross(b - a, c - a) @ axes_of(view)[2] > 0.0]
    sides = np.sort(front[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, n = plc.feature_edges(), plc.n_points
    return edges[np.isin(edges[:, 0] * n + edges[:, 1], sides[:, 0] * n + sides[:, 1])]


def _of_surface(mesh: Mesh, options: Options) -> Polygons:
    """The facets of a surface, with their inner sides where a cut shows them."""
    counts = ", ".join(counted(len(c), kind) for kind, c in mesh.cells.items())
    mesh = with_facets(mesh)
    corners, markers, regions = [np.zeros((0, 4, 3))], [_NONE], [_NONE]
    for kind, rows in mesh.facets.items():
        kept = _behind(mesh, rows, options.cut)
        last = KINDS[kind].n_corners - 1
        corners.append(mesh.points[rows[kept][:, [0, 1, 2, last]]])
        markers.append(mesh.facet_marker[kind][kept])
        regions.append(mesh.facet_region[kind][kept, 0])
    shape, marker, region = (np.concatenate(part) for part in (corners, markers, regions))
    if options.cut is not None:
        shape = np.concatenate([shape, _inner_sides(shape)])
        marker, region = np.tile(marker, 2), np.tile(region, 2)
    lines = np.zeros((0, 2, 3))
    return Polygons(shape, marker, region, mesh.boundary_names, lines, 0.0, counts)


def _inner_sides(corners: np.ndarray) -> np.ndarray:
    """Polygons (n, 4, 3) seen from the other side; of triangles the last corner comes twice."""
    out = corners[:, [0, 3, 2, 1]]
    triangle = (corners[:, 2] == corners[:, 3]).all(axis=1)
    out[triangle] = corners[triangle][:, [0, 2, 1, 1]]
    return out


def polygons_of_mesh(mesh: Mesh, options: Options) -> Polygons:
    """The faces that bound the cells, of those behind the cut."""
    if is_surface(mesh):
        if options.color != "region":
            raise InputError(f"draw: color={options.color!r} needs cells that fill space")
        return _of_surface(mesh, options)
    kept = {kind: _behind(mesh, rows, options.cut) for kind, rows in mesh.cells.items()}
    cells = {kind: mesh.cells[kind][at, : KINDS[kind].n_corners] for kind, at in kept.items()}
    region = np.concatenate([mesh.cell_region[kind][at] for kind, at in kept.items()])
    faces = faces_of(cells)
    seen = np.flatnonzero(faces.count == 1)
    rows = faces.points[seen]
    turned = faces.behind[seen] < 0
    rows[turned] = _reversed(rows[turned])
    owner = np.where(turned, faces.ahead[seen], faces.behind[seen])
    marker = np.full(len(faces.points), -1)
    for kind, facet in mesh.facets.items():
        number = faces.find(canonical_faces(facet[:, : KINDS[kind].n_corners])[0])
        marker[number[number >= 0]] = mesh.facet_marker[kind][number >= 0]
    corners = mesh.points[np.where(rows < 0, rows[:, 2:3], rows)]
    counts = ", ".join(counted(len(c), kind) for kind, c in mesh.cells.items())
    lines, value = np.zeros((0, 2, 3)), _values(mesh, kept, options.color)
    drawn = None if value is None else value[owner]
    names = mesh.boundary_names
    return Polygons(corners, marker[seen], region[owner], names, lines, 0.0, counts, drawn)


def _values(mesh: Mesh, kept: dict[str, np.ndarray], color: str) -> np.ndarray | None:
    """The measure that colours the cells, of those that are kept."""
    if color == "region":
        return None
    measure = getattr(space_quality(mesh), color)
    start = np.cumsum([0, *(len(rows) for rows in mesh.cells.values())])
    return np.concatenate(
        [measure[begin + at] for begin, at in zip(start, kept.values(), strict=False)]
    )


def _behind(mesh: Mesh, rows: np.ndarray, cut: Any) -> np.ndarray:
    """Cells whose middle does not lie in front of the plane of a cut."""
    if cut is None:
        return np.arange(len(rows))
    point, normal = (np.asarray(v, float) for v in cut)
    return np.flatnonzero((mesh.points[rows].mean(axis=1) - point) @ normal <= 0.0)


def _reversed(rows: np.ndarray) -> np.ndarray:
    quad = rows[:, 3] >= 0
    out = rows[:, [0, 2, 1, 3]].copy()
    out[quad] = rows[quad][:, [0, 3, 2, 1]]
    return out


def axes_of(view: tuple[float, float]) -> np.ndarray:
    """Rows: the viewer's right, up, and the direction towards him."""
    around, above = np.radians(view)
    towards = np.array(
        [np.cos(above) * np.cos(around), np.cos(above) * np.sin(around), np.sin(above)]
    )
    right = np.array([-np.sin(around), np.cos(around), 0.0])
    return np.array([right, np.cross(towards, right), towards])

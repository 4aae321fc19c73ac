"""Pictures of solids and of meshes of space, cut away where asked: seen from afar, shaded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.errors import InputError
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import canonical_faces, faces_of
from csgmesh.mesh.surfaces import is_surface, with_facets
from csgmesh.viz.palette import EDGE, UNNAMED, boundary_color, region_color

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from csgmesh.viz.drawing import Options

#: Where the light comes from, in the viewer's directions right, up and towards him.
_LIGHT = np.array([-0.35, 0.55, 0.76])
#: Share of the light that comes from everywhere.
_AMBIENT = 0.55
#: Faces seen more obliquely than this sine are not seen: rounding alone turns them to the viewer.
_EDGE_ON = 1e-9
#: A picture's facets and lines are no longer than this part of the solid's diagonal.
_PIECES = 60
#: Beyond so many of them nothing is halved any more.
_MOST_PIECES = 200_000
#: Faces more than these are drawn without their edges.
_MANY = 40_000
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


def draw_space(x: Mesh | Plc, options: Options) -> Figure:
    """The picture of a solid or a mesh of space."""
    if options.color != "region":
        raise InputError(f"draw: color={options.color!r} belongs to the plane; leave it out here")
    shown = _of_plc(x, options) if isinstance(x, Plc) else _of_mesh(x, options)
    return _picture(shown, options)


def _of_plc(plc: Plc, options: Options) -> Polygons:
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
    front = plc.facets[np.cross(b - a, c - a) @ _axes(view)[2] > 0.0]
    sides = np.sort(front[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, n = plc.feature_edges(), plc.n_points
    return edges[np.isin(edges[:, 0] * n + edges[:, 1], sides[:, 0] * n + sides[:, 1])]


def _of_surface(mesh: Mesh, options: Options) -> Polygons:
    """The facets of a surface, with their inner sides where a cut shows them."""
    counts = ", ".join(f"{len(c):,} {kind}" for kind, c in mesh.cells.items())
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


def _of_mesh(mesh: Mesh, options: Options) -> Polygons:
    if is_surface(mesh):
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
    counts = ", ".join(f"{len(c):,} {kind}" for kind, c in mesh.cells.items())
    lines = np.zeros((0, 2, 3))
    return Polygons(corners, marker[seen], region[owner], mesh.boundary_names, lines, 0.0, counts)


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


def _axes(view: tuple[float, float]) -> np.ndarray:
    """Rows: the viewer's right, up, and the direction towards him."""
    around, above = np.radians(view)
    towards = np.array(
        [np.cos(above) * np.cos(around), np.cos(above) * np.sin(around), np.sin(above)]
    )
    right = np.array([-np.sin(around), np.cos(around), 0.0])
    return np.array([right, np.cross(towards, right), towards])


def _picture(shown: Polygons, options: Options) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    from csgmesh.viz.figure import Picture

    axes_of_view = _axes(options.view)
    seen = shown.corners @ axes_of_view.T
    normal = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
    normal /= np.maximum(np.sqrt((normal**2).sum(axis=1)), 1e-300)[:, None]
    front = np.flatnonzero(normal[:, 2] > _EDGE_ON)
    order = front[np.argsort(seen[front, :, 2].mean(axis=1), kind="stable")]
    light = _LIGHT / np.sqrt((_LIGHT**2).sum())
    shade = _AMBIENT + (1.0 - _AMBIENT) * np.maximum(normal[order] @ light, 0.0)
    used = np.unique(shown.marker[shown.marker >= 0]).tolist()
    paint = {m: _pale(to_rgb(boundary_color(k))) for k, m in enumerate(used)}
    base = np.array(
        [
            paint[m] if m >= 0 else to_rgb(region_color(r))
            for m, r in zip(shown.marker[order].tolist(), shown.region[order].tolist(), strict=True)
        ]
    ).reshape(-1, 3)
    colors = np.clip(base * shade[:, None], 0.0, 1.0)
    if options.ax is None:
        figure: Any = Picture(
            figsize=options.figsize or (7.5, 5.5), dpi=options.dpi, layout="constrained"
        )
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
    else:
        axes, figure = options.ax, options.ax.figure
    with_edges = not len(shown.lines) and len(order) <= _MANY
    flat = seen[:, :, :2].reshape(-1, 2)
    lines = shown.lines @ axes_of_view.T
    pieces = [*seen[order, :, :2], *lines[:, :, :2]]
    # A line hides behind what lies nearer to the viewer, like a polygon without an inside.
    near = lines[:, :, 2].max(axis=1, initial=-np.inf) + shown.lift
    depth = np.concatenate([seen[order, :, 2].mean(axis=1), near])
    edge = np.array([to_rgb(EDGE)])
    own = np.repeat(edge, len(order), axis=0) if with_edges else colors
    outline = np.concatenate([own, np.repeat(edge, len(lines), axis=0)])
    widths = np.r_[np.full(len(order), 0.2 if with_edges else 0.3), np.full(len(lines), 0.7)]
    sequence = np.argsort(depth, kind="stable")
    faces = np.concatenate([colors, np.repeat(edge, len(lines), axis=0)])
    axes.add_collection(
        PolyCollection(
            [pieces[k] for k in sequence.tolist()],
            facecolors=faces[sequence],
            edgecolors=outline[sequence],
            linewidths=widths[sequence],
        )
    )
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = 0.03 * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_axis_off()
    title = shown.title if options.title is None else options.title
    axes.set_title(title, fontsize=9.5, color="#333333", parse_math=False)
    if options.legend:
        _add_legend(axes, shown, paint)
    return figure


def _pale(rgb: tuple[float, float, float]) -> tuple[float, float, float]:
    """A boundary's colour as a surface: lighter, so that edges and shades can be seen on it."""
    r, g, b = (0.45 * c + 0.55 for c in rgb)
    return r, g, b


def _add_legend(axes: Any, shown: Polygons, paint: dict[int, Any]) -> None:
    from matplotlib.patches import Patch

    from csgmesh.viz import legend

    entries: list[legend.Entry] = [
        (", ".join(shown.names[m]), Patch(facecolor=color, edgecolor=UNNAMED, lw=0.4))
        for m, color in list(paint.items())[:22]
    ]
    if entries:
        legend.add(axes, entries)

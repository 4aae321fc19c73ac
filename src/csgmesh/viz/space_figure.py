"""Figures of solids and of meshes of space: seen from afar, shaded, from back to front."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from csgmesh.domain.plc import Plc
from csgmesh.mesh import Mesh
from csgmesh.viz import legend
from csgmesh.viz.figure import SCALES, Picture, add_scale
from csgmesh.viz.palette import EDGE, UNNAMED, boundary_color, region_color
from csgmesh.viz.space import Polygons, axes_of, polygons_of_mesh, polygons_of_plc

if TYPE_CHECKING:
    from csgmesh.viz.drawing import Options

#: Where the light comes from, in the viewer's directions right, up and towards him.
_LIGHT = np.array([-0.35, 0.55, 0.76])
#: Share of the light that comes from everywhere.
_AMBIENT = 0.55
#: Faces seen more obliquely than this sine are not seen: rounding alone turns them to the viewer.
_EDGE_ON = 1e-9
#: Faces more than these are drawn without their edges.
_MANY = 40_000
#: Entries of a legend, at most.
_ENTRIES = 22


def compose_space(x: Mesh | Plc, options: Options) -> Figure:
    """The picture of a solid or a mesh of space."""
    shown = polygons_of_plc(x, options) if isinstance(x, Plc) else polygons_of_mesh(x, options)
    if options.ax is None:
        figure: Any = Picture(
            figsize=options.figsize or (7.5, 5.5), dpi=options.dpi, layout="constrained"
        )
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
    else:
        axes, figure = options.ax, options.ax.figure
    viewed = axes_of(options.view)
    seen = shown.corners @ viewed.T
    order, shade = _facing(seen)
    used = np.unique(shown.marker[shown.marker >= 0]).tolist()
    paint = {m: _pale(to_rgb(boundary_color(k))) for k, m in enumerate(used)}
    colors = _colors(shown, order, paint, options.color) * shade[:, None]
    _add_polygons(axes, seen[order], np.clip(colors, 0.0, 1.0), shown.lines @ viewed.T, shown.lift)
    flat = seen[:, :, :2].reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = 0.03 * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_axis_off()
    title = shown.title if options.title is None else options.title
    axes.set_title(title, fontsize=9.5, color="#333333", parse_math=False)
    if shown.value is not None:
        add_scale(axes, options.color)
    elif options.legend:
        _add_legend(axes, shown, paint)
    return figure


def _facing(seen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The polygons that face the viewer, the farthest first, and how much light they have."""
    normal = np.cross(seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0])
    normal /= np.maximum(np.sqrt((normal**2).sum(axis=1)), 1e-300)[:, None]
    front = np.flatnonzero(normal[:, 2] > _EDGE_ON)
    order = front[np.argsort(seen[front, :, 2].mean(axis=1), kind="stable")]
    light = _LIGHT / np.sqrt((_LIGHT**2).sum())
    return order, _AMBIENT + (1.0 - _AMBIENT) * np.maximum(normal[order] @ light, 0.0)


def _colors(
    shown: Polygons, order: np.ndarray, paint: dict[int, tuple[float, float, float]], color: str
) -> np.ndarray:
    """Colours before the light: of the measure, the boundary part or the region, (n, 3)."""
    if shown.value is not None:
        value = shown.value[order]
        found = np.asarray(SCALES[color].to_rgba(value)[:, :3], float)
        found[np.isnan(value)] = 1.0
        return found
    marker, region = shown.marker[order].tolist(), shown.region[order].tolist()
    return np.array(
        [
            paint[m] if m >= 0 else to_rgb(region_color(r))
            for m, r in zip(marker, region, strict=True)
        ]
    ).reshape(-1, 3)


def _add_polygons(
    axes: Any, seen: np.ndarray, colors: np.ndarray, lines: np.ndarray, lift: float
) -> None:
    """Polygons and lines from back to front; few polygons have edges drawn."""
    with_edges = not len(lines) and len(seen) <= _MANY
    pieces = [*seen[:, :, :2], *lines[:, :, :2]]
    # A line hides behind what lies nearer to the viewer, like a polygon without an inside.
    near = lines[:, :, 2].max(axis=1, initial=-np.inf) + lift
    depth = np.concatenate([seen[:, :, 2].mean(axis=1), near])
    edge = np.array([to_rgb(EDGE)])
    own = np.repeat(edge, len(seen), axis=0) if with_edges else colors
    outline = np.concatenate([own, np.repeat(edge, len(lines), axis=0)])
    widths = np.r_[np.full(len(seen), 0.2 if with_edges else 0.3), np.full(len(lines), 0.7)]
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


def _pale(rgb: tuple[float, float, float]) -> tuple[float, float, float]:
    """A boundary's colour as a surface: lighter, so that edges and shades can be seen on it."""
    r, g, b = (0.45 * c + 0.55 for c in rgb)
    return r, g, b


def _add_legend(axes: Any, shown: Polygons, paint: dict[int, Any]) -> None:
    entries: list[legend.Entry] = [
        (", ".join(shown.names[m]), Patch(facecolor=color, edgecolor=UNNAMED, lw=0.4))
        for m, color in list(paint.items())[:_ENTRIES]
    ]
    if entries:
        legend.add(axes, entries)

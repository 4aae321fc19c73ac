"""Pictures of size fields: the wanted edge length all over a domain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.viz.scene import pslg_scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from csgmesh.viz.drawing import Options

#: Points at which a field is looked at along the longer side of the domain.
_PIXELS = 600
#: Sizes that differ by more than this factor get a logarithmic scale.
_WIDE = 4.0


def compose_field(domain: Pslg, size: Any, options: Options) -> Figure:
    """The picture of a size on a domain."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import LogNorm, Normalize

    from csgmesh.viz import paint
    from csgmesh.viz.figure import Picture, frame, room, scale_of

    scene = pslg_scene(domain, vertices=False)
    values, extent = _pixels(domain, size)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if options.ax is None:
        figure: Figure = Picture(
            figsize=options.figsize or room(scene, [], True), dpi=options.dpi, layout="constrained"
        )
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
    else:
        axes, figure = options.ax, options.ax.figure
    frame(axes, scene)
    norm = LogNorm(low, high) if high > _WIDE * low else Normalize(low, high)
    image = axes.imshow(
        values, cmap="viridis", norm=norm, origin="lower", extent=extent, interpolation="nearest"
    )
    frame(axes, scene)
    colors = dict.fromkeys(range(len(scene.boundary_names)), "#333333")
    paint.paint_lines(axes, scene, colors, scale_of(axes, scene))
    bar = figure.colorbar(image, ax=axes, shrink=0.8, pad=0.02)
    bar.set_label("wanted edge length", fontsize=8)
    bar.ax.tick_params(labelsize=7, which="both")
    title = f"edge length {low:.3g} to {high:.3g}" if options.title is None else options.title
    axes.set_title(title, fontsize=9.5, color="#333333", parse_math=False)
    return figure


def _pixels(domain: Pslg, size: Any) -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """Sizes on a grid over the domain's box, NaN outside, and its extent."""
    from csgmesh.size import pointwise

    lo, hi = domain.bounds()
    sides = hi - lo
    n = np.maximum(np.rint(_PIXELS * sides / sides.max()).astype(int), 2)
    x, y = (lo[k] + (np.arange(n[k]) + 0.5) * sides[k] / n[k] for k in (0, 1))
    points = np.stack(np.meshgrid(x, y), axis=2).reshape(-1, 2)
    inside = np.ones(len(points), bool)
    if domain.oracle is not None:
        inside = domain.oracle.region(points) >= 0
    values = np.full(len(points), np.nan)
    values[inside] = pointwise(size, domain)(points[inside])
    return values.reshape(n[1], n[0]), (float(lo[0]), float(hi[0]), float(lo[1]), float(hi[1]))

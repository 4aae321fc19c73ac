"""Figures: composing and saving, without matplotlib's global state of current figures."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from csgmesh.files import replaced
from csgmesh.viz import legend, paint
from csgmesh.viz.scene import Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from csgmesh.viz.drawing import Options

#: Ids in an SVG are hashes with this salt instead of random ones.
_SALT = "csgmesh"
_INCH = 72.0
#: Colours of the measures that cells can be filled by, and what their scales say.
SCALES = {
    "min_angle": ScalarMappable(Normalize(0, 60), "viridis"),
    "min_dihedral": ScalarMappable(Normalize(0, 90), "viridis"),
    "scaled_jacobian": ScalarMappable(Normalize(0, 1), "viridis"),
}
_LABELS = {
    "min_angle": "smallest angle (degrees)",
    "min_dihedral": "smallest dihedral angle (degrees)",
    "scaled_jacobian": "scaled Jacobian",
}


class Picture(Figure):
    """A figure that a notebook shows as SVG without any set-up."""

    def _repr_svg_(self) -> str:
        return svg(self)


def compose(scene: Scene, values: np.ndarray | None, options: Options) -> Figure:
    """The picture of a scene."""
    colors = paint.marker_colors(scene)
    entries = legend.entries(scene, colors, values is None) if options.legend else []
    if options.ax is None:
        size = options.figsize or room(scene, entries, values is not None)
        figure: Figure = Picture(figsize=size, dpi=options.dpi, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
    else:
        axes, figure = options.ax, options.ax.figure
    frame(axes, scene)
    scale = scale_of(axes, scene)
    if scene.cells:
        shares = None if values is None else np.clip(values / 60.0, 0.0, 1.0)
        paint.paint_cells(axes, scene, shares, scale)
    paint.paint_areas(axes, scene)
    paint.paint_lines(axes, scene, colors, scale)
    paint.paint_points(axes, scene, colors)
    if values is not None:
        add_scale(axes, options.color)
    title = scene.title if options.title is None else options.title
    axes.set_title(title, fontsize=9.5, color="#333333", parse_math=False)
    if entries:
        legend.add(axes, entries)
    return figure


def add_scale(axes: Axes, color: str) -> None:
    """A bar beside a picture that tells what the colours of a measure mean."""
    bar = axes.figure.colorbar(SCALES[color], ax=axes, shrink=0.8, pad=0.02)
    bar.set_label(_LABELS[color], fontsize=8)
    bar.ax.tick_params(labelsize=7)
    bar.outline.set_linewidth(0.5)


def save(figure: Figure, path: Path, form: str, metadata: Mapping[str, Any], dpi: float) -> None:
    """Write a picture; the same picture gives the same bytes."""
    with replaced(path) as temporary, rc_context({"svg.hashsalt": _SALT}):
        figure.savefig(
            temporary,
            format=form,
            dpi=dpi,
            metadata=dict(metadata),
            bbox_inches="tight",
            pad_inches=0.08,
        )


def svg(figure: Figure) -> str:
    """A figure as SVG text."""
    buffer = BytesIO()
    with rc_context({"svg.hashsalt": _SALT}):
        figure.savefig(buffer, format="svg", metadata={"Date": None}, bbox_inches="tight")
    return buffer.getvalue().decode()


def room(scene: Scene, entries: list[legend.Entry], has_scale: bool) -> tuple[float, float]:
    """Inches: the domain fills about 6.4 x 6, and the legend gets its own room."""
    width, height = np.maximum(scene.hi - scene.lo, 1e-300)
    across = 6.4 if width >= height else max(6.0 * width / height, 1.6)
    up = max(across * height / width, 0.8) if width >= height else 6.0
    longest = max((len(legend.shortened(label)) for label, _ in entries), default=0)
    beside = (0.55 + 0.075 * longest if entries else 0.0) + (0.8 if has_scale else 0.0)
    return across + beside + 0.6, max(up + 0.7, 0.19 * len(entries) + 0.4)


def frame(axes: Axes, scene: Scene) -> None:
    """Limits around a scene, and quiet axes."""
    margin = 0.025 * float((scene.hi - scene.lo).max())
    axes.set_xlim(scene.lo[0] - margin, scene.hi[0] + margin)
    axes.set_ylim(scene.lo[1] - margin, scene.hi[1] + margin)
    axes.set_aspect("equal")
    axes.tick_params(labelsize=7, length=2.5, width=0.5, color="#999999", labelcolor="#666666")
    for spine in axes.spines.values():
        spine.set(linewidth=0.5, color="#bbbbbb")


def scale_of(axes: Axes, scene: Scene) -> float:
    """Typographic points a unit of length, before the layout is final: good to a third."""
    box = axes.get_window_extent()
    dpi = axes.figure.dpi
    extent = np.maximum(scene.hi - scene.lo, 1e-300)
    return float(min(box.width / extent[0], box.height / extent[1]) / dpi * _INCH)

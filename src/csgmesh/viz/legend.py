"""The legend: regions first, then boundaries in the order of the tree."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.viz.palette import region_color
from csgmesh.viz.scene import Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Entries shown before the rest is only counted.
_MOST_REGIONS, _MOST_BOUNDARIES = 12, 22
_LONGEST = 34

Entry = tuple[str, Any]


def entries(scene: Scene, color_of: Mapping[int, str], by_region: bool) -> list[Entry]:
    """Labels and handles; the handle of a line that only counts is empty."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    found: list[Entry] = []
    if by_region and scene.region_names != ("domain",):
        for i, name in enumerate(scene.region_names[:_MOST_REGIONS]):
            found.append((name, Patch(facecolor=region_color(i), edgecolor="#9aa5b5", lw=0.5)))
        found += _rest(len(scene.region_names) - _MOST_REGIONS)
    on_lines = {int(m) for _, marker in scene.lines for m in np.unique(marker)}
    markers = list(color_of)
    for m in markers[:_MOST_BOUNDARIES]:
        style = {"lw": 2.2} if m in on_lines else {"lw": 0, "marker": "o", "markersize": 5}
        label = ", ".join(scene.boundary_names[m])
        found.append((label, Line2D([], [], color=color_of[m], **style)))
    return found + _rest(len(markers) - _MOST_BOUNDARIES)


def add(axes: Axes, found: list[Entry]) -> None:
    """Put the legend to the right of the axes."""
    legend = axes.legend(
        [handle for _, handle in found],
        # Real labels come later: here "_" would hide an entry and "$" begin a formula.
        [" "] * len(found),
        loc="upper left",
        bbox_to_anchor=(1.02, 1.0),
        borderaxespad=0.0,
        frameon=False,
        fontsize=8.5,
        handlelength=1.6,
    )
    for text, (label, _) in zip(legend.get_texts(), found, strict=True):
        text.set_parse_math(False)
        text.set_text(shortened(label))


def shortened(label: str) -> str:
    """A label that is not too long, its middle left out.

    Examples
    --------
    >>> shortened("bracket.plate.left, a very long name indeed")
    'bracket.plate.le… long name indeed'
    """
    if len(label) <= _LONGEST:
        return label
    half = _LONGEST // 2
    return f"{label[: half - 1]}…{label[-half:]}"


def _rest(count: int) -> list[Entry]:
    from matplotlib.lines import Line2D

    return [(f"… and {count:,} more", Line2D([], [], lw=0))] if count > 0 else []

"""A scene as matplotlib artists."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from csgmesh.viz.palette import EDGE, UNNAMED, boundary_color, region_color
from csgmesh.viz.scene import Scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Cells in one compound path: few artists, and within the limits of the rasteriser.
_CHUNK = 2000
#: More cells than this become an image in SVG and PDF, which would take tens of megabytes.
_VECTOR_CELLS = 20_000
#: Colours of a continuous scale.
_LEVELS = 48


def paint_cells(axes: Axes, scene: Scene, values: np.ndarray | None, scale: float) -> None:
    """Cells filled by region, or by `values` in [0, 1]; `scale` is typographic points a unit."""
    n_cells = sum(len(polygons) for polygons, _ in scene.cells)
    width = edge_width(scene, scale)
    before = 0
    for polygons, region in scene.cells:
        if values is None:
            colors = {int(r): region_color(int(r)) for r in np.unique(region)}
            group = region
        else:
            group = (values[before : before + len(polygons)] * (_LEVELS - 1)).round().astype(int)
            colors = {int(g): _viridis(int(g)) for g in np.unique(group)}
        for number, color in colors.items():
            some = polygons[group == number]
            for start in range(0, len(some), _CHUNK):
                chunk = some[start : start + _CHUNK]
                _fill(axes, chunk, color, width, n_cells > _VECTOR_CELLS)
        before += len(polygons)


def paint_areas(axes: Axes, scene: Scene) -> None:
    """Regions of a domain without cells."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    for region, loops in scene.areas.items():
        if loops:
            paths = [Path(np.vstack([loop, loop[:1]]), closed=True) for loop in loops]
            color = region_color(region)
            patch = PathPatch(Path.make_compound_path(*paths), facecolor=color, edgecolor="none")
            patch.set_in_layout(False)
            axes.add_artist(patch)


def paint_lines(axes: Axes, scene: Scene, color_of: dict[int, str], scale: float) -> None:
    """Boundaries, interfaces and embedded paths in the colours of their markers."""
    from matplotlib.collections import LineCollection

    lengths = [np.hypot(*np.diff(lines, axis=1).reshape(-1, 2).T).sum() for lines, _ in scene.lines]
    # Thinner where there is a lot of boundary, so that ten thousand holes do not run into a blot.
    width = float(np.clip(1.8 * np.sqrt(6000.0 / max(sum(lengths) * scale, 1.0)), 0.35, 1.8))
    for lines, marker in scene.lines:
        if not len(lines):
            continue
        colors = np.array([color_of.get(m, UNNAMED) for m in range(-1, len(scene.boundary_names))])
        collection = LineCollection(
            list(lines),
            colors=colors[marker + 1].tolist(),
            linewidths=width,
            capstyle="round",
            zorder=3,
        )
        collection.set_in_layout(False)
        axes.add_collection(collection, autolim=False)


def paint_points(axes: Axes, scene: Scene, color_of: dict[int, str]) -> None:
    """Embedded points, and the vertices of a PSLG."""
    if len(scene.vertices):
        size = float(np.clip(2000.0 / len(scene.vertices), 0.3, 6.0))
        axes.scatter(
            scene.vertices[:, 0],
            scene.vertices[:, 1],
            s=size,
            color=UNNAMED,
            linewidths=0,
            zorder=4,
        )
    if len(scene.points):
        colors = [color_of.get(m, UNNAMED) for m in scene.point_marker.tolist()]
        x, y = scene.points.T
        axes.scatter(x, y, s=26, c=colors, edgecolors="white", linewidths=0.8, zorder=5)


def edge_width(scene: Scene, scale: float) -> float:
    """Width of cell edges: thin, thinner in a dense mesh, 0 where they would cover the cells."""
    sides = [
        np.hypot(*(polygons[:, 0] - polygons[:, 1]).T)
        for polygons, _ in scene.cells
        if len(polygons)
    ]
    side = _typical(np.concatenate(sides)) * scale if sides else 0.0
    return 0.0 if side < 1.2 else float(np.clip(0.035 * side, 0.12, 0.5))


def _typical(sides: np.ndarray) -> float:
    """The side that half of the picture's area is finer than: most cells may crowd in a corner."""
    sides = np.sort(sides)
    covered = np.cumsum(sides**2)
    return float(sides[np.searchsorted(covered, 0.5 * covered[-1])])


def _fill(axes: Axes, polygons: np.ndarray, color: str, width: float, rasterized: bool) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    n, k = polygons.shape[:2]
    vertices = np.concatenate([polygons, polygons[:, :1]], axis=1).reshape(-1, 2)
    codes = np.full((n, k + 1), Path.LINETO, Path.code_type)
    codes[:, 0], codes[:, -1] = Path.MOVETO, Path.CLOSEPOLY
    # Without edges a hairline of the same colour closes the seams that antialiasing leaves.
    patch = PathPatch(
        Path(vertices, codes.ravel()),
        facecolor=color,
        edgecolor=EDGE if width else color,
        linewidth=width or 0.25,
        joinstyle="round",
        rasterized=rasterized,
        zorder=1,
    )
    # Limits and layout are known without it; finding its extent would cost more than drawing it.
    patch.set_in_layout(False)
    axes.add_artist(patch)


def _viridis(level: int) -> str:
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return to_hex(colormaps["viridis"](level / (_LEVELS - 1)))


def marker_colors(scene: Scene) -> dict[int, str]:
    """A colour for each marker in use, in order of appearance."""
    used = {int(m) for _, marker in scene.lines for m in np.unique(marker)}
    used |= {int(m) for m in np.unique(scene.point_marker)}
    return {m: boundary_color(i) for i, m in enumerate(sorted(used - {-1}))}

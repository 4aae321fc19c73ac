"""The verb `draw`."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import FileFormatError, InputError
from csgmesh.mesh import Mesh
from csgmesh.options import check_choice, check_options, near
from csgmesh.size import SizeField
from csgmesh.tree import LinearTree
from csgmesh.viz.scene import Scene, mesh_scene, pslg_scene, tree_scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: What can fill the cells, by dimension.
_COLORS: dict[int, tuple[str, ...]] = {
    2: ("region", "min_angle"),
    3: ("region", "min_dihedral", "scaled_jacobian"),
}
_FORMATS = {".png": "png", ".svg": "svg", ".pdf": "pdf"}
#: What makes the same picture the same bytes: no dates, no random ids, no version.
_METADATA = {
    "png": {"Software": None},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
}


@dataclass(frozen=True)
class Options:
    """Options of `draw`."""

    ax: Any = None
    figsize: tuple[float, float] | None = None
    color: str = "region"
    legend: bool = True
    title: str | None = None
    dpi: float = 150.0
    view: tuple[float, float] = (-60.0, 25.0)
    cut: tuple[Any, Any] | None = None
    domain: Any = None


def draw(x: Any, path: str | os.PathLike[str] | None = None, **options: Any) -> Figure | None:
    """Draw a shape, a domain, a mesh, or a size on a domain.

    Regions are filled with pale colours, boundaries have strong ones and are named in the legend;
    embedded paths and points are drawn like boundaries. A domain is drawn through its exact curves,
    a mesh as the straight cells that it has. A size is shown by colour all over the domain.

    Parameters
    ----------
    x : Shape, Regions, Embed, Periodic, Pslg, Plc, Mesh, LinearTree or SizeField
        What to draw; shapes are evaluated first. With `domain`, also a number, a mapping or a
        callable, as `generate` takes it for a size.
    path : str or PathLike, optional
        A ``.png``, ``.svg`` or ``.pdf`` file to write.
    ax : matplotlib.axes.Axes, optional
        Draw there instead of in a figure of its own.
    figsize : (float, float), optional
        Width and height in inches; default after the shape of the domain.
    color : {"region", "min_angle", "min_dihedral", "scaled_jacobian"}
        What fills the cells: their region, or a measure as `quality` has it, with a scale:
        ``min_angle`` in the plane, the others in space. Cells without the measure are white.
    legend : bool
        Default True.
    title : str, optional
        Default: counts. An empty string for none.
    dpi : float
        Resolution of a PNG, and of a dense mesh within SVG and PDF; default 150.
    domain : Shape, Regions, Embed or Pslg
        On which a size is drawn; only for sizes.
    view : (float, float)
        In space: degrees around the z axis from +x, and above the plane z = 0, that a solid is
        seen from; default (-60, 25).
    cut : (point, normal), optional
        In space: leave out the cells in front of a plane.

    Returns
    -------
    matplotlib.figure.Figure or None
        The figure if there is no `path`. It shows itself in a notebook.

    Raises
    ------
    InputError
        For an unknown option, or something that cannot be drawn.
    FileFormatError
        If the suffix is not one of the three, or the file cannot be written.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
    >>> cm.draw(mesh, "/tmp/one.svg")
    >>> cm.draw(mesh).axes[0].get_title()
    '1 triangle, 3 points'
    """
    check_options(options, [f.name for f in fields(Options)], "draw")
    chosen = Options(**options)
    _check(chosen)
    target = None if path is None else _target(Path(path))
    from csgmesh.viz.figure import compose

    if chosen.domain is not None or isinstance(x, SizeField):
        return _kept(_field(x, chosen), target, chosen)
    is_domain = isinstance(x, Pslg)
    if chosen.color != "region" and not isinstance(x, Mesh):
        raise InputError(f"draw: color={chosen.color!r} needs a Mesh; got {type(x).__name__}")
    x = _drawable(x)
    if chosen.color not in _COLORS[x.dim]:
        known = ", ".join(map(repr, _COLORS[x.dim]))
        other = "space" if x.dim == 2 else "the plane"
        raise InputError(
            f"draw: color={chosen.color!r} belongs to {other}; here it is one of {known}"
        )
    if x.dim == 3:
        from csgmesh.viz.space_figure import compose_space

        return _kept(compose_space(x, chosen), target, chosen)
    _refuse_space_options(options)
    if isinstance(x, LinearTree):
        scene = tree_scene(x)
    else:
        scene = mesh_scene(x) if isinstance(x, Mesh) else pslg_scene(x, vertices=is_domain)
    values = None
    if chosen.color == "min_angle":
        values = min_angles(scene)
    return _kept(compose(scene, values, chosen), target, chosen)


def _kept(figure: Figure, target: tuple[Path, str] | None, options: Options) -> Figure | None:
    """The figure, or None once it is written."""
    from csgmesh.viz.figure import save

    if target is None:
        return figure
    save(figure, *target, _METADATA[target[1]], options.dpi)
    return None


def _refuse_space_options(options: dict[str, Any]) -> None:
    for name in ("view", "cut"):
        if name in options:
            raise InputError(f"draw: {name} belongs to space; this lies in the plane")


def _field(x: object, options: Options) -> Figure:
    from csgmesh.boundary import evaluate
    from csgmesh.viz.field import compose_field

    if options.domain is None:
        raise InputError("draw: a size is drawn on a domain; give domain=shape")
    if isinstance(x, (Mesh, Pslg)):
        raise InputError(f"draw: domain= goes with a size; got {type(x).__name__}")
    return compose_field(evaluate(options.domain), x, options)


def _check(options: Options) -> None:
    check_choice("color", options.color, tuple(dict.fromkeys((*_COLORS[2], *_COLORS[3]))), "draw")
    if np.shape(options.view) != (2,) or not np.isfinite(options.view).all():
        raise InputError(f"draw: view must be two angles in degrees; got {options.view!r}")
    if options.cut is not None and np.shape(options.cut) != (2, 3):
        raise InputError(f"draw: cut must be a point and a normal, each (3,); got {options.cut!r}")
    size = options.figsize
    if size is not None and not (np.shape(size) == (2,) and min(size) > 0):
        raise InputError(f"draw: figsize must be two positive lengths in inches; got {size!r}")
    if not 1 <= options.dpi <= 10_000:
        raise InputError(f"draw: dpi must be a number from 1 to 10000; got {options.dpi!r}")


def min_angles(scene: Scene) -> np.ndarray:
    """Smallest angle of each cell, degrees, at the corners of the polygon that is drawn."""
    found = []
    for polygons, _ in scene.cells:
        ahead = np.roll(polygons, -1, axis=1) - polygons
        back = np.roll(polygons, 1, axis=1) - polygons
        cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
        angle = np.arctan2(cross, (ahead * back).sum(axis=2)) % (2 * np.pi)
        found.append(np.degrees(angle.min(axis=1)))
    return np.concatenate([*found, np.zeros(0)])


def _target(path: Path) -> tuple[Path, str]:
    suffix = path.suffix.lower()
    if suffix not in _FORMATS:
        raise FileFormatError(
            f"{path}: pictures are written as .png, .svg or .pdf; got {suffix!r}; "
            f"{near(suffix, _FORMATS)}"
        )
    return path, _FORMATS[suffix]


def _drawable(x: Any) -> Any:
    """A mesh or a domain: shapes are evaluated."""
    if isinstance(x, Mesh | Pslg | Plc | LinearTree):
        return x
    from csgmesh.boundary import evaluate
    from csgmesh.csg import Embed, Periodic, Regions, Shape

    if not isinstance(x, (Shape, Regions, Embed, Periodic)):
        raise InputError(f"draw knows shapes, Pslg, Plc and Mesh; got {type(x).__name__}")
    return evaluate(x)

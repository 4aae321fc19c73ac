"""One domain through every mesher that can take it."""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.boundary import evaluate
from csgmesh.errors import CsgmeshError, InputError

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg
    from csgmesh.mesh import Mesh

Progress = Callable[[str, int, int], None]

#: Longest reason told in a table.
_WIDEST = 70
#: Smallest angles of the best cells, radians; dihedral ones in space.
_BEST = {
    "triangle": np.pi / 3,
    "quad": np.pi / 2,
    "tetra": np.arccos(1 / 3),
    "hexahedron": np.pi / 2,
    "wedge": np.pi / 3,
    "pyramid": np.arccos(1 / np.sqrt(3)),
}


@dataclass(frozen=True)
class Row:
    """What became of a domain in one mesher.

    Attributes
    ----------
    mesher : str
    cells : str
        Numbers of cells by kind.
    worst, mean : float
        Quality of the cells: the scaled Jacobian of quads and hexahedra; of others the sine of the
        smallest angle over that of the best cell: 60 degrees in triangles, dihedral angles of 70.5
        in tetrahedra, 60 in wedges, 54.7 in pyramids. 1 is best.
    min_angle : float
        Degrees; of cells in space the smallest dihedral angle.
    seconds : float
        Processor time of a second run, when everything is compiled.
    megabytes : float
        Most memory that was in use at once, as Python counts it, in millions of bytes.
    size_error : float
        Mean of abs(log(edge length / wanted length)); NaN without a size.
    reason : str
        Why there is no mesh; empty if there is one.
    """

    mesher: str
    cells: str = ""
    worst: float = np.nan
    mean: float = np.nan
    min_angle: float = np.nan
    seconds: float = np.nan
    megabytes: float = np.nan
    size_error: float = np.nan
    reason: str = ""


@dataclass(frozen=True)
class Comparison:
    """A row for each mesher; printed, a table."""

    rows: tuple[Row, ...]

    def __str__(self) -> str:
        width = max(len(row.mesher) for row in self.rows)
        kinds = max([5, *(len(row.cells) for row in self.rows)])
        lines = [
            f"{'mesher':<{width}}  {'cells':<{kinds}}  {'worst':>6}  {'mean':>6}  {'angle':>6}  "
            f"{'seconds':>8}  {'MB':>7}  {'size error':>10}"
        ]
        for row in self.rows:
            if row.reason:
                lines.append(f"{row.mesher:<{width}}  cannot: {row.reason}")
                continue
            error = "" if np.isnan(row.size_error) else f"{row.size_error:.3f}"
            lines.append(
                f"{row.mesher:<{width}}  {row.cells:<{kinds}}  {row.worst:>6.3f}  {row.mean:>6.3f}"
                f"  {row.min_angle:>6.2f}  {row.seconds:>8.4f}  {row.megabytes:>7.2f}  {error:>10}"
            )
        return "\n".join(lines)


def compare(
    shape: Any,
    size: Any = None,
    meshers: Mapping[str, Any] | None = None,
    *,
    deviation: float | None = None,
    snap: float | None = None,
    max_points: int | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Mesh a shape by every mesher that can take it.

    Parameters
    ----------
    shape : Shape, Regions, Embed or Pslg
        What to mesh.
    size : float, mapping, callable or SizeField, optional
        Wanted edge length, as `generate` takes it.
    meshers : mapping of str to mesher, optional
        By the names to print. Default: all of the plane, or all of space, with their own options.
    deviation, snap : float, optional
        As `generate` takes them.
    max_points : int, optional
        Bound on the points of each mesh.
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    Returns
    -------
    Comparison
        ``.rows``; printing it shows a table.

    Raises
    ------
    InputError
        If an argument breaks a rule, or the size names nothing.

    Examples
    --------
    >>> import csgmesh as cm
    >>> table = cm.compare(cm.Triangle((0, 0), (1, 0), (0, 1)), size=0.2)
    >>> {row.mesher: row.reason[:32] for row in table.rows}["Structured"]
    'a structured grid knows boxes wi'
    """
    from csgmesh.size import resolve

    domain = evaluate(shape, deviation=deviation, snap=snap)
    resolve(size, domain)
    chosen = meshers_of(domain.dim) if meshers is None else dict(meshers)
    rows = []
    for k, (name, mesher) in enumerate(chosen.items()):
        if not callable(getattr(mesher, "generate", None)):
            raise InputError(f"meshers must be objects such as QuadPairing(); got {mesher!r}")
        if progress is not None:
            progress(f"compare: {name}", k, len(chosen))
        rows.append(_row(name, _bounded(mesher, max_points), domain, size))
    return Comparison(tuple(rows))


def meshers_of(dim: int) -> dict[str, Any]:
    """Every mesher of the plane or of space, some with several sets of options."""
    from csgmesh import meshers as m

    if dim == 3:
        return {
            "SurfaceRefinement": m.SurfaceRefinement(),
            "Octree": m.Octree(),
            "Octree, mixed": m.Octree(cells="mixed"),
            "Octree, hexahedra": m.Octree(cells="hexahedron"),
            "Sweep": m.Sweep(),
            "Sweep, hexahedra": m.Sweep(m.QuadPairing()),
        }
    return {
        "ConstrainedDelaunay": m.ConstrainedDelaunay(),
        "DelaunayRefinement": m.DelaunayRefinement(),
        "DelaunayRefinement, improved": m.DelaunayRefinement(improve=True),
        "Quadtree": m.Quadtree(),
        "QuadPairing": m.QuadPairing(),
        "Structured": m.Structured(),
        "Structured, triangles": m.Structured(cells="triangle"),
    }


def _bounded(mesher: Any, max_points: int | None) -> Any:
    if max_points is None or "max_points" not in {option.name for option in fields(mesher)}:
        return mesher
    return replace(mesher, max_points=min(mesher.max_points, max_points))


def _row(name: str, mesher: Any, domain: Pslg, size: Any) -> Row:
    from csgmesh.meshers import ConstrainedDelaunay

    wanted = None if isinstance(mesher, ConstrainedDelaunay) else size
    try:
        # The first run compiles what is not compiled yet.
        mesher.generate(domain, wanted)
    except CsgmeshError as error:
        reason = str(error)
        return Row(name, reason=reason if len(reason) <= _WIDEST else reason[: _WIDEST - 1] + "…")
    tracemalloc.start()
    mesher.generate(domain, wanted)
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    start = time.process_time()
    mesh = mesher.generate(domain, wanted)
    seconds = time.process_time() - start
    return _measured(name, mesh, domain, wanted, seconds, memory / 1e6)


def _measured(
    name: str, mesh: Mesh, domain: Pslg, size: Any, seconds: float, megabytes: float
) -> Row:
    from csgmesh.measures import quality
    from csgmesh.measures.space.quality import SpaceQuality
    from csgmesh.mesh.description import counted

    measured = quality(mesh)
    angle = measured.min_dihedral if isinstance(measured, SpaceQuality) else measured.min_angle
    best = np.concatenate([np.full(len(rows), _BEST[kind]) for kind, rows in mesh.cells.items()])
    shape = np.sin(np.radians(angle)) / np.sin(best)
    has_jacobian = ~np.isnan(measured.scaled_jacobian)
    shape[has_jacobian] = measured.scaled_jacobian[has_jacobian]
    cells = ", ".join(counted(len(rows), kind) for kind, rows in mesh.cells.items())
    return Row(
        name,
        cells,
        float(shape.min()),
        float(shape.mean()),
        float(angle.min()),
        seconds,
        megabytes,
        _size_error(mesh, domain, size),
    )


def _size_error(mesh: Mesh, domain: Pslg, size: Any) -> float:
    """How far edges are from their wanted length; on named boundaries only where sizes are named.

    Between named boundaries and what is around, the gradation decides what is wanted.
    """
    from csgmesh.mesh.topology import edge_ends
    from csgmesh.size import resolve

    wanted = resolve(size, domain)
    if wanted is None:
        return np.nan
    logs = [np.zeros(0)]
    if wanted.boundary:
        for markers, source in wanted.boundary:
            facets = {
                kind: rows[np.isin(mesh.facet_marker[kind], markers)]
                for kind, rows in mesh.facets.items()
            }
            logs.append(_logs(mesh.points, edge_ends(facets, mesh.n_points), source))
    elif wanted.default is not None:
        logs.append(_logs(mesh.points, edge_ends(mesh.cells, mesh.n_points), wanted.default))
    joined = np.concatenate(logs)
    return float(joined.mean()) if len(joined) else np.nan


def _logs(points: np.ndarray, rows: np.ndarray, wanted: Any) -> np.ndarray:
    from csgmesh.size.resolve import evaluate as sizes_at

    a, b = points[rows[:, 0]], points[rows[:, 1]]
    length = np.sqrt(((b - a) ** 2).sum(axis=1))
    return np.asarray(np.abs(np.log(length / sizes_at(wanted, 0.5 * (a + b)))))

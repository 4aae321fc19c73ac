"""Sweep a planar mesh through an extrusion or a revolution."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from csgmesh.domain.names import find_names
from csgmesh.domain.plc import Plc
from csgmesh.domain.sweep import SweptDomain
from csgmesh.errors import InputError, MeshingError
from csgmesh.mesh import Mesh
from csgmesh.meshers.axis_core import AxisCore, axis_core
from csgmesh.meshers.delaunay_refinement import DelaunayRefinement
from csgmesh.meshers.per_region.mesher import Mesher
from csgmesh.meshers.stations import source_of_place, stations
from csgmesh.meshers.swept_cells import swept_cells, swept_facets
from csgmesh.meshers.workspace import Progress
from csgmesh.options import check_choice, check_whole


@dataclass(frozen=True)
class Sweep:
    """Wedges and hexahedra of extrusions and revolutions, in layers of a planar mesh.

    Also of a single box or cylinder. Triangles of the planar mesh become wedges, quads hexahedra.
    At the axis of a revolution triangles become tetrahedra and pyramids; quads with a side on the
    axis become wedges, and those with a corner there two pyramids.

    Parameters
    ----------
    mesher : mesher of the plane, optional
        For the profile; `DelaunayRefinement` unless given.
    layers : int, optional
        Layers along the sweep; by default as many as the size asks for, or, without one, as make
        cells as long as the profile's edges. Either way they are as thick as the size asks for
        where it varies along the sweep or an end has one of its own.
    max_points : int, default 10**7
        Most points, of the profile and of the mesh.
    axis : {"wedges", "o-grid"}, default "wedges"
        What quads with a side on the axis of a full turn become: a wedge a layer, or together an
        O-grid of hexahedra, of a number of layers that is a multiple of four.

    Raises
    ------
    InputError
        If an option is out of range.

    Guarantees
    ----------
    The mesh conforms. Vertices on the boundary lie on its exact surfaces. Jacobians are positive
    all over each cell if the quads of the profile are convex. Names and regions are those of the
    solid.

    Exceptions
    ----------
    A solid that is not a single extrusion, revolution, box or cylinder is refused. Each layer is
    the same mesh of the profile, as thick everywhere: where a size varies along the sweep and
    across the profile, the smallest along counts across, and the smallest across counts along. A
    size of an end makes layers thin near it, a size of a side the profile's edges short; fields
    that are tied to names, such as `NearSize`, take those of the profile.

    An O-grid is refused with the place where a cell of the profile meets the axis other than as a
    quad with a side on it. It is one cell of the profile wide, so its cells are small.

    Termination
    -----------
    As of the mesher of the profile.

    References
    ----------
    .. [1] M. L. Staten, S. A. Canann, S. J. Owen, "BMSweep: locating interior nodes during
       sweeping", Engineering with Computers 15 (1999).

    Examples
    --------
    >>> import csgmesh as cm
    >>> washer = cm.Extrude(cm.Disk((0, 0), 2) - cm.Disk((0, 0), 1), 0.5)
    >>> mesh = cm.generate(washer, cm.Sweep(layers=2), size=0.4)
    >>> list(mesh.cells)
    ['wedge']
    >>> mesh.names
    ('extrude.start', 'extrude.end', 'extrude.side.disk', 'extrude.side.disk.2')
    """

    mesher: Mesher | None = None
    layers: int | None = None
    max_points: int = 10**7
    axis: Literal["wedges", "o-grid"] = "wedges"

    dim = 3

    def __post_init__(self) -> None:
        if self.mesher is not None and (
            not callable(getattr(self.mesher, "generate", None))
            or isinstance(self.mesher, type)
            or getattr(self.mesher, "dim", 2) != 2
        ):
            raise InputError(
                f"mesher must be a mesher of the plane, such as DelaunayRefinement(); "
                f"got {self.mesher!r}"
            )
        layers = self.layers
        if layers is not None and (isinstance(layers, bool) or not isinstance(layers, int)):
            raise InputError(f"layers must be a whole number; got {layers!r}")
        if layers is not None and layers < 1:
            raise InputError(f"layers must be at least 1; got {layers!r}")
        check_whole("max_points", self.max_points, 16)
        check_choice("axis", self.axis, ("wedges", "o-grid"), "Sweep")
        if self.axis == "o-grid" and layers is not None and layers % 4:
            raise InputError(f"layers must be a multiple of 4 around an O-grid; got {layers}")

    def generate(self, domain: Plc, size: Any = None, progress: Progress | None = None) -> Mesh:
        """Mesh a solid.

        Parameters
        ----------
        domain : Plc
            Of an extrusion, a revolution, a box or a cylinder.
        size : None, float, mapping, callable or SizeField
            Wanted edge length.
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Returns
        -------
        Mesh
            Wedges, hexahedra, and at an axis tetrahedra and pyramids.

        Raises
        ------
        MeshingError
            If the domain is not swept by a planar one, or the profile cannot be meshed.
        BudgetError
            If `max_points` do not suffice.
        SizeError, NameLookupError
            If the size is not positive and finite somewhere, or names nothing.
        """
        sweep = domain.sweep
        if sweep is None:
            raise MeshingError(
                "Sweep meshes a single extrusion, revolution, box or cylinder; this solid is a "
                "combination. Combine in the plane first, then extrude or revolve"
            )
        mesher = self._profile_mesher()
        flat = mesher.generate(sweep.profile, planar_size(size, sweep, domain), progress)
        has_core = self.axis == "o-grid" and bool(_on_axis(flat, sweep).any())
        if has_core and not sweep.is_closed:
            raise MeshingError(
                f"an O-grid at the axis needs a full turn; this one is of {sweep.amount:g} degrees"
            )
        multiple = 4 if has_core else 1
        at = stations(flat, sweep, domain, size, self.layers, self.max_points, multiple)
        info = {"method": "Sweep", "profile": type(mesher).__name__, "layers": len(at) - 1}
        return swept_mesh(flat, sweep, domain, at, info, has_core=has_core)

    def _profile_mesher(self) -> Any:
        mesher: Any = self.mesher or DelaunayRefinement()
        if getattr(mesher, "max_points", 0) > self.max_points:
            return replace(mesher, max_points=self.max_points)
        return mesher


def planar_size(size: Any, sweep: SweptDomain, domain: Plc) -> Any:
    """What a size in space asks of the profile."""
    stretch = float(np.linalg.norm(sweep.matrix, 2))
    if size is None:
        return None
    if not isinstance(size, Mapping):
        return _flattened(size, sweep, stretch, domain)
    out: dict[str, Any] = {}
    solid = {name: flat for flat, name in sweep.side.items()}
    for key, value in size.items():
        if key == "default":
            out["default"] = _flattened(value, sweep, stretch, domain)
            continue
        for name in find_names(key, [*domain.names, *domain.region_names]):
            if name in solid:
                out[solid[name]] = _flattened(value, sweep, stretch, domain)
            elif name in domain.region_names:
                out["default"] = _flattened(value, sweep, stretch, domain)
    return out


def _flattened(value: Any, sweep: SweptDomain, stretch: float, domain: Plc) -> Any:
    if isinstance(value, (int, float)):
        return value / stretch
    source = source_of_place(value, "size", domain)
    return value if source is None else _AlongTheSweep(source, sweep, stretch)


@dataclass(frozen=True, eq=False)
class _AlongTheSweep:
    """The smallest size on a few stations of the sweep."""

    size: Callable[[np.ndarray], Any]
    sweep: SweptDomain
    stretch: float

    def __call__(self, points: np.ndarray) -> np.ndarray:
        stations = np.linspace(0.0, self.sweep.amount, 9)
        values = []
        for at in stations:
            values.append(np.asarray(self.size(self.sweep.carried(points, at))))
        return np.min(values, axis=0) / self.stretch


def _on_axis(flat: Mesh, sweep: SweptDomain) -> np.ndarray:
    """Which points of the profile stay where they are."""
    if not sweep.is_turned:
        return np.zeros(flat.n_points, bool)
    return np.asarray(np.abs(flat.points[:, 0]) <= sweep.profile.snap)


def swept_mesh(
    flat: Mesh,
    sweep: SweptDomain,
    domain: Plc,
    at: np.ndarray,
    info: dict[str, object],
    *,
    has_core: bool = False,
) -> Mesh:
    """The planar mesh in layers between stations of the sweep."""
    n_layers = len(at) - 1
    on_axis = _on_axis(flat, sweep)
    place = flat.points.copy()
    place[on_axis, 0] = 0.0
    n_stations = n_layers + (not sweep.is_closed)
    n = flat.n_points
    number = np.arange(n_stations * n).reshape(n_stations, n)
    number[1:, on_axis] = number[0, on_axis]
    points = np.concatenate([sweep.carried(place, float(a)) for a in at[:n_stations]])
    after = number[np.arange(1, n_layers + 1) % n_stations]
    # Counterclockwise in (r, z) is clockwise seen along the turn, and mirroring turns again.
    flips = sweep.is_turned != bool(np.linalg.det(sweep.matrix) < 0.0)
    flat_cells, flat_region, core = dict(flat.cells), dict(flat.cell_region), None
    if has_core:
        core = axis_core(flat, sweep, at, number, on_axis)
        flat_cells["quad"] = flat_cells["quad"][~core.column]
        flat_region["quad"] = flat_region["quad"][~core.column]
        points = np.concatenate([points, core.points])
    cells, region = swept_cells(flat_cells, flat_region, number[:n_layers], after, on_axis, flips)
    if core is not None:
        cells, region = _joined(cells, core.hexahedra), _joined(region, core.region)
    facets, marker, names = _facets(flat, domain, number, after, on_axis, flips, core)
    used, renumbered = _compact(cells, facets)
    kinds = list(facets)
    return Mesh(
        points[used],
        {k: renumbered[rows] for k, rows in cells.items()},
        region,
        domain.region_names,
        {k: renumbered[facets[k]] for k in kinds},
        {k: marker[k] for k in kinds},
        names,
        {k: np.tile([0, -1], (len(facets[k]), 1)) for k in kinds},
        domain=domain,  # type: ignore[arg-type]
        info=info,
    )


def _joined(table: dict[str, np.ndarray], more: np.ndarray) -> dict[str, np.ndarray]:
    """A table of cells with more hexahedra, which stay first."""
    have = table.get("hexahedron", more[:0])
    rest = {kind: rows for kind, rows in table.items() if kind != "hexahedron"}
    return {"hexahedron": np.concatenate([have, more]), **rest}


def _facets(
    flat: Mesh,
    domain: Plc,
    number: np.ndarray,
    after: np.ndarray,
    on_axis: np.ndarray,
    flips: bool,
    core: AxisCore | None,
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], tuple[tuple[str, ...], ...]]:
    sweep = domain.sweep
    assert sweep is not None
    lines = flat.facets["line"]
    outer = flat.facet_region["line"][:, 1] < 0
    entry = [
        tuple(sweep.side[n] for n in names if n in sweep.side) for names in flat.boundary_names
    ]
    kept = outer & (on_axis[lines].sum(axis=1) <= (1 if core is None else 0))
    own = [entry[m] for m in flat.facet_marker["line"][kept].tolist()]
    n_layers = len(after)
    pieces = swept_facets(lines[kept], number[:n_layers], after, on_axis, flips)
    found: dict[str, list[np.ndarray]] = {}
    labels: dict[str, list[tuple[str, ...]]] = {}
    for kind, rows, source in pieces:
        found.setdefault(kind, []).append(rows)
        labels.setdefault(kind, []).extend(own[k] for k in source.tolist())
    if core is not None:
        found.setdefault("quad", []).append(core.facets)
        ends = flat.facet_marker["line"][core.facet_line]
        labels.setdefault("quad", []).extend(entry[m] for m in ends.tolist())
    if not sweep.is_closed:
        for name, station, turned in ((sweep.start, 0, not flips), (sweep.end, -1, flips)):
            for kind, rows in flat.cells.items():
                cap = number[station][rows[:, ::-1] if turned else rows]
                found.setdefault(kind, []).append(cap)
                labels.setdefault(kind, []).extend([(str(name),)] * len(cap))
    used = {label for own in labels.values() for label in own}
    table = tuple(entry for entry in domain.boundary_names if entry in used)
    table += tuple(sorted(used.difference(table)))
    position = {names: k for k, names in enumerate(table)}
    facets = {kind: np.concatenate(found[kind]) for kind in sorted(found)}
    marker = {k: np.array([position[label] for label in labels[k]], np.int64) for k in facets}
    return facets, marker, table


def _compact(
    cells: dict[str, np.ndarray], facets: dict[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    used = np.unique(np.concatenate([rows.ravel() for rows in cells.values()]))
    number = np.full(int(used.max(initial=-1)) + 1, -1)
    number[used] = np.arange(len(used))
    return used, number

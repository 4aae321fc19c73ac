"""From a tree of solids to its named boundary with exact surfaces.

1. Every leaf becomes facets that know their exact surfaces (`facets`). Half-spaces become boxes
   that reach beyond everything else. Leaves whose surfaces coincide are cut alike (`leaves`).
2. manifold3d makes a body of each region less the later ones (`booleans`).
3. Where bodies touch themselves or one another, facets are split until those that overlap are
   equal (`touching`); so are facets that coincide with other leaves' facets.
4. Equal facets become one, between two regions, with the names of all leaves there (`sheets`).
5. Vertices move onto the exact surfaces around them (`projection`): facets approximate a surface,
   but an edge between two surfaces must lie on both. What that turns over is mended (`untangling`).

Where facets meet in a corner and the exact surfaces do not, leaves there get finer facets, and all
is done again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from csgmesh.boundary.booleans import canonical, regions_of
from csgmesh.boundary.coincidence import coincidence
from csgmesh.boundary.facets import Facets
from csgmesh.boundary.leaves import Frame, frame_of, leaf_bodies
from csgmesh.boundary.projection import project_vertices
from csgmesh.boundary.sheet_table import Sheets
from csgmesh.boundary.sheets import joined, with_rivals
from csgmesh.boundary.shells import shells
from csgmesh.boundary.sweeps import swept_domain
from csgmesh.boundary.touching import settle
from csgmesh.boundary.untangling import untangled
from csgmesh.csg import Embed
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.program import Leaf, Program, compile_shape
from csgmesh.domain.plc import Plc
from csgmesh.domain.pslg import marker_table
from csgmesh.domain.report import Merge, Report
from csgmesh.domain.surfaces import Surfaces
from csgmesh.errors import EmptyDomainError, ShapeError, UnboundedDomainError
from csgmesh.tolerance import DEVIATION_SHARE, SNAP_SHARE, coordinate_ulp

#: Vertices this far off a surface, in local coordinates, are not on it.
_ON = 1e-10
#: How often facets are made finer where exact surfaces do not meet as facets do, at most.
_ROUNDS = 1


@dataclass(frozen=True, eq=False)
class _Stock:
    """All surfaces of all leaves, in local coordinates."""

    surfaces: Surfaces
    leaf: np.ndarray
    parts: tuple[tuple[int, ...], ...]  # none: the far sides of a half-space


@dataclass(frozen=True)
class _Again:
    """The same evaluation, finer around some places."""

    shape: Any
    deviation: float | None
    snap: float | None
    finer: tuple[np.ndarray, ...]

    def __call__(self, places: np.ndarray) -> Plc:
        return evaluate_solid(self.shape, self.deviation, self.snap, (*self.finer, places))


def evaluate_solid(
    shape: Any,
    deviation: float | None,
    snap: float | None,
    finer: tuple[np.ndarray, ...] = (),
) -> Plc:
    """The boundary of a solid; see `csgmesh.evaluate`."""
    if isinstance(shape, Embed):
        raise ShapeError("Embed in space cannot be evaluated: paths and points lie in the plane")
    program = compile_shape(shape)
    frame = frame_of(program.leaves)
    diagonal = 2.0 * frame.scale
    user_snap = max(
        snap or SNAP_SHARE * diagonal, coordinate_ulp(frame.centre, diagonal * np.ones(1))
    )
    near = user_snap / frame.scale
    bodies = leaf_bodies(program.leaves, frame, deviation, near, finer)
    stock = _stock(bodies)
    classes = coincidence(stock.surfaces, near)
    sheets = regions_of([code for _, code in program.regions], bodies, program.leaves)
    if not len(sheets.triangles):
        raise EmptyDomainError("the domain is empty: nothing is left after all operations")
    _refuse_unbounded(sheets, stock, frame)
    shared = classes.shared(stock.leaf)
    sheets = with_rivals(sheets, _leaf_sheets(bodies), stock.leaf, classes.of, shared)
    settled = settle(sheets, shells(bodies, program.leaves, stock.surfaces), near)
    found = joined(settled, classes.of, stock.leaf, stock.parts, program.leaves)
    if not len(found.triangles):
        raise EmptyDomainError("the domain is empty: what is left has no thickness")
    report = _report(settled, stock, program, frame)
    table, marker = _markers(found.names, found.name, program.leaves)
    before, triangles, surface, region, marker = canonical(
        settled.points, found.triangles, found.surface, found.region, marker
    )
    points, surfaces = project_vertices(before, triangles, surface, classes.surfaces)
    again = _Again(shape, deviation, snap, finer)
    lost = _strays(points, triangles, surface, surfaces)
    if len(lost) and len(finer) < _ROUNDS:
        return again(lost * frame.scale + frame.centre)
    sides = np.column_stack([marker, region])
    mended = untangled(before, points, triangles, surface, sides, surfaces)
    points, triangles = mended.points, mended.triangles
    if len(mended.parent) < len(surface):
        points, triangles, surface, region, marker = canonical(
            points, triangles, *(of[mended.parent] for of in (surface, region, marker))
        )
    used, number = np.unique(surface, return_inverse=True)
    exact = surfaces[used].transformed(frame.scale * np.eye(3), frame.centre)
    return Plc.build(
        points=points * frame.scale + frame.centre,
        facets=triangles,
        facet_surface=number,
        facet_marker=marker,
        facet_region=region,
        boundary_names=table,
        region_names=tuple(name for name, _ in program.regions),
        surfaces=exact,
        deviation=float(deviation or _largest_deviation(program.leaves)),
        snap=user_snap,
        report=report,
        oracle=program,
        sweep=swept_domain(program, deviation),
        finer=again,
    )


def _strays(
    points: np.ndarray, triangles: np.ndarray, surface: np.ndarray, surfaces: Surfaces
) -> np.ndarray:
    """Vertices (k, 3) that are not on all surfaces around them, for these meet nowhere near."""
    vertex, on = triangles.ravel(), np.repeat(surface, 3)
    low, high = np.full(len(points), len(surfaces)), np.full(len(points), -1)
    np.minimum.at(low, vertex, on)
    np.maximum.at(high, vertex, on)
    several = np.flatnonzero((low < high)[vertex])
    off = surfaces.distance(on[several], points[vertex[several]])
    return points[np.unique(vertex[several[off > _ON]])]


def _stock(bodies: Sequence[Facets]) -> _Stock:
    return _Stock(
        Surfaces.concatenate([body.surfaces for body in bodies]),
        np.repeat(np.arange(len(bodies)), [len(body.surfaces) for body in bodies]),
        tuple(parts for body in bodies for parts in body.parts),
    )


def _leaf_sheets(bodies: Sequence[Facets]) -> Sheets:
    """The boundaries of all leaves."""
    first_point = np.cumsum([0, *(len(body.points) for body in bodies[:-1])]).tolist()
    first_surface = np.cumsum([0, *(len(body.surfaces) for body in bodies[:-1])]).tolist()
    return Sheets(
        np.concatenate([body.points for body in bodies]),
        np.concatenate([b.triangles + k for b, k in zip(bodies, first_point, strict=True)]),
        np.concatenate([b.surface + k for b, k in zip(bodies, first_surface, strict=True)]),
        np.repeat(np.arange(len(bodies)), [len(body.triangles) for body in bodies]),
        [],
    )


def _markers(
    names: Sequence[tuple[str, ...]], name: np.ndarray, leaves: Sequence[Leaf]
) -> tuple[tuple[tuple[str, ...], ...], np.ndarray]:
    """The table of names in use, in the order of the tree; and each facet's number in it."""
    place = {n: k for k, n in enumerate(n for leaf in leaves for n in leaf.names)}
    used = [names[k] for k in np.flatnonzero(np.bincount(name, minlength=len(names))).tolist()]
    _, table = marker_table(sorted(used, key=lambda entry: [place[n] for n in entry]))
    number_of = {entry: k for k, entry in enumerate(table)}
    return table, np.array([number_of.get(entry, -1) for entry in names], np.int64)[name]


def _refuse_unbounded(sheets: Sheets, stock: _Stock, frame: Frame) -> None:
    nameless = np.array([*(not parts for parts in stock.parts), True])
    far = np.flatnonzero(nameless[sheets.surface])
    if len(far):
        middle = sheets.points[sheets.triangles[far[0]]].mean(axis=0)
        x, y, z = middle * frame.scale + frame.centre
        raise UnboundedDomainError(
            f"the domain reaches to infinity, by way of ({x:.6g}, {y:.6g}, {z:.6g}): half-spaces "
            "alone do not bound it"
        )


def _report(settled: Sheets, stock: _Stock, program: Program, frame: Frame) -> Report:
    listed = settled.moved[: Report.LISTED]
    around: dict[int, list[str]] = {v: [] for v, _ in listed}
    touched = np.flatnonzero(np.isin(settled.triangles, list(around)).any(axis=1))
    for row in touched.tolist():
        for v in settled.triangles[row].tolist():
            if v in around:
                around[v].append(program.leaves[stock.leaf[settled.surface[row]]].label)
    merges = tuple(
        Merge(
            tuple((settled.points[v] * frame.scale + frame.centre).tolist()),
            distance * frame.scale,
            tuple(dict.fromkeys(around[v])),
        )
        for v, distance in listed
    )
    largest = max((d for _, d in settled.moved), default=0.0) * frame.scale
    return Report(merges, len(settled.moved), largest)


def _largest_deviation(leaves: Sequence[Leaf]) -> float:
    sizes = [
        float((leaf.box[1] - leaf.box[0]).max())
        for leaf in leaves
        if not isinstance(leaf.primitive, HalfSpace)
    ]
    return DEVIATION_SHARE * max(sizes, default=0.0)

"""From a tree of solids to its named boundary with exact surfaces; the only door to manifold3d.

1. Every leaf becomes facets that know their exact surfaces (`facets`). Half-spaces become boxes
   that reach beyond everything else.
2. manifold3d combines them; each surface of each leaf is an original of its own there, so every
   facet of the result says which surface it comes from, without asking where it lies.
3. Vertices move onto the exact surfaces around them (`projection`): facets approximate a surface,
   but an edge between two surfaces must lie on both.
4. Surfaces that coincide become one, and its facets get the names of all leaves they lie on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.boundary.coincidence import classes, names_of_facets
from csgmesh.boundary.facets import Facets, facets
from csgmesh.boundary.projection import project_vertices
from csgmesh.boundary.sweeps import swept_domain
from csgmesh.boundary.touching import Surface, settle
from csgmesh.csg import Embed, Regions
from csgmesh.csg.primitives.box import Box
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.program import Code, Leaf, Program, compile_shape
from csgmesh.csg.solid import Solid
from csgmesh.domain.plc import Plc
from csgmesh.domain.pslg import marker_table
from csgmesh.domain.report import Merge, Report
from csgmesh.domain.surfaces import Surfaces
from csgmesh.errors import EmptyDomainError, EvaluationError, ShapeError, UnboundedDomainError
from csgmesh.tolerance import DEVIATION_SHARE, SNAP_SHARE, coordinate_ulp

if TYPE_CHECKING:
    from manifold3d import Manifold

#: Half-spaces alone bound a domain with corners where three planes meet; beyond this many planes
#: there are too many triples to try.
_MOST_PLANES = 60

_SIDES = Box((0, 0, 0), (1, 1, 1)).parts

#: How far a half-space reaches, in units of the frame.
_REACH = 4.0


@dataclass(frozen=True, eq=False)
class _Frame:
    """Local coordinates of order one, so that offsets and scales cost no digits."""

    centre: np.ndarray
    scale: float

    def local(self, body: Facets) -> Facets:
        return body.transformed(np.eye(3) / self.scale, -self.centre / self.scale)


@dataclass(frozen=True, eq=False)
class _Stock:
    """All surfaces of all leaves, in local coordinates, numbered as manifold3d's originals."""

    first_id: int
    surfaces: Surfaces
    leaf: np.ndarray  # -1: the far sides of a half-space
    parts: tuple[tuple[int, ...], ...]


def evaluate_solid(shape: Any, deviation: float | None, snap: float | None) -> Plc:
    """The boundary of a solid; see `csgmesh.evaluate`."""
    if isinstance(shape, Regions | Embed):
        raise ShapeError(
            f"{type(shape).__name__} in space cannot be evaluated yet; one material can"
        )
    program = compile_shape(shape)
    frame = _frame(program.leaves)
    diagonal = 2.0 * frame.scale
    user_snap = max(
        snap or SNAP_SHARE * diagonal, coordinate_ulp(frame.centre, diagonal * np.ones(1))
    )
    bodies = [frame.local(_leaf_facets(leaf, frame, deviation)) for leaf in program.leaves]
    stock, solids = _stock(bodies, program.leaves)
    result = _combined(program.regions[0][1], solids)
    if result.is_empty() or result.num_tri() == 0:
        raise EmptyDomainError("the domain is empty: nothing is left after all operations")
    points, triangles, surface = _arrays(result, stock.first_id)
    _refuse_unbounded(points, triangles, surface, stock, frame)
    settled = settle(points, triangles, surface, user_snap / frame.scale)
    if not len(settled.triangles):
        raise EmptyDomainError("the domain is empty: what is left has no thickness")
    report = _report(settled, stock, program, frame)
    points, triangles, surface = _canonical(settled.points, settled.triangles, settled.surface)
    of_class, member = classes(stock.surfaces, user_snap / frame.scale)
    points = project_vertices(points, triangles, of_class[surface], stock.surfaces)
    names = names_of_facets(
        points, triangles, surface, of_class, member, stock.leaf, stock.parts, program, frame
    )
    # Entries in the order of the tree, whatever order facets come in.
    place = {n: k for k, n in enumerate(n for leaf in program.leaves for n in leaf.names)}
    _, table = marker_table(sorted(names, key=lambda entry: [place[n] for n in entry]))
    number_of = {entry: k for k, entry in enumerate(table)}
    marker = np.array([number_of[entry] for entry in names], np.int64)
    used, number = np.unique(of_class[surface], return_inverse=True)
    exact = stock.surfaces[used].transformed(frame.scale * np.eye(3), frame.centre)
    return Plc.build(
        points=points * frame.scale + frame.centre,
        facets=triangles,
        facet_surface=number,
        facet_marker=marker,
        facet_region=np.tile([0, -1], (len(triangles), 1)),
        boundary_names=table,
        region_names=tuple(name for name, _ in program.regions),
        surfaces=exact,
        deviation=float(deviation or _largest_deviation(program.leaves)),
        snap=user_snap,
        report=report,
        oracle=program,
        sweep=swept_domain(program, deviation),
    )


def _frame(leaves: Sequence[Leaf]) -> _Frame:
    for leaf in leaves:
        if not (np.isfinite(leaf.box).all() or isinstance(leaf.primitive, HalfSpace)):
            raise UnboundedDomainError(f"{leaf.label} reaches to infinity")
    corners = [np.stack(leaf.box) for leaf in leaves if np.isfinite(leaf.box).all()]
    planes = [leaf.half_space() for leaf in leaves if isinstance(leaf.primitive, HalfSpace)]
    corners += [np.array([point]) for point, _ in planes]
    if len(planes) <= _MOST_PLANES:
        corners += _meeting_points(planes)
    cloud = np.concatenate(corners)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    scale = 0.5 * float(np.sqrt(((high - low) ** 2).sum()))
    return _Frame(0.5 * (low + high), scale or 1.0)


def _meeting_points(planes: Sequence[tuple[np.ndarray, np.ndarray]]) -> list[np.ndarray]:
    out = []
    for chosen in combinations(planes, 3):
        normals = np.array([n / np.sqrt((n**2).sum()) for _, n in chosen])
        if abs(np.linalg.det(normals)) > 1e-9:
            heights = [p @ n for (p, _), n in zip(chosen, normals, strict=True)]
            out.append(np.linalg.solve(normals, heights)[None])
    return out


def _leaf_facets(leaf: Leaf, frame: _Frame, deviation: float | None) -> Facets:
    primitive = leaf.primitive
    if isinstance(primitive, HalfSpace):
        return _half_space(leaf, frame)
    assert isinstance(primitive, Solid)
    low, high = leaf.box
    # Facets are made before the leaf is placed, where lengths differ by the placement's stretch.
    stretch = float(np.linalg.norm(leaf.matrix, 2))
    allowed = (deviation or DEVIATION_SHARE * float((high - low).max())) / stretch
    own = facets(primitive.body(), primitive.parts, allowed)
    return own.transformed(leaf.matrix, leaf.offset)


def _half_space(leaf: Leaf, frame: _Frame) -> Facets:
    """A box with one side on the plane, and the others, without a part, beyond everything."""
    point, normal = leaf.half_space()
    plane = Surfaces.planes(point[None], normal[None])
    axes = plane.matrix[0]
    unit = axes[:, 2]
    foot = frame.centre - ((frame.centre - point) @ unit) * unit
    cube = facets(Box((-_REACH,) * 3, (_REACH,) * 3).body(), (), 1.0)
    placed = cube.transformed(axes * frame.scale, foot - _REACH * frame.scale * unit)
    parts = tuple((0,) if side == "top" else () for side in _SIDES)
    return Facets(placed.points, placed.triangles, placed.surface, placed.surfaces, parts)


def _stock(bodies: Sequence[Facets], leaves: Sequence[Leaf]) -> tuple[_Stock, list[Manifold]]:
    from manifold3d import Error, Manifold, Mesh64

    counts = [len(body.surfaces) for body in bodies]
    first_id = Manifold.reserve_ids(sum(counts))
    solids, start = [], first_id
    for body, leaf, count in zip(bodies, leaves, counts, strict=True):
        order = np.argsort(body.surface, kind="stable")
        runs = np.searchsorted(body.surface[order], np.arange(count + 1))
        solid = Manifold(
            Mesh64(
                np.ascontiguousarray(body.points),
                np.ascontiguousarray(body.triangles[order], dtype=np.uint64),
                run_index=(3 * runs).astype(np.uint64),
                run_original_id=np.arange(start, start + count, dtype=np.uint32),
            )
        )
        if solid.status() != Error.NoError:
            raise EvaluationError(f"{leaf.label}: its facets do not close ({solid.status().name})")
        solids.append(solid)
        start += count
    stock = _Stock(
        first_id,
        Surfaces.concatenate([body.surfaces for body in bodies]),
        np.repeat(np.arange(len(bodies)), counts),
        tuple(parts for body in bodies for parts in body.parts),
    )
    return stock, solids


def _combined(code: Code, solids: Sequence[Manifold]) -> Manifold:
    """Fold a region's postfix code; a complement is a solid and a flag."""
    from manifold3d import Manifold, OpType

    stack: list[tuple[Manifold, bool]] = []

    def intersection(operands: Sequence[tuple[Manifold, bool]]) -> tuple[Manifold, bool]:
        kept = [solid for solid, negated in operands if not negated]
        taken = [solid for solid, negated in operands if negated]
        if not kept:
            return Manifold.batch_boolean(taken, OpType.Add), True
        common = Manifold.batch_boolean(kept, OpType.Intersect)
        if taken:
            common = Manifold.batch_boolean([common, *taken], OpType.Subtract)
        return common, False

    def inverted(operands: Sequence[tuple[Manifold, bool]]) -> list[tuple[Manifold, bool]]:
        return [(solid, not negated) for solid, negated in operands]

    def exclusive(a: tuple[Manifold, bool], b: tuple[Manifold, bool]) -> tuple[Manifold, bool]:
        return (a[0] - b[0]) + (b[0] - a[0]), a[1] != b[1]

    for word, count in code:
        if word == "leaf":
            stack.append((solids[count], False))
            continue
        operands = stack[-count:]
        del stack[-count:]
        if word == "complement":
            stack += inverted(operands)
        elif word == "union":
            stack += inverted([intersection(inverted(operands))])
        elif word == "intersection":
            stack.append(intersection(operands))
        elif word == "difference":
            stack.append(intersection([operands[0], *inverted(operands[1:])]))
        else:
            stack.append(reduce(exclusive, operands))
    ((solid, negated),) = stack
    if negated:
        raise UnboundedDomainError(
            "the domain reaches to infinity: it is the complement of a bounded solid"
        )
    return solid


def _arrays(solid: Manifold, first_id: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, triangles, and the surface of each triangle."""
    mesh = solid.to_mesh64()
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
    runs = np.asarray(mesh.run_index, dtype=np.int64) // 3
    surface = np.repeat(np.asarray(mesh.run_original_id, dtype=np.int64) - first_id, np.diff(runs))
    points = np.array(mesh.vert_properties, dtype=np.float64)[:, :3]
    merge = np.arange(len(points))
    merge[np.asarray(mesh.merge_from_vert, np.int64)] = np.asarray(mesh.merge_to_vert, np.int64)
    triangles = merge[triangles]
    return _canonical(points, triangles, surface)


def _canonical(
    points: np.ndarray, triangles: np.ndarray, surface: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points in use and triangles in one order, whatever order threads made them in."""
    used, triangles = np.unique(triangles, return_inverse=True)
    points, triangles = points[used], triangles.reshape(-1, 3)
    order = np.lexsort(points.T[::-1])
    rank = np.empty(len(points), np.int64)
    rank[order] = np.arange(len(points))
    triangles = rank[triangles]
    turn = np.argmin(triangles, axis=1)
    triangles = np.take_along_axis(triangles, (turn[:, None] + np.arange(3)) % 3, axis=1)
    rows = np.lexsort((*triangles.T[::-1], surface))
    return points[order], triangles[rows], surface[rows]


def _refuse_unbounded(
    points: np.ndarray, triangles: np.ndarray, surface: np.ndarray, stock: _Stock, frame: _Frame
) -> None:
    nameless = np.array([not parts for parts in stock.parts])
    far = np.flatnonzero(nameless[surface])
    if len(far):
        x, y, z = points[triangles[far[0]]].mean(axis=0) * frame.scale + frame.centre
        raise UnboundedDomainError(
            f"the domain reaches to infinity, by way of ({x:.6g}, {y:.6g}, {z:.6g}): half-spaces "
            "alone do not bound it"
        )


def _report(settled: Surface, stock: _Stock, program: Program, frame: _Frame) -> Report:
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

"""Booleans of facetted bodies; the door to manifold3d.

Each surface of each leaf is an original of its own there, so every facet of a result says which
surface it comes from, without asking where it lies.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.boundary.facets import Facets
from csgmesh.boundary.neighbours import in_use
from csgmesh.boundary.sheet_table import Sheets
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.program import Code, Leaf
from csgmesh.errors import EvaluationError, UnboundedDomainError

if TYPE_CHECKING:
    from manifold3d import Manifold

#: How far from the centre of local coordinates a bounded domain may reach, less than half-spaces'
#: boxes do in any direction.
_FAR = 1.25

#: A solid, and whether its complement is meant.
_Operand = tuple["Manifold", bool]


def regions_of(codes: Sequence[Code], bodies: Sequence[Facets], leaves: Sequence[Leaf]) -> Sheets:
    """The boundary of each region less those that come after it, as sheets in a fixed order.

    Parameters
    ----------
    codes : sequence of Code
    bodies : sequence of Facets
        Of all leaves, in local coordinates.
    leaves : sequence of Leaf

    Surfaces of the result have numbers as in all `bodies` together, and the next one where a domain
    reaches to infinity.

    Raises
    ------
    UnboundedDomainError
        If a region is the complement of a bounded solid.
    EvaluationError
        If a leaf's facets do not close.
    """
    first_id, solids = _solids(bodies, leaves)
    reach = any(isinstance(leaf.primitive, HalfSpace) for leaf in leaves) and _everywhere(
        first_id + sum(len(body.surfaces) for body in bodies)
    )
    later: list[Manifold] = []
    found = []
    for code in reversed(codes):
        whole = _combined(code, solids, reach or None)
        found.append(_less(whole, later))
        later.append(whole)
    parts = [_arrays(solid, first_id) for solid in reversed(found)]
    sizes = [len(points) for points, _, _ in parts]
    starts = np.cumsum([0, *sizes[:-1]]).tolist()
    return Sheets(
        np.concatenate([points for points, _, _ in parts]),
        np.concatenate([t + start for (_, t, _), start in zip(parts, starts, strict=True)]),
        np.concatenate([surface for _, _, surface in parts]),
        np.repeat(np.arange(len(parts)), [len(t) for _, t, _ in parts]),
        [],
    )


def _solids(bodies: Sequence[Facets], leaves: Sequence[Leaf]) -> tuple[int, list[Manifold]]:
    from manifold3d import Error, Manifold, Mesh64

    counts = [len(body.surfaces) for body in bodies]
    first_id = start = Manifold.reserve_ids(sum(counts) + 1)
    solids = []
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
    return first_id, solids


def _less(solid: Manifold, later: Sequence[Manifold]) -> Manifold:
    from manifold3d import Manifold, OpType

    return Manifold.batch_boolean([solid, *later], OpType.Subtract) if later else solid


def _everywhere(number: int) -> Manifold:
    """A box around all that half-spaces may bound, whose sides are one original."""
    from manifold3d import Manifold, Mesh64

    mesh = Manifold.cube((2.0 * _FAR,) * 3, center=True).to_mesh64()
    return Manifold(
        Mesh64(
            np.array(mesh.vert_properties)[:, :3],
            np.array(mesh.tri_verts),
            run_index=np.array([0, 3 * len(mesh.tri_verts)], np.uint64),
            run_original_id=np.array([number], np.uint32),
        )
    )


def _combined(code: Code, solids: Sequence[Manifold], reach: Manifold | None) -> Manifold:
    """Fold a region's postfix code; a complement is a solid and a flag.

    What half-spaces leave over is bounded if it does not touch the sides of `reach`.
    """
    stack: list[_Operand] = []
    for word, count in code:
        if word == "leaf":
            stack.append((solids[count], False))
            continue
        operands = stack[-count:]
        del stack[-count:]
        if word == "complement":
            stack += _inverted(operands)
        elif word == "union":
            stack += _inverted([_intersection(_inverted(operands))])
        elif word == "intersection":
            stack.append(_intersection(operands))
        elif word == "difference":
            stack.append(_intersection([operands[0], *_inverted(operands[1:])]))
        else:
            stack.append(reduce(_exclusive, operands))
    ((solid, negated),) = stack
    if negated and reach is not None:
        return reach - solid
    if negated:
        raise UnboundedDomainError(
            "the domain reaches to infinity: it is the complement of a bounded solid"
        )
    return solid


def _intersection(operands: Sequence[_Operand]) -> _Operand:
    from manifold3d import Manifold, OpType

    kept = [solid for solid, negated in operands if not negated]
    taken = [solid for solid, negated in operands if negated]
    if not kept:
        return Manifold.batch_boolean(taken, OpType.Add), True
    common = Manifold.batch_boolean(kept, OpType.Intersect)
    return _less(common, taken), False


def _inverted(operands: Sequence[_Operand]) -> list[_Operand]:
    return [(solid, not negated) for solid, negated in operands]


def _exclusive(a: _Operand, b: _Operand) -> _Operand:
    return (a[0] - b[0]) + (b[0] - a[0]), a[1] != b[1]


def _arrays(solid: Manifold, first_id: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, triangles, and the surface of each triangle."""
    mesh = solid.to_mesh64()
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64).reshape(-1, 3)
    runs = np.asarray(mesh.run_index, dtype=np.int64) // 3
    surface = np.repeat(np.asarray(mesh.run_original_id, dtype=np.int64) - first_id, np.diff(runs))
    points = np.array(mesh.vert_properties, dtype=np.float64).reshape(-1, 3)
    merge = np.arange(len(points))
    merge[np.asarray(mesh.merge_from_vert, np.int64)] = np.asarray(mesh.merge_to_vert, np.int64)
    points, triangles, surface = canonical(points, merge[triangles], surface)
    return points, triangles, surface


def canonical(
    points: np.ndarray, triangles: np.ndarray, *belongings: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Points in use and triangles in one order, whatever order threads made them in.

    What belongs to triangles, a row each, comes back in their order.
    """
    points, triangles = in_use(points, triangles)
    order = np.lexsort(points.T[::-1])
    rank = np.empty(len(points), np.int64)
    rank[order] = np.arange(len(points))
    triangles = rank[triangles]
    turn = np.argmin(triangles, axis=1)
    triangles = np.take_along_axis(triangles, (turn[:, None] + np.arange(3)) % 3, axis=1)
    keys = [key for b in belongings for key in (b.T if b.ndim > 1 else b[None])]
    rows = np.lexsort((*triangles.T[::-1], *keys))
    return points[order], triangles[rows], *(b[rows] for b in belongings)

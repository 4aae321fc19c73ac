"""Recognise solids that a planar domain sweeps."""

from __future__ import annotations

import numpy as np

from csgmesh.boundary.planar import evaluate_plane
from csgmesh.csg.primitives.box import Box
from csgmesh.csg.primitives.cone import direction_of
from csgmesh.csg.primitives.cylinder import Cylinder
from csgmesh.csg.primitives.disk import Disk
from csgmesh.csg.primitives.extrude import Extrude
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.primitives.hull import Hull
from csgmesh.csg.primitives.revolve import Revolve
from csgmesh.csg.program import Leaf, Program
from csgmesh.csg.shape import Shape
from csgmesh.csg.solid import Prism
from csgmesh.domain.sweep import SweptDomain

#: What the profile of a revolution calls its axis.
_AXIS = "axis"


def swept_domain(program: Program, deviation: float | None) -> SweptDomain | None:
    """The sweep that a program is.

    That is a single extrusion, revolution, box or cylinder, or a hull of prisms; else None.
    """
    code = program.regions[0][1]
    if len(program.regions) > 1 or len(code) > 1:
        return None
    leaf = program.leaves[code[0][1]]
    primitive = leaf.primitive
    matrix, offset = leaf.matrix, leaf.offset
    if isinstance(primitive, Extrude):
        return _swept(leaf, primitive.shape, primitive.height, matrix, offset, deviation)
    if isinstance(primitive, Revolve):
        axis = HalfSpace((0, 0), (-1, 0), name=_AXIS)
        shape = primitive.shape & axis
        return _swept(leaf, shape, primitive.angle, matrix, offset, deviation, is_turned=True)
    if isinstance(primitive, Box):
        low, high = np.array(primitive.lo), np.array(primitive.hi)
        flat = Box((0, 0), (high - low)[:2])
        names = {"box.left": 0, "box.right": 1, "box.bottom": 4, "box.top": 5}
        side = {planar: leaf.names[k] for planar, k in names.items()}
        height = float(high[2] - low[2])
        return SweptDomain(
            evaluate_plane(flat, deviation, None), False, height,
            matrix, matrix @ low + offset, side, leaf.names[2], leaf.names[3],
        )  # fmt: skip
    if isinstance(primitive, Hull):
        hull = primitive.body()
        if not isinstance(hull, Prism):
            return None
        profile = evaluate_plane(hull.profile, deviation, None)
        (name,) = leaf.names
        return SweptDomain(
            profile, False, hull.height,
            matrix @ hull.matrix, matrix @ hull.offset + offset,
            dict.fromkeys(profile.names, name), name, name,
        )  # fmt: skip
    if isinstance(primitive, Cylinder):
        body = primitive.body()
        _, height = direction_of(primitive.base, primitive.top)
        return SweptDomain(
            evaluate_plane(Disk((0, 0), primitive.radius), deviation, None), False, height,
            matrix @ body.matrix, matrix @ body.offset + offset,
            {"disk": leaf.names[0]}, leaf.names[1], leaf.names[2],
        )  # fmt: skip
    return None


def _swept(
    leaf: Leaf,
    shape: Shape,
    amount: float,
    matrix: np.ndarray,
    offset: np.ndarray,
    deviation: float | None,
    *,
    is_turned: bool = False,
) -> SweptDomain:
    profile = evaluate_plane(shape, deviation, None)
    parts = dict(zip(leaf.primitive.parts, leaf.names, strict=True))
    side = {n: parts[f"side.{n}"] for n in profile.names if f"side.{n}" in parts}
    start, end = parts.get("start"), parts.get("end")
    return SweptDomain(profile, is_turned, amount, matrix, offset, side, start, end)

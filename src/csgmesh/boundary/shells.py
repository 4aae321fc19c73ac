"""What is around each leaf: boxes, cylinders and balls, and the planes of its flat faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.facets import Facets
from csgmesh.csg.primitives.ball import Ball
from csgmesh.csg.primitives.box import Box
from csgmesh.csg.primitives.cone import Cone
from csgmesh.csg.primitives.cylinder import Cylinder
from csgmesh.csg.primitives.ellipsoid import Ellipsoid
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.primitives.tetrahedron import Tetrahedron
from csgmesh.csg.program import Leaf
from csgmesh.domain.surfaces import PLANE, Surfaces

_CONVEX = (Ball, Box, Cone, Cylinder, Ellipsoid, HalfSpace, Tetrahedron)

#: Distance, in snap distances, that leaves no doubt: points move by one at most.
CLEAR = 4.0


@dataclass(frozen=True, eq=False)
class Shells:
    """What is around each leaf.

    Attributes
    ----------
    leaf : (s,) int64
        Of each surface.
    is_flat : (s,) bool
    normal, height : (s, 3), (s,) float64
        Planes of flat surfaces.
    is_convex : (l,) bool
    lo, hi : (l, 3) float64
        Boxes of leaves.
    inverse, offset : (l, 3, 3), (l, 3) float64
        Into the coordinates of a leaf's own axes, ``q = inverse @ (x - offset)``, whose centre is
        that of its box there.
    half : (l, 3) float64
        Half the sides of the box there.
    turned, ball : (l,) float64
        Radii of the cylinder about its third axis and of the ball around it there.
    stretch : (l,) float64
        By how much lengths grow at most on the way there.
    """

    leaf: np.ndarray
    is_flat: np.ndarray
    normal: np.ndarray
    height: np.ndarray
    is_convex: np.ndarray
    lo: np.ndarray
    hi: np.ndarray
    inverse: np.ndarray
    offset: np.ndarray
    half: np.ndarray
    turned: np.ndarray
    ball: np.ndarray
    stretch: np.ndarray


def shells(bodies: Sequence[Facets], leaves: Sequence[Leaf], surfaces: Surfaces) -> Shells:
    """What is around each leaf; `surfaces` are those of all bodies, one after the other."""
    count = [len(body.surfaces) for body in bodies]
    first = np.cumsum([0, *count[:-1]])
    bent = surfaces.kind != PLANE
    lead = np.array(
        [k + int(np.argmax(bent[k : k + n])) for k, n in zip(first.tolist(), count, strict=True)]
    )
    inverse, offset = surfaces.inverse[lead], surfaces.offset[lead].copy()
    rows = []
    for k, body in enumerate(bodies):
        q = (body.points - offset[k]) @ inverse[k].T
        low, high = q.min(axis=0), q.max(axis=0)
        middle = 0.5 * (low + high)
        square = (q - middle) ** 2
        flat = square[:, 0] + square[:, 1]
        rows.append(
            np.concatenate([
                body.points.min(axis=0), body.points.max(axis=0), middle, 0.5 * (high - low),
                [np.sqrt(flat.max()), np.sqrt((flat + square[:, 2]).max())],
            ])
        )  # fmt: skip
    table = np.array(rows)
    offset += np.einsum("lij,lj->li", surfaces.matrix[lead], table[:, 6:9])
    normal = surfaces.plane_normals
    return Shells(
        np.repeat(np.arange(len(bodies)), count),
        ~bent,
        normal,
        (normal * surfaces.offset).sum(axis=1),
        np.array([isinstance(leaf.primitive, _CONVEX) for leaf in leaves]),
        table[:, :3],
        table[:, 3:6],
        inverse,
        offset,
        table[:, 9:12],
        table[:, 12],
        table[:, 13],
        np.sqrt((inverse**2).sum(axis=(1, 2))),
    )


def outside(
    points: np.ndarray, triangles: np.ndarray, leaf: np.ndarray, known: Shells, snap: float
) -> np.ndarray:
    """Which triangles (k, 3) are beside the box, the cylinder or the ball around a leaf each."""
    inverse, offset = known.inverse[leaf], known.offset[leaf]
    q = np.stack(
        [np.einsum("kij,kj->ki", inverse, points[triangles[:, k]] - offset) for k in range(3)]
    )
    margin = CLEAR * snap * known.stretch[leaf]
    half = known.half[leaf] + margin[:, None]
    out = ((q > half).all(axis=0) | (q < -half).all(axis=0)).any(axis=1)
    rest = np.flatnonzero(~out)
    q, margin, leaf = q[:, rest], margin[rest], leaf[rest]
    out[rest] = _distance(q[:, :, :2]) > known.turned[leaf] + margin
    rest, q, margin, leaf = (
        rest[~out[rest]], q[:, ~out[rest]], margin[~out[rest]], leaf[~out[rest]],
    )  # fmt: skip
    out[rest] = _distance(q) > known.ball[leaf] + margin
    return out


def _distance(q: np.ndarray) -> np.ndarray:
    """Distance of the origin from triangles (3, k, d) in the plane or in space, (k,)."""
    square = np.full(q.shape[1], np.inf)
    for k in range(3):
        a, d = q[k], q[(k + 1) % 3] - q[k]
        along = -(a * d).sum(axis=1) / np.maximum((d * d).sum(axis=1), 1e-300)
        foot = a + np.clip(along, 0.0, 1.0)[:, None] * d
        square = np.minimum(square, (foot * foot).sum(axis=1))
    if q.shape[2] == 2:
        turns = np.stack([_turn(q[k], q[(k + 1) % 3]) for k in range(3)])
        square[(turns >= 0.0).all(axis=0) | (turns <= 0.0).all(axis=0)] = 0.0
        return np.sqrt(square)
    normal = np.cross(q[1] - q[0], q[2] - q[0])
    size = (normal * normal).sum(axis=1)
    inside = size > 0.0
    for k in range(3):
        inside &= (np.cross(q[k], q[(k + 1) % 3]) * normal).sum(axis=1) >= 0.0
    height = (q[0] * normal).sum(axis=1) ** 2 / np.maximum(size, 1e-300)
    return np.sqrt(np.where(inside, np.minimum(square, height), square))


def _turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]

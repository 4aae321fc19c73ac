"""Convex hulls of shapes: exact where lines, arcs, prisms and coaxial bodies allow it.

A hull is the one leaf whose boundary depends on other shapes' boundaries, so that it has to
evaluate them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from csgmesh.boundary.planar import evaluate_plane
from csgmesh.boundary.plane_hulls import hull_of_curves
from csgmesh.csg.flat_faces import flat_faces
from csgmesh.csg.primitives.ball import Ball
from csgmesh.csg.primitives.box import Box
from csgmesh.csg.primitives.cylinder import Cylinder
from csgmesh.csg.primitives.disk import Disk
from csgmesh.csg.primitives.ellipsoid import Ellipsoid
from csgmesh.csg.primitives.extrude import Extrude
from csgmesh.csg.primitives.hull import Hull
from csgmesh.csg.program import Leaf, compile_shape
from csgmesh.csg.shape import Shape
from csgmesh.csg.solid import Faceted, Prism, Profile, Revolution, Solid, frame_along
from csgmesh.csg.winding import WindingGrid
from csgmesh.domain.curves import LINE, Curves
from csgmesh.errors import EmptyDomainError, ShapeError, UnboundedDomainError

#: Maps that differ from one another by less than this are the same: rounding of placements.
_SAME = 1e-12
#: Points times planes looked at together.
_PAIRS = 4_000_000


@dataclass(frozen=True, eq=False)
class SolidHull:
    """A hull in space: its body, and what answers which points lie inside.

    Attributes
    ----------
    body : Faceted, Prism or Revolution
    outline : Curves
        Of a prism or a revolution: the convex closed curve that is swept, in (x, y) or (r, z).
    """

    body: Faceted | Prism | Revolution
    outline: Curves

    @cached_property
    def _grid(self) -> WindingGrid:
        return WindingGrid.of(self.outline)

    @cached_property
    def _planes(self) -> tuple[np.ndarray, np.ndarray]:
        """Outward unit normals of the faces, and their heights along them."""
        body = self.body
        assert isinstance(body, Faceted)
        a, b, c = (body.points[body.triangles[:, k]] for k in range(3))
        total = np.zeros((len(body.part), 3))
        np.add.at(total, body.face, np.cross(b - a, c - a))
        normals = total / np.sqrt((total**2).sum(axis=1))[:, None]
        heights = np.full(len(body.part), -np.inf)
        np.maximum.at(heights, body.face, (a * normals[body.face]).sum(axis=1))
        return normals, heights

    def inside(self, points: np.ndarray) -> np.ndarray:
        """Which of the (n, 3) points lie in the hull."""
        body = self.body
        if isinstance(body, Faceted):
            return _behind(points, *self._planes)
        q = np.linalg.solve(body.matrix, (points - body.offset).T).T
        if isinstance(body, Prism):
            within = (q[:, 2] >= 0.0) & (q[:, 2] <= body.height)
            flat = q[:, :2]
        else:
            within = np.ones(len(q), bool)
            flat = np.column_stack([np.hypot(q[:, 0], q[:, 1]), q[:, 2]])
        within[within] = self._grid.winding(flat[within]) != 0
        return within

    def support(self, directions: np.ndarray) -> np.ndarray:
        """Largest value of direction · x, (k,)."""
        body = self.body
        if isinstance(body, Faceted):
            return (directions @ body.points.T).max(axis=1)
        local = directions @ body.matrix
        if isinstance(body, Prism):
            out = self._flat_support(local[:, :2]) + np.maximum(local[:, 2], 0.0) * body.height
        else:
            around = np.hypot(local[:, 0], local[:, 1])
            out = self._flat_support(np.column_stack([around, local[:, 2]]))
        return out + directions @ body.offset

    def _flat_support(self, directions: np.ndarray) -> np.ndarray:
        """Support of the outline: how far its image under each direction reaches."""
        nothing = np.zeros(2)
        images = (
            self.outline.transformed(np.array([[x, y], [-y, x]]), nothing) for x, y in directions
        )
        return np.fromiter((image.bounds()[1][:, 0].max() for image in images), float)


def plane_hull(shapes: Sequence[Shape], deviation: float | None, where: str) -> Curves:
    """The hull's boundary, counterclockwise.

    Raises
    ------
    ShapeError
        If a shape is unbounded, or all are empty.
    """
    tables = []
    for domain in _evaluated(shapes, deviation, where):
        own = domain.segment_curve
        straight = domain.segments[own < 0]
        tables.append(Curves.lines(*np.swapaxes(domain.points[straight], 0, 1)))
        bent = own[own >= 0]
        pieces = domain.curves
        tables.append(
            Curves(pieces.kind[bent], pieces.data[bent], domain.segment_interval[own >= 0])
        )
    return hull_of_curves(Curves.concatenate(tables))


def solid_hull(shapes: Sequence[Shape], deviation: float | None, where: str) -> SolidHull:
    """The hull's body.

    Raises
    ------
    ShapeError
        If a shape is unbounded, or all are empty.
    """
    leaves = _united_leaves(shapes)
    if leaves is not None:
        exact = _prism(leaves, deviation) or _revolution(leaves)
        if exact is not None:
            return exact
    from manifold3d import Manifold

    points = np.concatenate([domain.points for domain in _evaluated(shapes, deviation, where)])
    centre, scale = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    mesh = Manifold.hull_points(np.unique((points - centre) / scale, axis=0)).to_mesh64()
    corners = np.array(mesh.vert_properties, float)[:, :3]
    triangles = np.asarray(mesh.tri_verts, np.int64)
    face = flat_faces(corners, triangles, _SAME)
    part = np.zeros(int(face.max()) + 1, np.int64)
    body = Faceted(corners * scale + centre, triangles, face, part)
    return SolidHull(body, Curves.empty())


def _evaluated(shapes: Sequence[Shape], deviation: float | None, where: str) -> list:
    from csgmesh.boundary.solid import evaluate_solid

    found = []
    for number, shape in enumerate(shapes):
        evaluated = evaluate_plane if shape.dim == 2 else evaluate_solid
        try:
            found.append(evaluated(shape, deviation, None))
        except EmptyDomainError:
            continue
        except UnboundedDomainError as problem:
            raise ShapeError(f"{where}: shape {number} must be bounded: {problem}") from None
    if not found:
        raise ShapeError(f"{where}: at least one shape must not be empty; all of them are")
    return found


def _behind(points: np.ndarray, normals: np.ndarray, heights: np.ndarray) -> np.ndarray:
    out = np.empty(len(points), bool)
    step = max(_PAIRS // len(normals), 1)
    for start in range(0, len(points), step):
        part = points[start : start + step]
        out[start : start + step] = (part @ normals.T <= heights).all(axis=1)
    return out


def _united_leaves(shapes: Sequence[Shape]) -> list[Leaf] | None:
    """The leaves of unions of leaves; None if there are other operations."""
    out: list[Leaf] = []
    for shape in shapes:
        program = compile_shape(shape)
        code = program.regions[0][1]
        if any(word not in ("leaf", "union") for word, _ in code):
            return None
        out += program.leaves
    return out if all(isinstance(leaf.primitive, Solid) for leaf in out) else None


# -- prisms ---------------------------------------------------------------------------------------


def _prism(leaves: Sequence[Leaf], deviation: float | None) -> SolidHull | None:
    """The hull of prisms between the same two planes: the hull of their profiles, extruded."""
    columns = [list(_columns(leaf)) for leaf in leaves]
    for _, matrix, offset in columns[0]:
        inverse = np.linalg.inv(matrix)
        profiles = [_profile_within(own, inverse, offset) for own in columns]
        known = [profile for profile in profiles if profile is not None]
        if len(known) == len(leaves):
            height = float(np.sqrt((matrix[:, 2] ** 2).sum()))
            hull = Hull(known, deviation)
            placed = matrix @ np.diag([1.0, 1.0, 1.0 / height])
            return SolidHull(Prism(hull, height, placed, offset, True), hull.curves()[0])
    return None


def _columns(leaf: Leaf) -> Iterator[tuple[Shape, np.ndarray, np.ndarray]]:
    """Ways to see a leaf as a profile in (x, y) extruded from z = 0 to 1, then placed."""
    primitive = leaf.primitive
    if isinstance(primitive, Extrude):
        tall = np.diag([1.0, 1.0, primitive.height])
        yield primitive.shape, leaf.matrix @ tall, leaf.offset
    elif isinstance(primitive, Cylinder):
        body = primitive.body()
        along = np.subtract(primitive.top, primitive.base)
        tall = np.diag([1.0, 1.0, float(np.sqrt((along**2).sum()))])
        place = leaf.matrix @ body.offset + leaf.offset
        yield Disk((0, 0), primitive.radius), leaf.matrix @ body.matrix @ tall, place
    elif isinstance(primitive, Box):
        size = np.subtract(primitive.hi, primitive.lo)
        place = leaf.matrix @ np.array(primitive.lo) + leaf.offset
        for turn in (0, 1, 2):
            order = np.roll(np.arange(3), turn)
            sides = size[order]
            axes = leaf.matrix @ np.eye(3)[:, order]
            yield Box((0, 0), sides[:2]), axes @ np.diag([1.0, 1.0, sides[2]]), place


def _profile_within(
    columns: list[tuple[Shape, np.ndarray, np.ndarray]], inverse: np.ndarray, offset: np.ndarray
) -> Shape | None:
    """A leaf's profile in the coordinates of another prism, if both stand between two planes."""
    for shape, matrix, place in columns:
        inner = inverse @ matrix
        shift = inverse @ (place - offset)
        scale = max(float(np.abs(inner).max()), float(np.abs(shift).max()), 1.0)
        tilt = np.abs([*inner[2, :2], *inner[:2, 2]]).max()
        level = (shift[2], shift[2] + inner[2, 2])
        if tilt <= _SAME * scale and np.abs(np.sort(level) - [0.0, 1.0]).max() <= _SAME * scale:
            return shape.transform(inner[:2, :2], shift[:2])
    return None


# -- revolutions ----------------------------------------------------------------------------------


def _revolution(leaves: Sequence[Leaf]) -> SolidHull | None:
    """The hull of bodies turned about one axis: the hull of their profiles, turned."""
    bodies = [leaf.primitive.body() for leaf in leaves]  # type: ignore[attr-defined]
    turned = [b for b in bodies if isinstance(b, Revolution) and isinstance(b.profile, Profile)]
    if len(turned) < len(bodies) or any(body.angle < 360.0 for body in turned):
        return None
    places = [
        (leaf.matrix @ body.matrix, leaf.matrix @ body.offset + leaf.offset)
        for leaf, body in zip(leaves, turned, strict=True)
    ]
    balls = [
        isinstance(leaf.primitive, Ball | Ellipsoid) and _factor(matrix) is not None
        for leaf, (matrix, _) in zip(leaves, places, strict=True)
    ]
    frame, start = _common_axis(places, balls)
    tables = []
    for body, (matrix, offset), is_ball in zip(turned, places, balls, strict=True):
        inner, shift = frame.T @ matrix, frame.T @ (offset - start)
        if is_ball:  # any direction is its axis
            inner = float(np.cbrt(np.linalg.det(inner @ inner.T)) ** 0.5) * np.eye(3)
        flat = _flat_map(inner, shift)
        if flat is None:
            return None
        assert isinstance(body.profile, Profile)
        own = body.profile.curves[body.profile.part >= 0].transformed(flat, shift[[0, 2]] * [0, 1])
        tables += [own, own.transformed(np.diag([-1.0, 1.0]), np.zeros(2))]
    whole = hull_of_curves(Curves.concatenate(tables))
    return SolidHull(Revolution(_right_half(whole), 360.0, frame, start), whole)


def _factor(matrix: np.ndarray) -> float | None:
    """By how much a matrix scales all lengths alike, None if it does not."""
    square = matrix.T @ matrix
    factor = float(np.trace(square)) / len(matrix)
    alike = np.abs(square - factor * np.eye(len(matrix))).max() <= _SAME * factor
    return float(np.sqrt(factor)) if alike else None


def _common_axis(
    places: Sequence[tuple[np.ndarray, np.ndarray]], balls: Sequence[bool]
) -> tuple[np.ndarray, np.ndarray]:
    """A frame along the axis of a body that is no ball, else along the line through two centres."""
    start = places[0][1]
    for (matrix, offset), is_ball in zip(places, balls, strict=True):
        if not is_ball:
            return frame_along(matrix[:, 2]), offset
    apart = next((o - start for _, o in places if (o != start).any()), np.array([0.0, 0.0, 1.0]))
    return frame_along(apart), start


def _flat_map(inner: np.ndarray, shift: np.ndarray) -> np.ndarray | None:
    """What a placement within the common frame does to (r, z); None if the axis is another."""
    size = max(float(np.abs(inner).max()), float(np.abs(shift).max()))
    off = max(np.abs(inner[:2, 2]).max(), np.abs(inner[2, :2]).max(), np.abs(shift[:2]).max())
    around = _factor(inner[:2, :2])
    if off > _SAME * size or around is None:
        return None
    return np.diag([around, inner[2, 2]])


def _right_half(whole: Curves) -> Profile:
    """The part at r ≥ 0 of a counterclockwise hull that is its own mirror image, and the axis."""
    rows, intervals = [], []
    for k in range(len(whole)):
        t0, t1 = whole.interval[k].tolist()
        cuts = sorted(t for t in _at_axis(whole, k) if min(t0, t1) < t < max(t0, t1))
        if t1 < t0:
            cuts.reverse()
        for start, end in pairwise([t0, *cuts, t1]):
            if whole.points(np.array([k]), np.array([0.5 * (start + end)]))[0, 0] > 0.0:
                rows.append(k)
                intervals.append((start, end))
    right = Curves(whole.kind[rows], whole.data[rows], np.array(intervals))
    # From the lowest point of the axis upwards.
    first = int(np.argmin(right.starts()[:, 0]))
    order = np.roll(np.arange(len(right)), -first)
    right = right[order]
    low, high = right.starts()[0, 1], right.ends()[-1, 1]
    axis = Curves.lines(np.array([[0.0, high]]), np.array([[0.0, low]]))
    part = np.r_[np.zeros(len(right), np.int64), -1]
    return Profile(Curves.concatenate([right, axis]), part)


def _at_axis(curves: Curves, row: int) -> list[float]:
    """Parameters at which a line or arc has r = 0."""
    data = curves.data[row]
    if curves.kind[row] == LINE:
        rise = data[2] - data[0]
        return [float(-data[0] / rise)] if rise else []
    reach = float(np.hypot(data[2], data[4]))
    if abs(data[0]) >= reach:
        return []
    middle, half = np.arctan2(data[4], data[2]), np.arccos(-data[0] / reach)
    turns = 2.0 * np.pi * np.arange(-2, 3)
    return [float(t) for sign in (-1, 1) for t in middle + sign * half + turns]

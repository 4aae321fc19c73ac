"""The boundary of a leaf in space as facets that know their exact surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.neighbours import in_use
from csgmesh.boundary.planar import evaluate_plane
from csgmesh.boundary.rings import rings
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.shape import Shape
from csgmesh.csg.solid import Faceted, Prism, Profile, Revolution
from csgmesh.domain.curves import ARC, LINE, Curves
from csgmesh.domain.surfaces import EXTRUDED, REVOLVED, Surfaces

#: Facets around an axis, at least: enough that a torus is one.
_FEWEST_AROUND = 12

#: A profile's points this near the axis, as a share of its radius, lie on it.
_ON_AXIS = 1e-14

#: Angles that differ by less are one, in radians.
_ALIKE = 1e-9


@dataclass(frozen=True, eq=False)
class Facets:
    """A closed triangulated body.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int64
        Counterclockwise seen from outside.
    surface : (m,) int64
        Into `surfaces`.
    surfaces : Surfaces
    parts : tuple of tuple of int
        Parts of the leaf that each surface belongs to.
    around : int
        Into how many pieces a full turn is cut; 0 for bodies that are not turned.
    """

    points: np.ndarray
    triangles: np.ndarray
    surface: np.ndarray
    surfaces: Surfaces
    parts: tuple[tuple[int, ...], ...]
    around: int = 0

    def transformed(self, matrix: np.ndarray, offset: np.ndarray) -> Facets:
        """The image under ``x -> matrix @ x + offset``."""
        mirrored = np.linalg.det(matrix) < 0.0
        return Facets(
            self.points @ matrix.T + offset,
            self.triangles[:, ::-1].copy() if mirrored else self.triangles,
            self.surface,
            self.surfaces.transformed(matrix, offset),
            self.parts,
            self.around,
        )


@dataclass(frozen=True, eq=False)
class _Outline:
    """A flattened profile: loops of points, interior on the left, and what each chord belongs to.

    `source` numbers the rows of `curves`, -1 on an axis of revolution, and stands for the chord
    from each point to the next of its loop.
    """

    loops: list[np.ndarray]
    source: list[np.ndarray]
    curves: Curves
    parts: tuple[tuple[int, ...], ...]


def facets(
    body: Revolution | Prism | Faceted,
    part_names: tuple[str, ...],
    deviation: float,
    around: int = 0,
) -> Facets:
    """Facets of a body, no further than `deviation` from its exact surfaces.

    `part_names` are the leaf's own, by which the names of a swept shape find their parts. A turn is
    cut into `around` pieces at least.
    """
    if isinstance(body, Faceted):
        return _flat(body)
    if isinstance(body, Prism):
        return _prism(body, _of_shape(body.profile, part_names, deviation, is_turned=False))
    # Facets of a surface that bends both ways deviate by what each of the two does.
    half = 0.5 * deviation
    if isinstance(body.profile, Profile):
        bends = (body.profile.curves.kind != LINE).any()
        deviation = half if bends else deviation
        outline = _of_profile(body.profile, deviation)
    else:
        deviation = half
        outline = _of_shape(body.profile, part_names, deviation, is_turned=True)
    return _turned(body, outline, deviation, around)


def _flat(body: Faceted) -> Facets:
    corner = body.points[body.triangles]
    normals = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    n_faces = len(body.part)
    total = np.zeros((n_faces, 3))
    np.add.at(total, body.face, normals)
    _, first = np.unique(body.face, return_index=True)
    planes = Surfaces.planes(corner[first, 0], total)
    parts = tuple((int(p),) for p in body.part)
    return Facets(body.points, body.triangles, body.face, planes, parts)


def _of_profile(profile: Profile, deviation: float) -> _Outline:
    """Flatten a closed chain of curves; rows of one curve become one surface."""
    curves, part = profile.curves, profile.part
    row, table, parts = _whole_curves(curves, part)
    t0, t1 = curves.interval.T
    bend = curves.second_derivative_bounds()
    pieces = np.maximum(np.ceil(np.abs(t1 - t0) * np.sqrt(bend / (8.0 * deviation))), 1)
    points, source = [], []
    for k, n in enumerate(pieces.astype(np.int64).tolist()):
        t = t0[k] + (t1[k] - t0[k]) * np.arange(n) / n
        points.append(curves.points(np.full(n, k), t))
        source.append(np.full(n, row[k]))
    loop = np.concatenate(points)
    # A cosine of a right angle is no exact zero, and a pole must lie on the axis.
    loop[np.abs(loop[:, 0]) <= _ON_AXIS * loop[:, 0].max(), 0] = 0.0
    return _Outline([loop], [np.concatenate(source)], table, parts)


def _whole_curves(
    curves: Curves, part: np.ndarray
) -> tuple[np.ndarray, Curves, tuple[tuple[int, ...], ...]]:
    """Number the pieces of one curve and part alike; -1 for pieces without a part."""
    forwards = np.sign(curves.interval[:, 1] - curves.interval[:, 0])
    key = np.column_stack([curves.kind, part, forwards, curves.data])
    _, first, row = np.unique(key, axis=0, return_index=True, return_inverse=True)
    row = row.reshape(-1)
    kept = np.flatnonzero(part[first] >= 0)
    number = np.full(len(first), -1)
    number[kept] = np.arange(len(kept))
    interval = curves.interval[first[kept]].copy()
    for k, old in enumerate(kept.tolist()):
        own = curves.interval[row == old]
        low, high = _covering(own, is_arc=curves.kind[first[old]] == ARC)
        interval[k] = (low, high) if own[0, 1] >= own[0, 0] else (high, low)
    table = Curves(curves.kind[first[kept]], curves.data[first[kept]], interval)
    return number[row], table, tuple((int(part[first[k]]),) for k in kept.tolist())


def _covering(intervals: np.ndarray, *, is_arc: bool) -> tuple[float, float]:
    """The shortest interval of parameters that has all of those given (k, 2) in it.

    Angles are alike a full turn apart: pieces at both ends of an arc's right half must not be
    joined over the left one, where a surface of revolution has nothing to project to.
    """
    low, high = intervals.min(axis=1), intervals.max(axis=1)
    whole = float(low.min()), float(high.max())
    if not is_arc:
        return whole
    turn = 2.0 * np.pi
    start = low % turn
    order = np.argsort(start, kind="stable")
    start, end = start[order], start[order] + (high - low)[order]
    reached = np.maximum.accumulate(end)
    after = np.append(start[1:], start[0] + turn)
    widest = int(np.argmax(after - reached))
    if widest == len(start) - 1:
        found = float(start[0]), float(reached[-1])
    else:
        found = float(start[widest + 1]), max(float(reached[widest]) + turn, float(reached[-1]))
    # Where nothing is gained, parameters stay the ones that the profile has.
    return found if found[1] - found[0] < whole[1] - whole[0] - _ALIKE else whole


def _of_shape(
    shape: Shape, part_names: tuple[str, ...], deviation: float, *, is_turned: bool
) -> _Outline:
    """Evaluate a planar shape, cut at the axis if it is to be turned."""
    if is_turned:
        shape = shape & HalfSpace((0, 0), (-1, 0), name="axis")
    domain = evaluate_plane(shape, deviation, None)
    number = {name: k for k, name in enumerate(part_names)}
    parts = [
        tuple(number[f"side.{n}"] for n in names if f"side.{n}" in number)
        for names in domain.boundary_names
    ]
    points = domain.points.copy()
    on_axis = np.zeros(len(domain.segments), bool)
    if is_turned:
        points[np.abs(points[:, 0]) <= domain.snap, 0] = 0.0
        on_axis = (points[domain.segments][:, :, 0] == 0.0).all(axis=1)
    straight = Curves.lines(*np.swapaxes(points[domain.segments], 0, 1))
    own = domain.segment_curve
    pieces = Curves.concatenate([straight, domain.curves])
    curve = np.where(own < 0, np.arange(len(own)), len(own) + own)
    travelled = np.where(
        (own >= 0)[:, None], domain.segment_interval, np.tile([0.0, 1.0], (len(own), 1))
    )
    table = Curves(pieces.kind[curve], pieces.data[curve], travelled)
    marker = np.where(on_axis, -1, domain.segment_marker)
    row, whole, marked = _whole_curves(table, marker)
    loops = rings(points, domain.segments)
    return _Outline(
        [points[domain.segments[loop, 0]] for loop in loops],
        [row[loop] for loop in loops],
        whole,
        tuple(parts[m] for (m,) in marked),
    )


def _prism(body: Prism, outline: _Outline) -> Facets:
    flat = np.concatenate(outline.loops)
    n = len(flat)
    points = np.concatenate([np.column_stack([flat, np.full(n, z)]) for z in (0.0, body.height)])
    head = _successors(outline)
    tail = np.arange(n)
    source = np.concatenate(outline.source) + 2
    sides = np.concatenate(
        [
            np.column_stack([tail, head, head + n]),
            np.column_stack([tail, head + n, tail + n]),
        ]
    )
    cap = _triangulated(outline.loops)
    planes = Surfaces.planes(
        np.array([(0.0, 0.0, 0.0), (0.0, 0.0, body.height)]),
        np.array([(0.0, 0.0, -1.0), (0.0, 0.0, 1.0)]),
    )
    walls = _walls(EXTRUDED, outline.curves)
    parts = ((0,), (1,), *outline.parts)
    if body.is_one_part:
        parts = ((0,),) * len(parts)
    return Facets(
        points,
        np.concatenate([cap[:, ::-1], cap + n, sides]),
        np.concatenate([np.zeros(len(cap), int), np.ones(len(cap), int), np.tile(source, 2)]),
        Surfaces.concatenate([planes, walls]),
        parts,
    ).transformed(body.matrix, body.offset)


def _turned(body: Revolution, outline: _Outline, deviation: float, fewest: int) -> Facets:
    flat = np.concatenate(outline.loops)
    n = len(flat)
    is_full = body.angle >= 360.0
    radius = float(flat[:, 0].max())
    step = 2.0 * np.arccos(max(1.0 - deviation / radius, 0.0))
    whole = max(int(np.ceil(2.0 * np.pi / step)), _FEWEST_AROUND, fewest)
    around = whole = -(-whole // 4) * 4
    if not is_full:
        around = max(int(np.ceil(around * body.angle / 360.0)), 1)
    columns = around if is_full else around + 1
    turn = np.radians(body.angle) * np.arange(columns) / around
    cosine, sine = np.cos(turn), np.sin(turn)
    if is_full:
        quarter = around // 4
        cosine[[0, quarter, 2 * quarter, 3 * quarter]] = (1, 0, -1, 0)
        sine[[0, quarter, 2 * quarter, 3 * quarter]] = (0, 1, 0, -1)
    grid = np.stack(
        [
            np.multiply.outer(cosine, flat[:, 0]),
            np.multiply.outer(sine, flat[:, 0]),
            np.tile(flat[:, 1], (columns, 1)),
        ],
        axis=2,
    )
    # A vertex on the axis is one, whatever the angle.
    number = np.arange(columns * n).reshape(columns, n)
    number[:, flat[:, 0] == 0.0] = number[:1, flat[:, 0] == 0.0]
    tail = np.arange(n)
    head = _successors(outline)
    source = np.concatenate(outline.source)
    swept = source >= 0
    tail, head, source = tail[swept], head[swept], source[swept]
    this = number[:around]
    after = number[np.arange(1, around + 1) % columns]
    a, b = this[:, tail].ravel(), after[:, tail].ravel()
    c, d = after[:, head].ravel(), this[:, head].ravel()
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    surface = np.tile(np.tile(source, around), 2)
    walls = _walls(REVOLVED, outline.curves)
    parts: tuple[tuple[int, ...], ...] = outline.parts
    if not is_full:
        cap = _triangulated(outline.loops)
        end = np.radians(body.angle)
        normals = np.array([(0.0, -1.0, 0.0), (-np.sin(end), np.cos(end), 0.0)])
        walls = Surfaces.concatenate([walls, Surfaces.planes(np.zeros((2, 3)), normals)])
        triangles = np.concatenate([triangles, number[0][cap], number[-1][cap[:, ::-1]]])
        own = len(outline.curves) + np.array([0, 1])
        surface = np.concatenate([surface, np.repeat(own, len(cap))])
        parts = (*parts, (0,), (1,))
    real = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return _compact(
        Facets(grid.reshape(-1, 3), triangles[real], surface[real], walls, parts, whole)
    ).transformed(body.matrix, body.offset)


def _walls(kind: int, curves: Curves) -> Surfaces:
    """What curves sweep along or around the z axis: planes where it is flat."""
    out = Surfaces.placed(kind, curves, np.eye(3), np.zeros(3))
    start, end = curves.starts(), curves.ends()
    flat = curves.kind == LINE
    along = end - start
    if kind == REVOLVED:
        flat &= along[:, 1] == 0.0
        points = np.column_stack([np.zeros((len(start), 2)), start[:, 1]])
        normals = np.column_stack([np.zeros((len(start), 2)), -np.sign(along[:, 0])])
    else:
        points = np.column_stack([start, np.zeros(len(start))])
        normals = np.column_stack([along[:, 1], -along[:, 0], np.zeros(len(start))])
    at = np.flatnonzero(flat)
    if not len(at):
        return out
    table = Surfaces.concatenate([out, Surfaces.planes(points[at], normals[at])])
    row = np.arange(len(out))
    row[at] = len(out) + np.arange(len(at))
    return table[row]


def _successors(outline: _Outline) -> np.ndarray:
    """The point after each one around its loop."""
    out, start = [], 0
    for loop in outline.loops:
        out.append(start + np.roll(np.arange(len(loop)), -1))
        start += len(loop)
    return np.concatenate(out)


def _triangulated(loops: list[np.ndarray]) -> np.ndarray:
    """Triangles over the points of the loops, counterclockwise."""
    from manifold3d import triangulate

    return np.asarray(triangulate(loops), np.int64).reshape(-1, 3)


def _compact(body: Facets) -> Facets:
    points, triangles = in_use(body.points, body.triangles)
    return Facets(points, triangles, body.surface, body.surfaces, body.parts, body.around)

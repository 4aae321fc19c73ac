"""From the leaves of a tree to monotone curve pieces in a working frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np

from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.program import Leaf, Program
from csgmesh.domain.curves import ARC, CUBIC, LINE, QUADRATIC, WIDTH, Curves
from csgmesh.errors import EmptyDomainError, ShapeError
from csgmesh.tolerance import LARGEST, SNAP_SHARE, coordinate_ulp

#: Margin of the working frame beyond the domain, as shares of its extent: no user's box has them.
_MARGIN = np.array([0.1371, 0.1513])

#: Part number of a frame's side, where a half-space was cut off.
FRAME = -1


@dataclass(frozen=True, eq=False)
class Frame:
    """The working box, and the shift and scale to local coordinates of order one.

    ``local = (x - centre) / scale`` with a power of two for the scale, so that coordinates around
    1e9 or of size 1e-9 lose nothing in what follows.
    """

    lo: np.ndarray
    hi: np.ndarray
    centre: np.ndarray
    scale: float
    diagonal: float

    @staticmethod
    def around(lo: np.ndarray, hi: np.ndarray) -> Frame:
        """The frame of a domain with the given box."""
        if not (np.abs([lo, hi]) <= LARGEST).all():
            raise ShapeError(
                f"coordinates must not exceed {LARGEST:g} in size; the shape's transformations "
                f"carry it from {lo.tolist()} to {hi.tolist()}"
            )
        extent = hi - lo
        size = float(extent.max())
        if not size > 0:
            raise EmptyDomainError("the domain is empty: no leaf has an extent")
        margin = _MARGIN * size
        scale = 2.0 ** np.ceil(np.log2(size))
        centre = 0.5 * (lo + hi)
        return Frame(lo - margin, hi + margin, centre, float(scale), float(np.hypot(*extent)))

    def to_local(self, curves: Curves) -> Curves:
        """The curves in local coordinates."""
        shifted = curves.transformed(np.eye(2), -self.centre)
        return Curves(shifted.kind, shifted.data / self.scale, shifted.interval)


@dataclass(frozen=True, eq=False)
class Pieces:
    """Monotone pieces of the leaves' boundaries.

    Attributes
    ----------
    curves, local : Curves
        The exact source curves, in user and in local coordinates.
    source : (k,) int64
        Curve of each piece.
    lo, hi : (k,) float64
        Its parameter interval, lo < hi; monotone in x and in y, and without an inflection.
    forward : (k,) int64
        +1 if the leaf's interior is on the left along increasing parameter, else -1.
    leaf : (k,) int64
        Leaf number; the frame and the embedded paths count on behind the leaves.
    part : (k,) int64
        Part of the leaf, or `FRAME`.
    extent : (n_curves,) float64
        Extent of the leaf that each source curve belongs to, in user coordinates.
    """

    curves: Curves
    local: Curves
    source: np.ndarray
    lo: np.ndarray
    hi: np.ndarray
    forward: np.ndarray
    leaf: np.ndarray
    part: np.ndarray
    extent: np.ndarray

    def __len__(self) -> int:
        return len(self.source)


def working_frame(program: Program) -> Frame:
    """A box that holds every vertex the domain can have."""
    lo, hi = (np.asarray(b, float) for b in program.bounds())
    if np.isfinite(lo).all() and np.isfinite(hi).all():
        if (hi < lo).any():
            raise EmptyDomainError("the domain is empty: the boxes of its leaves do not meet")
        return Frame.around(lo, hi)
    corners = [np.asarray(c, float) for leaf in program.leaves for c in leaf.bounds()]
    points = [c[None] for c in corners if np.isfinite(c).all()]
    planes = [half_space(leaf) for leaf in program.leaves if _is_half_space(leaf)]
    if planes:
        points += [p[None] for p, _ in planes]
        points.append(_meeting_points(planes))
    points += [np.asarray(p, float) for _, p in (*program.paths, *program.probes)]
    cloud = np.concatenate([*points, np.zeros((0, 2))])
    if not len(cloud):
        cloud = np.array([[-1.0, -1.0], [1.0, 1.0]])
    lo, hi = cloud.min(axis=0), cloud.max(axis=0)
    return Frame.around(lo, np.maximum(hi, lo + 1.0 * ((hi - lo).max() == 0)))


def default_snap(frame: Frame, snap: float | None) -> float:
    """The snap distance in user coordinates: at least what rounding of coordinates asks for."""
    least = coordinate_ulp(frame.lo, frame.hi)
    if snap is None:
        return max(SNAP_SHARE * frame.diagonal, least)
    return max(float(snap), least)


def gather(program: Program, frame: Frame) -> Pieces:
    """All pieces of all leaves that reach into the frame."""
    tables, leaf_of, part_of, extents = [], [], [], []
    for number, leaf in enumerate(program.leaves):
        if _is_half_space(leaf):
            curves, part = _clipped_half_space(leaf, frame)
            extent = float((frame.hi - frame.lo).max())
        else:
            lo, hi = (np.asarray(b, float) for b in leaf.bounds())
            if (lo > frame.hi).any() or (hi < frame.lo).any():
                continue
            curves, part = leaf.curves()
            extent = float((hi - lo).max())
        tables.append(curves)
        leaf_of.append(np.full(len(curves), number))
        part_of.append(part)
        extents.append(np.full(len(curves), extent))
    n_leaves = len(program.leaves)
    if any(map(_is_half_space, program.leaves)):
        # A half-space is cut off at the frame, so beyond it the tree would be misread.
        start = _corners(frame)
        tables.append(Curves.lines(start, np.roll(start, -1, axis=0)))
        leaf_of.append(np.full(4, n_leaves))
        part_of.append(np.full(4, FRAME))
        extents.append(np.full(4, frame.diagonal))
    for number, (_, points) in enumerate(program.paths):
        points = np.asarray(points, float)
        tables.append(Curves.lines(points[:-1], points[1:]))
        leaf_of.append(np.full(len(points) - 1, n_leaves + 1 + number))
        part_of.append(np.zeros(len(points) - 1, np.int64))
        extents.append(np.full(len(points) - 1, frame.diagonal))
    none = np.zeros(0, np.int64)
    curves = _straightened(Curves.concatenate(tables))
    leaves = np.concatenate([none, *leaf_of])
    parts = np.concatenate([none, *part_of])
    rows = _joined_rows(curves, leaves, parts)
    first = rows[:, 0]
    joined = Curves(
        curves.kind[first],
        curves.data[first],
        np.column_stack([curves.interval[first, 0], curves.interval[rows[:, 1], 1]]),
    )
    return _monotone(
        joined, frame, leaves[first], parts[first], np.concatenate([np.zeros(0), *extents])[first]
    )


def half_space(leaf: Leaf) -> tuple[np.ndarray, np.ndarray]:
    """A point on the boundary and the unit outward normal, in user coordinates."""
    primitive = cast(HalfSpace, leaf.primitive)
    matrix, offset = np.asarray(leaf.matrix, float), np.asarray(leaf.offset, float)
    point = matrix @ np.asarray(primitive.point, float) + offset
    normal = np.linalg.solve(matrix.T, np.asarray(primitive.normal, float))
    return point, normal / np.hypot(*normal)


def _is_half_space(leaf: Leaf) -> bool:
    return leaf.primitive.kind == "half_space"


def _meeting_points(planes: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    point = np.array([p for p, _ in planes])
    normal = np.array([n for _, n in planes])
    i, j = np.triu_indices(len(planes), 1)
    sine = normal[i, 0] * normal[j, 1] - normal[i, 1] * normal[j, 0]
    i, j, sine = i[np.abs(sine) > 1e-6], j[np.abs(sine) > 1e-6], sine[np.abs(sine) > 1e-6]
    level = (point * normal).sum(1)
    x = (level[i] * normal[j, 1] - level[j] * normal[i, 1]) / sine
    y = (level[j] * normal[i, 0] - level[i] * normal[j, 0]) / sine
    return np.column_stack([x, y])


def _clipped_half_space(leaf: Leaf, frame: Frame) -> tuple[Curves, np.ndarray]:
    """The frame's part in the half-space: a closed polygon whose only real side is the line."""
    point, normal = half_space(leaf)
    corners = _corners(frame)
    depth = (corners - point) @ normal
    polygon: list[np.ndarray] = []
    on_line: list[bool] = []
    for k in range(4):
        a, b, da, db = corners[k], corners[k - 3], depth[k], depth[k - 3]
        if da <= 0:
            polygon.append(a)
            on_line.append(da == 0)
        if (da < 0 < db) or (db < 0 < da):
            polygon.append(a + (b - a) * (da / (da - db)))
            on_line.append(True)
    if len(polygon) < 3:
        return Curves.empty(), np.zeros(0, np.int64)
    start = np.array(polygon)
    line = np.array(on_line)
    part = np.where(line & np.roll(line, -1), 0, FRAME)
    return Curves.lines(start, np.roll(start, -1, axis=0)), part


def _corners(frame: Frame) -> np.ndarray:
    (x0, y0), (x1, y1) = frame.lo, frame.hi
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])


def _straightened(curves: Curves) -> Curves:
    """Bézier curves whose control points stand in line and in order, as lines.

    Fonts have them; their parameter need not even have a speed where they start.
    """
    kind, data = curves.kind.copy(), curves.data.copy()
    for bezier in (QUADRATIC, CUBIC):
        n = WIDTH[bezier] // 2
        at = np.flatnonzero(kind == bezier)
        p = data[at, : 2 * n].reshape(-1, n, 2)
        chord = (p[:, -1] - p[:, 0])[:, None]
        step = np.diff(p, axis=1)
        off = chord[..., 0] * step[..., 1] - chord[..., 1] * step[..., 0]
        along = (chord * step).sum(2)
        size = np.finfo(float).eps * (chord * chord).sum(2)
        flat = at[((np.abs(off) <= size) & (along >= 0)).all(1)]
        kind[flat] = LINE
        data[flat, 2:4] = data[flat, 2 * n - 2 : 2 * n]
        data[flat, 4:] = 0.0
    return Curves(kind, data, curves.interval)


def _joined_rows(curves: Curves, leaf: np.ndarray, part: np.ndarray) -> np.ndarray:
    """First and last row of each run of arcs that continue one another on the same ellipse."""
    n = len(curves)
    if n == 0:
        return np.zeros((0, 2), np.int64)
    same = (
        (curves.kind[1:] == ARC)
        & (curves.kind[:-1] == ARC)
        & (leaf[1:] == leaf[:-1])
        & (part[1:] == part[:-1])
        & (curves.interval[1:, 0] == curves.interval[:-1, 1])
        & (curves.data[1:] == curves.data[:-1]).all(1)
    )
    first = np.flatnonzero(np.r_[True, ~same])
    return np.column_stack([first, np.r_[first[1:] - 1, n - 1]])


def _monotone(
    curves: Curves, frame: Frame, leaf: np.ndarray, part: np.ndarray, extent: np.ndarray
) -> Pieces:
    lo, hi = np.sort(curves.interval, axis=1).T
    bent = np.flatnonzero(curves.kind != LINE)
    at, start, end = _cut_where_turning(curves, lo, hi, bent)
    straight = np.flatnonzero(curves.kind == LINE)
    source = np.concatenate([straight, at])
    order = np.argsort(source, kind="stable")
    source = source[order]
    start = np.concatenate([lo[straight], start])[order]
    end = np.concatenate([hi[straight], end])[order]
    forward = np.where(curves.interval[:, 1] > curves.interval[:, 0], 1, -1)
    return Pieces(
        curves, frame.to_local(curves), source, start, end, forward[source], leaf[source],
        part[source], extent,
    )  # fmt: skip


def _cut_where_turning(
    curves: Curves, lo: np.ndarray, hi: np.ndarray, bent: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Curve, start and end of the monotone pieces of bent curves."""
    owner, cut = _turning_parameters(curves, lo, hi)
    source = np.concatenate([bent, bent, owner])
    t = np.concatenate([lo[bent], hi[bent], cut])
    order = np.lexsort((t, source))
    source, t = source[order], t[order]
    # Cuts a rounding error from an end or from each other would only make slivers.
    width = (hi - lo)[source]
    here = source[1:] == source[:-1]
    keep = np.r_[True, ~here | (t[1:] - t[:-1] > 1e-12 * width[1:])][: len(t)]
    keep |= t == hi[source]
    before_end = np.r_[here & (t[1:] == hi[source[1:]]), False][: len(t)]
    close = np.r_[t[1:] - t[:-1] <= 1e-12 * width[1:], False][: len(t)]
    keep &= ~(before_end & close & (t > lo[source]))
    source, t = source[keep], t[keep]
    pair = np.flatnonzero((source[1:] == source[:-1]) & (t[1:] > t[:-1]))
    return source[pair], t[pair], t[pair + 1]


def _turning_parameters(
    curves: Curves, lo: np.ndarray, hi: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Parameters strictly inside where x' = 0, y' = 0 or the curvature changes sign."""
    owners: list[np.ndarray] = []
    cuts: list[np.ndarray] = []

    def add(rows: np.ndarray, t: np.ndarray) -> None:
        inside = np.isfinite(t) & (t > lo[rows]) & (t < hi[rows])
        owners.append(rows[inside])
        cuts.append(t[inside])

    arcs = np.flatnonzero(curves.kind == ARC)
    for axis in (0, 1):
        extreme = np.arctan2(curves.data[arcs, 4 + axis], curves.data[arcs, 2 + axis])
        first = extreme + np.pi * np.ceil((lo[arcs] - extreme) / np.pi)
        for k in range(3):
            add(arcs, first + k * np.pi)
    with np.errstate(divide="ignore", invalid="ignore"):
        rows = np.flatnonzero(curves.kind == QUADRATIC)
        p = curves.data[rows, :6].reshape(-1, 3, 2)
        for axis in (0, 1):
            a, b = p[:, 1, axis] - p[:, 0, axis], p[:, 2, axis] - p[:, 1, axis]
            add(rows, a / (a - b))
        rows = np.flatnonzero(curves.kind == CUBIC)
        d = np.diff(curves.data[rows].reshape(-1, 4, 2), axis=1)
        for c0, c1, c2 in _cubic_conditions(d):
            for t in _quadratic_roots(c0, c1, c2):
                add(rows, t)
    none = np.zeros(0, np.int64)
    return np.concatenate([none, *owners]), np.concatenate([np.zeros(0), *cuts])


def _cubic_conditions(d: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Polynomials c0 + c1 t + c2 t² whose roots are extremes in x, in y, and inflections."""
    e1 = d[:, 1] - d[:, 0]
    e2 = d[:, 2] - 2 * d[:, 1] + d[:, 0]
    out = [(d[:, 0, k], 2 * e1[:, k], e2[:, k]) for k in (0, 1)]

    def turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]

    # P' ~ d0 + 2 t e1 + t² e2 and P'' ~ e1 + t e2, up to factors.
    out.append((turn(d[:, 0], e1), turn(d[:, 0], e2), turn(e1, e2)))
    return out


def _quadratic_roots(
    c0: np.ndarray, c1: np.ndarray, c2: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    root = np.sqrt(c1 * c1 - 4 * c2 * c0)
    q = -0.5 * (c1 + np.copysign(root, c1))
    return q / c2, c0 / q

"""A Pslg from a discretised boundary made elsewhere: checked, and its faces understood."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from csgmesh.domain.curves import Curves, cross
from csgmesh.domain.planar_map import PlanarMap
from csgmesh.domain.report import Report
from csgmesh.errors import InputError
from csgmesh.spatial import Boxes
from csgmesh.tolerance import coordinate_ulp

UNNAMED = "boundary"


def pslg_fields(
    points: Any,
    segments: Any,
    holes: Any,
    regions: Mapping[str, Any] | None,
    names: Mapping[str, Iterable[int]] | None,
) -> dict[str, Any]:
    """All fields of a Pslg from the arguments of its constructor; see `csgmesh.Pslg`."""
    xy, seg = _arrays(points, segments)
    _refuse_crossings(xy, seg)
    found, face = _faces(xy, seg)
    region_names, region = _regions(xy, seg, found, face, holes, regions)
    sides = np.column_stack([region[face[0::2]], region[face[1::2]]])
    lost = np.flatnonzero((sides < 0).all(1))
    if len(lost):
        x, y = xy[seg[lost[0], 0]]
        raise InputError(
            f"segment {lost[0]} at ({x:.6g}, {y:.6g}) lies outside the domain: it has no region on "
            "either side"
        )
    turn = (sides[:, 0] < 0) | ((sides[:, 1] >= 0) & (sides[:, 1] < sides[:, 0]))
    seg = np.where(turn[:, None], seg[:, ::-1], seg)
    sides = np.where(turn[:, None], sides[:, ::-1], sides)
    marker, boundary_names = _markers(len(seg), names)
    return {
        "points": xy,
        "segments": seg,
        "segment_curve": np.full(len(seg), -1),
        "segment_interval": np.tile([0.0, 1.0], (len(seg), 1)),
        "segment_marker": marker,
        "segment_region": sides,
        "point_marker": np.full(len(xy), -1),
        "boundary_names": boundary_names,
        "region_names": region_names,
        "curves": Curves.empty(),
        "deviation": 0.0,
        "snap": coordinate_ulp(xy),
        "report": Report(),
        "oracle": Winding(xy, seg, sides),
    }


class Winding:
    """The oracle of a hand-made Pslg: the region on the near side of the first segment above."""

    def __init__(self, points: np.ndarray, segments: np.ndarray, sides: np.ndarray) -> None:
        a, b = points[segments[:, 0]], points[segments[:, 1]]
        rightward = (a[:, 0] < b[:, 0])[:, None]
        upright = a[:, 0] == b[:, 0]
        self._a = np.where(rightward, a, b)[~upright]
        self._b = np.where(rightward, b, a)[~upright]
        self._below = np.where(rightward[:, 0], sides[:, 1], sides[:, 0])[~upright]
        self._top = float(points[:, 1].max())

    def region(self, points: np.ndarray) -> np.ndarray:
        """Region of each point, (n,) int64, -1 outside."""
        points = np.asarray(points, float)
        out = np.full(len(points), -1)
        if len(points) == 0:
            return out
        boxes = Boxes(np.minimum(self._a, self._b), np.maximum(self._a, self._b))
        top = np.column_stack([points[:, 0], np.full(len(points), self._top)])
        row, k = boxes.overlapping(np.minimum(points, top), np.maximum(points, top)).T
        x, y = points[row].T
        a, b = self._a[k], self._b[k]
        height = a[:, 1] + (b[:, 1] - a[:, 1]) * ((x - a[:, 0]) / (b[:, 0] - a[:, 0]))
        above = (a[:, 0] <= x) & (x < b[:, 0]) & (height >= y)
        row, k, height = row[above], k[above], height[above]
        slope = ((self._b - self._a)[k, 1]) / ((self._b - self._a)[k, 0])
        order = np.lexsort((slope, height, row))
        first = np.unique(row[order], return_index=True)[1]
        out[row[order][first]] = self._below[k[order][first]]
        return out


def _arrays(points: Any, segments: Any) -> tuple[np.ndarray, np.ndarray]:
    try:
        xy = np.array(points, dtype=np.float64)
        seg = np.array(segments)
    except (TypeError, ValueError) as error:
        raise InputError(f"points and segments must be arrays of numbers: {error}") from None
    if xy.ndim != 2 or xy.shape[1] != 2:
        raise InputError(f"points must have shape (n, 2), got {xy.shape}")
    if seg.ndim != 2 or seg.shape[1:] != (2,) or not np.issubdtype(seg.dtype, np.integer):
        raise InputError(f"segments must be (m, 2) integers, got {seg.dtype} of shape {seg.shape}")
    bad = np.flatnonzero(~np.isfinite(xy).all(1))
    if len(bad):
        raise InputError(f"points must be finite, point {bad[0]} is {tuple(xy[bad[0]].tolist())}")
    out = np.flatnonzero(((seg < 0) | (seg >= len(xy))).any(1))
    if len(out):
        raise InputError(
            f"segments must name points 0 to {len(xy) - 1}, segment {out[0]} is "
            f"{tuple(seg[out[0]].tolist())}"
        )
    if len(seg) < 3:
        raise InputError(f"a domain needs at least 3 segments, got {len(seg)}")
    used, number = np.unique(seg, return_inverse=True)
    _refuse_repeats(xy, used, seg)
    return xy[used], number.reshape(-1, 2).astype(np.int64)


def _refuse_repeats(xy: np.ndarray, used: np.ndarray, seg: np.ndarray) -> None:
    order = used[np.lexsort(xy[used].T[::-1])]
    same = np.flatnonzero((xy[order[1:]] == xy[order[:-1]]).all(1))
    if len(same):
        i, j = sorted(order[same[0] : same[0] + 2].tolist())
        x, y = xy[i]
        raise InputError(f"points {i} and {j} coincide at ({x:.6g}, {y:.6g})")
    pair = np.sort(seg, axis=1)
    order = np.lexsort(pair.T)
    same = np.flatnonzero((pair[order][1:] == pair[order][:-1]).all(1))
    if len(same):
        i, j = sorted(order[same[0] : same[0] + 2].tolist())
        raise InputError(f"segments {i} and {j} join the same points")
    null = np.flatnonzero(seg[:, 0] == seg[:, 1])
    if len(null):
        raise InputError(f"segment {null[0]} begins and ends at point {seg[null[0], 0]}")


def _refuse_crossings(xy: np.ndarray, seg: np.ndarray) -> None:
    a, b = xy[seg[:, 0]], xy[seg[:, 1]]
    i, j = Boxes(np.minimum(a, b), np.maximum(a, b)).pairs().T
    shared = (seg[i][:, :, None] == seg[j][:, None, :]).any((1, 2))
    sides = np.column_stack(
        [
            _sides(xy, seg[i, 0], seg[i, 1], seg[j, 0]),
            _sides(xy, seg[i, 0], seg[i, 1], seg[j, 1]),
            _sides(xy, seg[j, 0], seg[j, 1], seg[i, 0]),
            _sides(xy, seg[j, 0], seg[j, 1], seg[i, 1]),
        ]
    )
    meet = (sides[:, 0] * sides[:, 1] <= 0) & (sides[:, 2] * sides[:, 3] <= 0)
    d_i, d_j = b[i] - a[i], b[j] - a[j]
    # Segments from a common point overlap if they are in line and point the same way.
    flip = np.where(
        (seg[i, 0] == seg[j, 0]) | (seg[i, 1] == seg[j, 1]), 1.0, -1.0
    )
    overlap = shared & (sides == 0).all(1) & (flip * (d_i * d_j).sum(1) > 0)
    bad = np.flatnonzero(np.where(shared, overlap, meet))
    if len(bad):
        k = bad[0]
        x, y = _crossing(a[i[k]], d_i[k], a[j[k]], d_j[k])
        raise InputError(
            f"segments {i[k]} and {j[k]} meet at ({x:.6g}, {y:.6g}), which is no common point of "
            "theirs"
        )


def _crossing(p: np.ndarray, r: np.ndarray, q: np.ndarray, s: np.ndarray) -> np.ndarray:
    turn = r[0] * s[1] - r[1] * s[0]
    if turn == 0:
        return q
    t = ((q - p)[0] * s[1] - (q - p)[1] * s[0]) / turn
    return p + np.clip(t, 0, 1) * r


def _sides(xy: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Exact side of c relative to the line from a to b: -1, 0, 1."""
    left = (xy[a, 0] - xy[c, 0]) * (xy[b, 1] - xy[c, 1])
    right = (xy[a, 1] - xy[c, 1]) * (xy[b, 0] - xy[c, 0])
    det = left - right
    out = np.sign(det).astype(np.int64)
    # Shewchuk 1997: the sign is certain beyond this bound.
    bound = 3.3306690738754716e-16 * (np.abs(left) + np.abs(right))
    for k in np.flatnonzero(np.abs(det) <= bound).tolist():
        if c[k] in (a[k], b[k]):
            out[k] = 0
            continue
        (ax, ay), (bx, by), (cx, cy) = (map(Fraction, xy[v[k]].tolist()) for v in (a, b, c))
        exact = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
        out[k] = (exact > 0) - (exact < 0)
    return out


def _faces(xy: np.ndarray, seg: np.ndarray) -> tuple[PlanarMap, np.ndarray]:
    tail = seg.ravel()
    along = (xy[seg[:, ::-1]] - xy[seg]).reshape(-1, 2)
    order = np.lexsort((np.arctan2(along[:, 1], along[:, 0]), tail))
    found = PlanarMap.from_rotation(tail, order)
    centre = 0.5 * (xy.min(0) + xy.max(0))
    forth = 0.5 * cross(xy[seg[:, 0]] - centre, xy[seg[:, 1]] - centre)
    outer = found.outer_cycles(np.column_stack([forth, -forth]).ravel())
    return found, found.faces(outer, _inside_of(xy, seg, found))


def _inside_of(xy: np.ndarray, seg: np.ndarray, found: PlanarMap) -> np.ndarray:
    """A half-edge directly above the highest point of each component, facing it; or -1."""
    inside = np.full(found.n_components, -1)
    if found.n_components < 2:
        return inside
    v = xy[found.tail]
    order = np.lexsort((v[:, 0], -v[:, 1], found.component))
    first = np.searchsorted(found.component[order], np.arange(found.n_components))
    for component, (x, y) in enumerate(v[order[first]]):
        k = np.flatnonzero(found.component[0::2] != component)
        a, b = xy[seg[k, 0]], xy[seg[k, 1]]
        span = (np.minimum(a[:, 0], b[:, 0]) <= x) & (x < np.maximum(a[:, 0], b[:, 0]))
        k, a, b = k[span], a[span], b[span]
        slope = (b[:, 1] - a[:, 1]) / (b[:, 0] - a[:, 0])
        height = a[:, 1] + slope * (x - a[:, 0])
        k, slope, height, rightward = (
            z[height > y] for z in (k, slope, height, a[:, 0] < b[:, 0])
        )
        if len(k):
            best = np.lexsort((slope, height))[0]
            inside[component] = 2 * k[best] + rightward[best]
    return inside


def _regions(
    xy: np.ndarray,
    seg: np.ndarray,
    found: PlanarMap,
    face: np.ndarray,
    holes: Any,
    regions: Mapping[str, Any] | None,
) -> tuple[tuple[str, ...], np.ndarray]:
    """Region names, and the region of each face."""
    n_faces = int(face.max()) + 1
    sides = np.column_stack([face[0::2], face[1::2]])
    locate = Winding(xy, seg, sides)
    hole_points = _seeds("holes", holes)
    region = np.full(n_faces, 0)
    region[0] = -1
    names: tuple[str, ...] = ("domain",)
    if regions is not None:
        names = tuple(regions)
        if not names:
            raise InputError("regions must not be empty")
        region[:] = -1
        for number, (name, seeds) in enumerate(regions.items()):
            for point in _seeds(f"regions[{name!r}]", seeds):
                at = _face_at(locate, point, f"point of region {name!r}")
                if region[at] not in (-1, number):
                    raise InputError(
                        f"regions {names[region[at]]!r} and {name!r} claim the same face at "
                        f"{tuple(point.tolist())}"
                    )
                region[at] = number
    elif len(hole_points) == 0:
        region[_depths(found, face) % 2 == 0] = -1
    for point in hole_points:
        region[_face_at(locate, point, "hole point")] = -1
    if (region < 0).all():
        raise InputError("the domain is empty: no closed loop of segments bounds a region")
    return names, region


def _depths(found: PlanarMap, face: np.ndarray) -> np.ndarray:
    """How many components each face is nested in, (n_faces,)."""
    n_faces = int(face.max()) + 1
    # A component's outermost face is the one that its lowest-numbered walk from face 0 enters from.
    depth = np.full(n_faces, -1)
    depth[0] = 0
    settled = np.zeros(found.n_components, bool)
    of_face: list[set[int]] = [set() for _ in range(n_faces)]
    for f, c in zip(face.tolist(), found.component.tolist(), strict=True):
        of_face[f].add(c)
    members: list[set[int]] = [set() for _ in range(found.n_components)]
    for f, cs in enumerate(of_face):
        for c in cs:
            members[c].add(f)
    queue = [0]
    while queue:
        f = queue.pop()
        for c in sorted(of_face[f]):
            if settled[c]:
                continue
            settled[c] = True
            for g in sorted(members[c]):
                if depth[g] < 0:
                    depth[g] = depth[f] + 1
                    queue.append(g)
    return depth


def _seeds(what: str, given: Any) -> np.ndarray:
    points = np.asarray(given, dtype=float)
    if points.size == 0:
        return np.zeros((0, 2))
    points = np.atleast_2d(points)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise InputError(f"{what} must be finite points of shape (k, 2), got {given!r}")
    return points


def _face_at(locate: Winding, point: np.ndarray, what: str) -> int:
    at = int(locate.region(point[None])[0])
    if at <= 0:
        raise InputError(f"{what} {tuple(point.tolist())} lies outside every loop of segments")
    return at


def _markers(
    n: int, names: Mapping[str, Iterable[int]] | None
) -> tuple[np.ndarray, tuple[tuple[str, ...], ...]]:
    given: list[list[str]] = [[] for _ in range(n)]
    for name, numbers in (names or {}).items():
        if not isinstance(name, str) or not name:
            raise InputError(f"names must be non-empty strings, got {name!r}")
        for k in np.asarray(list(numbers), dtype=np.int64).tolist():
            if not 0 <= k < n:
                raise InputError(f"names[{name!r}] must hold segment numbers below {n}, got {k}")
            given[k].append(name)
    from csgmesh.domain.pslg import marker_table

    return marker_table([tuple(dict.fromkeys(g)) or (UNNAMED,) for g in given])

"""A Pslg from a discretised boundary made elsewhere: checked, and its faces understood."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from csgmesh.domain.curves import Curves, cross
from csgmesh.domain.names import name_flaw
from csgmesh.domain.planar_map import PlanarMap
from csgmesh.domain.rays import UpwardRays, sides
from csgmesh.domain.report import Report
from csgmesh.errors import InputError
from csgmesh.spatial import Boxes
from csgmesh.tolerance import LARGEST, SMALLEST, coordinate_ulp

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
    between = np.column_stack([region[face[0::2]], region[face[1::2]]])
    lost = np.flatnonzero((between < 0).all(1))
    if len(lost):
        x, y = xy[seg[lost[0], 0]]
        raise InputError(
            f"segment {lost[0]} at ({x:.6g}, {y:.6g}) lies outside the domain: it has no region on "
            "either side"
        )
    turn = (between[:, 0] < 0) | ((between[:, 1] >= 0) & (between[:, 1] < between[:, 0]))
    seg = np.where(turn[:, None], seg[:, ::-1], seg)
    between = np.where(turn[:, None], between[:, ::-1], between)
    marker, boundary_names = _markers(len(seg), names)
    return {
        "points": xy,
        "segments": seg,
        "segment_curve": np.full(len(seg), -1),
        "segment_interval": np.tile([0.0, 1.0], (len(seg), 1)),
        "segment_marker": marker,
        "segment_region": between,
        "point_marker": np.full(len(xy), -1),
        "boundary_names": boundary_names,
        "region_names": region_names,
        "curves": Curves.empty(),
        "deviation": 0.0,
        "snap": coordinate_ulp(xy),
        "report": Report(),
        "oracle": FaceOracle(xy, seg, between),
        "periodic": (),
    }


class FaceOracle:
    """The oracle of a hand-made Pslg: what lies below the first segment above a point."""

    def __init__(self, points: np.ndarray, segments: np.ndarray, labels: np.ndarray) -> None:
        self._rays = UpwardRays(points, segments)
        rightward = points[segments[:, 0], 0] < points[segments[:, 1], 0]
        self._below = np.where(rightward, labels[:, 1], labels[:, 0])

    def region(self, points: np.ndarray) -> np.ndarray:
        """Region of each point, (n,) int64, -1 outside."""
        above = self._rays.first(np.asarray(points, float))
        return np.where(above >= 0, self._below[above], -1)


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
    bad = np.flatnonzero(~(np.abs(xy) <= LARGEST).all(1))
    if len(bad):
        raise InputError(
            f"points must be finite and at most {LARGEST:g} in size, "
            f"point {bad[0]} is {tuple(xy[bad[0]].tolist())}"
        )
    out = np.flatnonzero(((seg < 0) | (seg >= len(xy))).any(1))
    if len(out):
        raise InputError(
            f"segments must name points 0 to {len(xy) - 1}, segment {out[0]} is "
            f"{tuple(seg[out[0]].tolist())}"
        )
    if len(seg) < 3:
        raise InputError(f"a domain needs at least 3 segments, got {len(seg)}")
    used, number = np.unique(seg, return_inverse=True)
    if np.ptp(xy[used], axis=0).min() < SMALLEST:
        lo, hi = (tuple(corner(xy[used], axis=0).tolist()) for corner in (np.min, np.max))
        raise InputError(f"a domain must be wider than {SMALLEST:g} in x and y, got {lo} to {hi}")
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
    side = np.column_stack(
        [
            sides(a[i], b[i], a[j]),
            sides(a[i], b[i], b[j]),
            sides(a[j], b[j], a[i]),
            sides(a[j], b[j], b[i]),
        ]
    )
    meet = (side[:, 0] * side[:, 1] <= 0) & (side[:, 2] * side[:, 3] <= 0)
    d_i, d_j = b[i] - a[i], b[j] - a[j]
    # Segments from a common point overlap if they are in line and point the same way.
    flip = np.where((seg[i, 0] == seg[j, 0]) | (seg[i, 1] == seg[j, 1]), 1.0, -1.0)
    overlap = shared & (side == 0).all(1) & (flip * (d_i * d_j).sum(1) > 0)
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
    if found.n_components < 2:
        return np.full(found.n_components, -1)
    v = xy[found.tail]
    order = np.lexsort((v[:, 0], -v[:, 1], found.component))
    highest = np.searchsorted(found.component[order], np.arange(found.n_components))
    above = UpwardRays(xy, seg).first(
        v[order[highest]], np.arange(found.n_components), found.component[0::2]
    )
    rightward = xy[seg[above, 0], 0] < xy[seg[above, 1], 0]
    return np.where(above >= 0, 2 * above + rightward, -1)


def _regions(
    xy: np.ndarray,
    seg: np.ndarray,
    found: PlanarMap,
    face: np.ndarray,
    holes: Any,
    regions: Mapping[str, Any] | None,
) -> tuple[tuple[str, ...], np.ndarray]:
    """Region names, and the region of each face."""
    locate = FaceOracle(xy, seg, np.column_stack([face[0::2], face[1::2]]))
    region = np.full(int(face.max()) + 1, 0)
    names: tuple[str, ...] = ("domain",)
    hole_points = _seeds("holes", holes)
    if regions is not None:
        names = _claim(region, locate, regions)
    elif len(hole_points) == 0:
        region[_depths(found, face) % 2 == 0] = -1
    region[0] = -1
    region[_faces_at(locate, hole_points, lambda _: "hole point")] = -1
    if (region < 0).all():
        raise InputError("the domain is empty: no closed loop of segments bounds a region")
    return names, region


def _claim(region: np.ndarray, locate: FaceOracle, regions: Mapping[str, Any]) -> tuple[str, ...]:
    """Write the region of each face that holds a point of one; return the names."""
    if not isinstance(regions, Mapping) or not regions:
        raise InputError(
            f"regions must be a mapping of names to points, such as {{'rock': (0, 0)}}; "
            f"got {regions!r}"
        )
    names = tuple(regions)
    _refuse_names("regions", names)
    seeds = [_seeds(f"regions[{name!r}]", points) for name, points in regions.items()]
    for name, points in zip(names, seeds, strict=True):
        if not len(points):
            raise InputError(f"regions[{name!r}] needs a point at least, got none")
    owner = np.repeat(np.arange(len(names)), [len(points) for points in seeds])
    points = np.concatenate(seeds)
    at = _faces_at(locate, points, lambda k: f"point of region {names[owner[k]]!r}")
    region[:] = -1
    region[at] = owner
    claimed_twice = np.flatnonzero(region[at] != owner)
    if len(claimed_twice):
        k = claimed_twice[0]
        raise InputError(
            f"regions {names[owner[k]]!r} and {names[region[at[k]]]!r} claim the same face at "
            f"{tuple(points[k].tolist())}"
        )
    return names


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
    try:
        points = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{what} must be points of shape (k, 2), got {given!r}") from None
    if points.size == 0:
        return np.zeros((0, 2))
    points = np.atleast_2d(points)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise InputError(f"{what} must be finite points of shape (k, 2), got {given!r}")
    return points


def _faces_at(locate: FaceOracle, points: np.ndarray, what: Callable[[int], str]) -> np.ndarray:
    at = locate.region(points)
    outside = np.flatnonzero(at <= 0)
    if len(outside):
        k = int(outside[0])
        raise InputError(
            f"{what(k)} {tuple(points[k].tolist())} lies outside every loop of segments"
        )
    return at


def _refuse_names(what: str, names: Iterable[Any]) -> None:
    for name in names:
        flaw = name_flaw(name)
        if flaw:
            raise InputError(f"{what}: {flaw}")


def _markers(
    n: int, names: Mapping[str, Iterable[int]] | None
) -> tuple[np.ndarray, tuple[tuple[str, ...], ...]]:
    from csgmesh.domain.pslg import marker_table

    if names is not None and not isinstance(names, Mapping):
        raise InputError(
            f"names must be a mapping of names to segment numbers, such as {{'inlet': [0, 1]}}; "
            f"got {names!r}"
        )
    _refuse_names("names", names or ())
    given: list[list[str]] = [[] for _ in range(n)]
    for name, numbers in (names or {}).items():
        for k in _segment_numbers(name, numbers, n):
            given[k].append(name)
    return marker_table([tuple(dict.fromkeys(g)) or (UNNAMED,) for g in given])


def _segment_numbers(name: str, numbers: Any, n: int) -> list[int]:
    listed = list(numbers) if isinstance(numbers, Iterable) else [numbers]
    array = np.asarray(listed) if listed else np.zeros(0, np.int64)
    if array.ndim != 1 or not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"names[{name!r}] must hold segment numbers, got {numbers!r}")
    out = np.flatnonzero((array < 0) | (array >= n))
    if len(out):
        raise InputError(
            f"names[{name!r}] must hold segment numbers below {n}, got {array[out[0]]}"
        )
    numbers_of: list[int] = array.tolist()
    return numbers_of

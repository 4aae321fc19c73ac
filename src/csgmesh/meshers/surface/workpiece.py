"""The arrays that kernels mesh a surface in."""

from __future__ import annotations

from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.domain.plc import Plc
from csgmesh.domain.surfaces import PLANE, Surfaces
from csgmesh.meshers.surface.complexes import FeatureComplex

#: Numbers and codes a surface, and where they are; see the kernels.
_WIDTH, _INVERSE, _OFFSET, _PROFILE, _INTERVAL, _CODES = 32, 9, 18, 21, 29, 4
#: Positions in ``count``.
_POINTS, _TRIANGLES, _SEGMENTS, _HEAD, _QUEUED, _LATER_HEAD, _LATER, _MASK = range(8)
#: Triangles that one step may need.
_ROOM = 512
#: Points that one call of a kernel treats: less than 0.2 s.
_SLICE = 50_000


class Workpiece:
    """A triangulated surface that kernels change in place."""

    def __init__(self, plc: Plc, parts: FeatureComplex, size: np.ndarray, cap: np.ndarray) -> None:
        n, m, k = len(plc.points), plc.n_facets, len(parts.segments)
        self.plc, self.parts = plc, parts
        self.a: dict[str, np.ndarray] = {
            "xyz": plc.points.reshape(-1).copy(),
            "size": size.astype(float),
            "cap": cap.astype(float),
            "dim": parts.dim.astype(np.int8),
            "owner": parts.owner.astype(np.int32),
            "link": _links(plc, parts).reshape(-1).astype(np.int32),
            "keep": (parts.dim <= 0).astype(np.int8),
            "origin": _four(plc.facets, parts.face),
            "twin": _four(_half_edges(parts.twin).reshape(-1, 3), np.zeros(m)),
            "ring": _four(_half_edges(parts.ring).reshape(-1, 3), np.zeros(m)),
            "seg": np.column_stack(
                [parts.segments, parts.segment_curve, _half_edges(parts.segment_first)]
            )
            .reshape(-1)
            .astype(np.int32),
            "face_surface": parts.face_surface.astype(np.int32),
            "face_sign": _signs(plc, parts).astype(np.int8),
            "pair": parts.curve_surfaces.reshape(-1).astype(np.int32),
            "curve_ends": _curve_ends(parts).reshape(-1).astype(np.int32),
            "todo": np.zeros(1 << 16, np.int32),
            "buffer": np.zeros(512, np.int32),
            "queue": np.zeros(1, np.int32),
            "later": np.zeros(1, np.int32),
            "count": np.zeros(16, np.int64),
        }
        self.a["number"], self.a["code"] = surface_table(plc.surfaces)
        self.a["count"][:3] = n, m + 1, k
        self._arrays: Any = None

    @property
    def n_points(self) -> int:
        """Vertices so far, removed ones included."""
        return int(self.a["count"][_POINTS])

    @property
    def n_triangles(self) -> int:
        """Triangles so far, removed ones and number 0 included."""
        return int(self.a["count"][_TRIANGLES])

    @property
    def n_segments(self) -> int:
        """Segments so far, removed ones included."""
        return int(self.a["count"][_SEGMENTS])

    @property
    def arrays(self) -> Any:
        """All arrays as kernels take them."""
        if self._arrays is None:
            self._arrays = kernels.SurfaceArrays(
                **{name: self.a[name] for name in kernels.SurfaceArrays._fields}
            )
        return self._arrays

    def reserve(self, points: int, triangles: int, segments: int) -> None:
        """Make room for so many more of each."""
        a = self.a
        n = self.n_points + points
        for name, width in (
            ("xyz", 3), ("size", 1), ("cap", 1), ("dim", 1), ("owner", 1), ("keep", 1), ("link", 2),
        ):  # fmt: skip
            a[name] = _grown(a[name], width * n)
        m = self.n_triangles + triangles + _ROOM
        for name in ("origin", "twin", "ring"):
            a[name] = _grown(a[name], 4 * m)
        a["seg"] = _grown(a["seg"], 4 * (self.n_segments + segments))
        self._requeue(m)
        self._arrays = None

    def _requeue(self, triangles: int) -> None:
        """Queues of room for all triangles, what waits in them first."""
        count = self.a["count"]
        room = 1 << int(triangles).bit_length()
        for name, head, length in (("queue", _HEAD, _QUEUED), ("later", _LATER_HEAD, _LATER)):
            if room <= len(self.a[name]):
                continue
            old = self.a[name]
            waiting = (count[head] + np.arange(count[length])) % len(old)
            new = np.zeros(room, np.int32)
            new[: count[length]] = old[waiting]
            self.a[name] = new
            count[head] = 0
        count[_MASK] = len(self.a["queue"]) - 1

    def enqueue(self, triangles: np.ndarray) -> None:
        """Let the refinement look at triangles that do not wait yet."""
        a, count = self.a, self.a["count"]
        new = triangles[(a["twin"][4 * triangles + 3] & 1) == 0]
        a["twin"][4 * new + 3] |= 1
        at = (count[_HEAD] + count[_QUEUED] + np.arange(len(new))) & count[_MASK]
        a["queue"][at] = new
        count[_QUEUED] += len(new)

    def repeated(self) -> tuple[np.ndarray, np.ndarray]:
        """Half-edges of edges, and segments, that have the same two ends as others.

        One of several segments is left out. The segments' numbers come last; also which of the
        two each number is.
        """
        twin = self.a["twin"].reshape(-1, 4)
        living = self.living()
        row, k = np.nonzero(twin[living, :3] > 4 * living[:, None] + np.arange(3))
        half = 4 * living[row] + k
        seg = self.a["seg"][: 4 * self.n_segments].reshape(-1, 4)
        there = np.flatnonzero(seg[:, 0] >= 0)
        origin = self.a["origin"]
        following = 4 * (half // 4) + (half % 4 + 1) % 3
        ends = np.concatenate(
            [seg[there, :2], np.column_stack([origin[half], origin[following]])]
        ).astype(np.int64)
        key = ends.min(axis=1) * self.n_points + ends.max(axis=1)
        order = np.argsort(key, kind="stable")
        same = key[order[1:]] == key[order[:-1]]
        first, again = order[:-1][same], order[1:][same]
        again = np.unique(np.concatenate([first[first >= len(there)], again]))[::-1]
        is_segment = again < len(there)
        number = np.where(is_segment, there[again * is_segment], half[again - len(there)])
        return number, is_segment

    def living(self) -> np.ndarray:
        """Numbers of the triangles that are there."""
        face = self.a["origin"][3 : 4 * self.n_triangles : 4]
        return np.flatnonzero(face >= 0)

    def corners(self, triangles: np.ndarray) -> np.ndarray:
        """Vertices of triangles, (k, 3)."""
        return self.a["origin"].reshape(-1, 4)[triangles, :3].astype(np.int64)

    def points(self) -> np.ndarray:
        """Places of all vertices so far, (n, 3), a view."""
        return self.a["xyz"][: 3 * self.n_points].reshape(-1, 3)


def surface_table(surfaces: Surfaces) -> tuple[np.ndarray, np.ndarray]:
    """Numbers and codes of exact surfaces, flat, as kernels take them."""
    n = len(surfaces)
    number, code = np.zeros((n, _WIDTH)), np.zeros((n, _CODES), np.int32)
    number[:, :9] = surfaces.matrix.reshape(n, 9)
    number[:, _INVERSE : _INVERSE + 9] = surfaces.inverse.reshape(n, 9)
    number[:, _OFFSET : _OFFSET + 3] = surfaces.offset
    number[:, _PROFILE : _PROFILE + 8] = surfaces.profile.data
    number[:, _INTERVAL : _INTERVAL + 2] = surfaces.profile.interval
    flat = surfaces.kind == PLANE
    number[flat, _PROFILE : _PROFILE + 3] = surfaces.plane_normals[flat]
    code[:, 0], code[:, 1] = surfaces.kind, surfaces.profile.kind
    code[:, 2] = surfaces.profile.is_circular()
    return number.reshape(-1), code.reshape(-1)


def feet_and_normals(
    surfaces: Surfaces, which: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Feet of points (k, 3) on surfaces `which` (k,) and the outward normals there."""
    number, code = surface_table(surfaces)
    feet, normals = np.empty((len(points), 3)), np.empty((len(points), 3))
    which = np.ascontiguousarray(which, dtype=np.int64)
    points = np.ascontiguousarray(points, dtype=np.float64)
    for start in range(0, len(points), _SLICE):
        stop = min(start + _SLICE, len(points))
        kernels.surface_feet(code, number, which, points, feet, normals, start, stop)
    return feet, normals


def _signs(plc: Plc, parts: FeatureComplex) -> np.ndarray:
    """1 for faces that look to where their surface's normal points, -1 for others."""
    a, b, c = (plc.points[plc.facets[:, k]] for k in range(3))
    _, normals = feet_and_normals(plc.surfaces, plc.facet_surface, (a + b + c) / 3.0)
    along = (np.cross(b - a, c - a) * normals).sum(axis=1)
    return np.where(np.bincount(parts.face, weights=along) < 0.0, -1, 1)


def _half_edges(h: np.ndarray) -> np.ndarray:
    """Half-edges ``3 t + k`` as ``4 (t + 1) + k``; negative numbers stay."""
    return np.where(h >= 0, 4 * (h // 3 + 1) + h % 3, h)


def _four(rows: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Rows of three and a fourth column, after one for triangle 0, which is none."""
    out = np.empty((len(rows) + 1, 4), np.int32)
    out[0] = -1
    out[1:, :3], out[1:, 3] = rows, last
    return out.reshape(-1)


def _links(plc: Plc, parts: FeatureComplex) -> np.ndarray:
    """A half-edge of each face's vertex, the two segments of each curve's, (n, 2)."""
    link = np.zeros((len(plc.points), 2), np.int64)
    link[plc.facets.ravel(), 0] = _half_edges(np.arange(3 * plc.n_facets))
    flat = parts.segments.ravel()
    order = np.argsort(flat, kind="stable")
    along = np.flatnonzero(parts.dim == 1)
    start = np.searchsorted(flat[order], along)
    link[along, 0], link[along, 1] = order[start] // 2, order[start + 1] // 2
    return link


def _curve_ends(parts: FeatureComplex) -> np.ndarray:
    """Corners at the ends of each curve, -1 where there is none, (c, 2)."""
    curve = np.repeat(parts.segment_curve, 2)
    end = parts.segments.ravel()
    at = parts.dim[end] == 0
    pairs = np.unique(np.column_stack([curve[at], end[at]]), axis=0)
    out = np.full((len(parts.curve_surfaces), 2), -1)
    out[pairs[::-1, 0], 0] = pairs[::-1, 1]
    other = pairs[:, 1] != out[pairs[:, 0], 0]
    out[pairs[other, 0], 1] = pairs[other, 1]
    return out


def _grown(array: np.ndarray, length: int) -> np.ndarray:
    if length <= len(array):
        return array
    out = np.zeros(length, array.dtype)
    out[: len(array)] = array
    return out

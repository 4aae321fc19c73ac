"""Faces, curves and corners of a domain, and points put on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.domain.plc import Plc
from csgmesh.domain.surfaces import Surfaces
from csgmesh.errors import MeshingError

_STEPS = 10

#: Faces that a search for the nearest ones remembers at each place.
_KEPT = 6

#: Normals that differ by less count as one: where surfaces touch, Newton's method must not move
#: along the touching.
_INDEPENDENT = 1e-4

#: Faces that meet within the solid at more than this many degrees share one sheet of cells, which
#: goes on from one to the other; at less each has its own.
JOINED = 150.0


@dataclass(frozen=True, eq=False)
class Strata:
    """What the boundary of a domain consists of.

    Attributes
    ----------
    domain : Plc
    face : (m,) int64
        Of each facet.
    face_surface, face_sign : (f,) int64
        Faces are told apart by their surfaces, not by names. The sign is -1 where the solid lies
        in front of the surface, as in a bore.
    face_regions : (f, 2) int64
        Regions behind and in front of each face, -1 outside.
    face_axis, face_place : (f,) int64, (f,) float64
        Axis that a flat face is perpendicular to, and where it meets it; -1 for others.
    segments : (k, 2, 3) float64
        Pieces of the curves where faces meet.
    pair : (k, 2) int64
        The two faces at each piece, the lower first.
    turn : (k,) float64
        Angle inside the solid between them, degrees.
    corners : (c, 3) float64
    corner_faces : tuple of tuple of int
        Faces around each corner, sorted; a single one around the apex of a cone.
    """

    domain: Plc
    face: np.ndarray
    face_surface: np.ndarray
    face_sign: np.ndarray
    face_regions: np.ndarray
    face_axis: np.ndarray
    face_place: np.ndarray
    segments: np.ndarray
    pair: np.ndarray
    turn: np.ndarray
    corners: np.ndarray
    corner_faces: tuple[tuple[int, ...], ...]

    @classmethod
    def of(cls, domain: Plc) -> Strata:
        """The strata of a domain."""
        sign = _signs(domain)
        key = np.column_stack([domain.facet_surface, sign, domain.facet_region])
        table, face = np.unique(key, axis=0, return_inverse=True)
        face = face.reshape(-1)
        axis, place = _flat_faces(domain, face, len(table))
        edges, pair, turn = _curves(domain, face, sign)
        corners, around = _corners(domain, face, edges, pair)
        peaks = np.setdiff1d(_peaks(domain, sign), corners)
        corners = np.concatenate([corners, peaks])
        around = (*around, *((f,) for f in _faces_at(domain, face, peaks)))
        return cls(
            domain,
            face,
            table[:, 0],
            table[:, 1],
            table[:, 2:],
            axis,
            place,
            domain.points[edges],
            pair,
            turn,
            domain.points[corners],
            around,
        )

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return len(self.face_surface)

    def on_faces(self, faces: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Points on the exact surfaces of faces, (k, 3)."""
        return self.domain.surfaces.project(self.face_surface[faces], points)

    def lengths(self) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of faces that meet, (p, 2), and how long their curves are, (p,)."""
        pairs, which = np.unique(self.pair, axis=0, return_inverse=True)
        long = np.sqrt(((self.segments[:, 1] - self.segments[:, 0]) ** 2).sum(axis=1))
        return pairs, np.bincount(which.reshape(-1), long, len(pairs))

    def areas(self) -> np.ndarray:
        """Area of each face, (f,)."""
        return np.bincount(self.face, self.domain.facet_areas(), self.n_faces)

    def markers(self, faces: np.ndarray, points: np.ndarray, size: float) -> np.ndarray:
        """Entry of the domain's names at points of faces (k,)."""
        domain = self.domain
        table, part = np.unique(
            np.column_stack([self.face, domain.facet_marker]), axis=0, return_inverse=True
        )
        first = np.searchsorted(table[:, 0], np.arange(self.n_faces))
        several = np.bincount(table[:, 0], minlength=self.n_faces) > 1
        out = table[first[faces], 1]
        asked = np.flatnonzero(several[faces])
        if len(asked):
            there = np.flatnonzero(several[self.face])
            finder = Finder.of(self, size, size, there, part.reshape(-1))
            found, _, _ = finder.nearest(points[asked])
            own = (found >= 0) & (table[found, 0] == faces[asked][:, None])
            known = own.any(axis=1)
            choice = found[np.arange(len(asked)), np.argmax(own, axis=1)]
            out[asked[known]] = table[choice[known], 1]
        return out

    def normals(self, faces: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Unit normals of faces that point out of the solid, (k, 3)."""
        normal = self.domain.surfaces.normals(self.face_surface[faces], points)
        return normal * self.face_sign[faces][:, None]

    def on_curves(self, pair: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points near curves (k, 3) on both exact surfaces of their pairs (k, 2), and tangents."""
        out, along = points.copy(), np.zeros_like(points)
        for a, b in np.unique(pair, axis=0).tolist():
            own = np.flatnonzero((pair[:, 0] == a) & (pair[:, 1] == b))
            there = np.flatnonzero((self.pair[:, 0] == a) & (self.pair[:, 1] == b))
            if not len(there):
                continue
            out[own], along[own] = nearest_on_segments(points[own], self.segments[there])
        rows = self.face_surface[pair]
        return on_both(self.domain.surfaces, rows, out), along


def nearest_on_segments(points: np.ndarray, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nearest points on pieces (k, 2, 3), and the pieces' unit tangents."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    square = (along**2).sum(axis=1)
    best, tangent = np.empty_like(points), np.empty_like(points)
    for first in range(0, len(points), 256):
        p = points[first : first + 256, None]
        t = np.clip(((p - start) * along).sum(axis=2) / square, 0.0, 1.0)
        foot = start + t[:, :, None] * along
        at = np.argmin(((foot - p) ** 2).sum(axis=2), axis=1)
        best[first : first + 256] = foot[np.arange(len(at)), at]
        tangent[first : first + 256] = along[at] / np.sqrt(square[at])[:, None]
    return best, tangent


def on_both(surfaces: Surfaces, rows: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Points moved onto the surfaces of their row (k, j) by Newton's method."""
    place, width = points.copy(), rows.shape[1]
    for _ in range(_STEPS):
        flat = np.repeat(place, width, axis=0)
        foot = surfaces.project(rows.ravel(), flat)
        normal = surfaces.normals(rows.ravel(), foot).reshape(-1, width, 3)
        gap = ((foot - flat).reshape(-1, width, 3) * normal).sum(axis=2)
        move = np.einsum("vij,vj->vi", np.linalg.pinv(normal, rcond=_INDEPENDENT), gap)
        place = place + move
        size = np.abs(place).max(initial=0.0)
        if np.abs(move).max(initial=0.0) <= 4.0 * np.finfo(float).eps * size:
            break
    return place


def _flat_faces(domain: Plc, face: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    axis, place = np.full(n, -1), np.full(n, np.nan)
    low, high = np.full((n, 3), np.inf), np.full((n, 3), -np.inf)
    for k in range(3):
        np.minimum.at(low, face, domain.points[domain.facets[:, k]])
        np.maximum.at(high, face, domain.points[domain.facets[:, k]])
    for k in range(3):
        flat = high[:, k] - low[:, k] <= 10.0 * domain.snap
        axis[flat], place[flat] = k, 0.5 * (low + high)[flat, k]
    return axis, place


def _signs(domain: Plc) -> np.ndarray:
    """Whether the exact normals point out of the solid, 1, or into it, -1; of each facet."""
    a, b, c = (domain.points[domain.facets[:, k]] for k in range(3))
    exact = domain.surfaces.normals(domain.facet_surface, (a + b + c) / 3.0)
    return np.where((np.cross(b - a, c - a) * exact).sum(axis=1) < 0.0, -1, 1)


def _curves(
    domain: Plc, face: np.ndarray, sign: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges between faces, the faces there, and the angle between them inside."""
    facets = domain.facets
    tail, head = facets.ravel(), np.roll(facets, -1, axis=1).ravel()
    owner = np.repeat(np.arange(len(facets)), 3)
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    order = np.lexsort((owner, high, low))
    edge, count = np.unique(np.column_stack([low, high]), axis=0, return_counts=True)
    if (count != 2).any():
        x, y, z = domain.points[edge[np.flatnonzero(count != 2)[0]]].mean(axis=0)
        raise MeshingError(
            f"hexahedra need a boundary without edges at which more than two facets meet; "
            f"the domain touches itself at ({x:.6g}, {y:.6g}, {z:.6g})"
        )
    first, second = owner[order[0::2]], owner[order[1::2]]
    differs = face[first] != face[second]
    edge, first, second = edge[differs], first[differs], second[differs]
    middle = domain.points[edge].mean(axis=1)
    one = domain.surfaces.normals(domain.facet_surface[first], middle)
    two = domain.surfaces.normals(domain.facet_surface[second], middle)
    one *= sign[first][:, None]
    two *= sign[second][:, None]
    centre = domain.points[facets[second]].mean(axis=1)
    rises = ((centre - middle) * one).sum(axis=1) > 0.0
    between = np.degrees(np.arccos(np.clip((one * two).sum(axis=1), -1.0, 1.0)))
    turn = np.where(rises, 180.0 + between, 180.0 - between)
    pair = np.sort(np.column_stack([face[first], face[second]]), axis=1)
    return edge, pair, turn


def _corners(
    domain: Plc, face: np.ndarray, edges: np.ndarray, pair: np.ndarray
) -> tuple[np.ndarray, tuple[tuple[int, ...], ...]]:
    """Points where curves end or meet, and the faces around each."""
    n = len(domain.points)
    degree = np.bincount(edges.ravel(), minlength=n)
    least, most = np.full((n, 2), len(face)), np.full((n, 2), -1)
    for k in range(2):
        np.minimum.at(least, edges[:, k], pair)
        np.maximum.at(most, edges[:, k], pair)
    found = np.flatnonzero((degree != 0) & ((degree != 2) | (least != most).any(axis=1)))
    position = np.full(n, -1)
    position[found] = np.arange(len(found))
    around: list[set[int]] = [set() for _ in found]
    rows, columns = np.nonzero(position[domain.facets] >= 0)
    for f, p in zip(face[rows].tolist(), domain.facets[rows, columns].tolist(), strict=True):
        around[position[p]].add(f)
    return found, tuple(tuple(sorted(faces)) for faces in around)


#: Closeness to a point, as a share of its facets, from which normals are compared, and the angle's
#: cosine between them from which on the point is a peak of its surface, as a cone's apex is.
_CLOSE, _PEAKED = 1e-3, 0.97


def _peaks(domain: Plc, sign: np.ndarray) -> np.ndarray:
    """Points without a tangent plane in the midst of one face, (k,)."""
    at = domain.facets.ravel()
    centre = np.repeat(domain.points[domain.facets].mean(axis=1), 3, axis=0)
    near = domain.points[at] + _CLOSE * (centre - domain.points[at])
    surface = np.repeat(domain.facet_surface, 3)
    normal = domain.surfaces.normals(surface, domain.surfaces.project(surface, near))
    normal *= np.repeat(sign, 3)[:, None]
    n = len(domain.points)
    total = np.column_stack([np.bincount(at, normal[:, k], n) for k in range(3)])
    mean = total / np.maximum(np.sqrt((total**2).sum(axis=1)), 1e-300)[:, None]
    least = np.ones(n)
    np.minimum.at(least, at, (normal * mean[at]).sum(axis=1))
    lowest, highest = np.full(n, len(domain.surfaces)), np.full(n, -1)
    np.minimum.at(lowest, at, surface)
    np.maximum.at(highest, at, surface)
    return np.flatnonzero((least < _PEAKED) & (lowest == highest))


def _faces_at(domain: Plc, face: np.ndarray, points: np.ndarray) -> list[int]:
    """A face around each point, (k,)."""
    out = np.full(len(domain.points), -1)
    out[domain.facets.ravel()] = np.repeat(face, 3)
    return [int(f) for f in out[points]]


@dataclass(frozen=True, eq=False)
class Finder:
    """Finds the nearest faces of a boundary by its facets."""

    triangles: np.ndarray
    face: np.ndarray
    low: np.ndarray
    side: float
    shape: np.ndarray
    begin: np.ndarray
    items: np.ndarray

    @classmethod
    def of(
        cls,
        strata: Strata,
        side: float,
        reach: float,
        facets: np.ndarray,
        part: np.ndarray | None = None,
    ) -> Finder:
        """Of some facets; finds what is within reach. `part` replaces the facets' faces."""
        domain = strata.domain
        low, high = domain.bounds()
        low, high = low - 2.0 * side, high + 2.0 * side
        shape = np.ceil((high - low) / side).astype(np.int64)
        triangles = np.ascontiguousarray(domain.points[domain.facets[facets]].reshape(-1, 9))
        normal = np.cross(triangles[:, 3:6] - triangles[:, :3], triangles[:, 6:] - triangles[:, :3])
        size = np.sqrt((normal**2).sum(axis=1))
        normal /= np.where(size > 0.0, size, 1.0)[:, None]
        count = np.zeros(int(shape.prod()) + 1, np.int64)
        nothing = np.zeros(0, np.int64)
        kernels.fill_buckets(triangles, normal, low, side, shape, reach, count, nothing, False)
        begin = np.concatenate([[0], np.cumsum(count[:-1])])
        items = np.empty(int(begin[-1]), np.int64)
        kernels.fill_buckets(
            triangles, normal, low, side, shape, reach, begin[:-1].copy(), items, True
        )
        own = (strata.face if part is None else part)[facets]
        return cls(triangles, own, low, side, shape, begin, items)

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nearest faces (n, k), -1 for none, distances (n, k), infinite, and places (n, k, 3)."""
        n = len(points)
        faces = np.full((n, _KEPT), -1)
        squares = np.full((n, _KEPT), np.inf)
        places = np.zeros((n, _KEPT, 3))
        start, spot = 0, np.zeros(3)
        points = np.ascontiguousarray(points)
        while start < n:
            start = kernels.nearest_faces(
                points,
                self.triangles,
                self.face,
                self.low,
                self.side,
                self.shape,
                self.begin,
                self.items,
                faces,
                squares,
                places,
                spot,
                start,
            )
        return faces, np.sqrt(squares), places

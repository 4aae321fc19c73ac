"""Faces, curves and corners of a `Plc`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surfaces import REVOLVED
from csgmesh.graphs import components

#: A curve that turns by more than this many degrees at a point has a corner there: more than
#: between neighbouring pieces of any smooth curve that evaluation makes, which turn by 30 at most.
_KINK = 50.0
#: Sine below which two normals are parallel.
_PARALLEL = 1e-3
#: A surface's normal that is not along its axis, at a pole: the apex of a cone. Cosine.
_APEX = 0.999


@dataclass(frozen=True, eq=False)
class FeatureComplex:
    """The strata of a `Plc`.

    Attributes
    ----------
    twin : (3 m,) int64
        Of half-edge ``3 t + k``, from corner k of facet t to the next: the other half-edge of the
        edge, or ``-1 - s`` on piece s of a curve.
    ring : (3 m,) int64
        Next half-edge of the same piece.
    face : (m,) int64
        Face of each facet.
    face_surface, face_marker, face_region
        As in `SurfaceMesh`.
    segments, segment_curve, segment_first
        Ends, curve and one half-edge of each piece.
    curve_surfaces : (c, 2) int64
    dim, owner : (n,)
        Of each point; see `SurfaceMesh`. -1 for points without facets.
    """

    twin: np.ndarray
    ring: np.ndarray
    face: np.ndarray
    face_surface: np.ndarray
    face_marker: np.ndarray
    face_region: np.ndarray
    segments: np.ndarray
    segment_curve: np.ndarray
    segment_first: np.ndarray
    curve_surfaces: np.ndarray
    dim: np.ndarray
    owner: np.ndarray


def feature_complex(plc: Plc) -> FeatureComplex:
    """Faces, curves and corners of a Plc."""
    twin, ring, first, segments = _sides(plc)
    face, table = _faces(plc, twin)
    is_corner, inner = _corners(plc, twin, ring, first, segments, face)
    curve = _curves(len(plc.points), segments, is_corner)
    dim = np.full(len(plc.points), -1, np.int8)
    used = np.unique(plc.facets)
    dim[used] = 1
    dim[inner] = 2
    dim[is_corner] = 0
    owner = np.full(len(plc.points), -1)
    owner[plc.facets.ravel()] = np.repeat(face, 3)
    on_curve = dim[segments] == 1
    owner[segments[on_curve]] = np.repeat(curve, 2).reshape(-1, 2)[on_curve]
    corners = np.flatnonzero(is_corner)
    owner[corners] = np.arange(len(corners))
    return FeatureComplex(
        twin,
        ring,
        face,
        plc.facet_surface[table],
        plc.facet_marker[table],
        plc.facet_region[table],
        segments,
        curve,
        first,
        _pairs(plc, ring, first, segments, curve),
        dim,
        owner,
    )


def _sides(plc: Plc) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Twins, rings, and the first half-edge and the ends of each piece of a curve."""
    start = plc.facets.ravel()
    end = plc.facets[:, [1, 2, 0]].ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((high, low))
    new = (np.diff(low[order], prepend=-1) != 0) | (np.diff(high[order], prepend=-1) != 0)
    begin = np.flatnonzero(new)
    count = np.diff(np.append(begin, len(order)))
    key = np.column_stack([plc.facet_surface, plc.facet_marker, plc.facet_region])
    one, two = order[begin], order[np.minimum(begin + 1, len(order) - 1)]
    joins = (count == 2) & (key[one // 3] == key[two // 3]).all(axis=1) & (start[one] != start[two])
    twin = np.empty(len(start), np.int64)
    twin[one[joins]], twin[two[joins]] = two[joins], one[joins]
    ring = np.full(len(start), -1)
    pieces = np.flatnonzero(~joins)
    number = np.full(len(begin), -1)
    number[pieces] = np.arange(len(pieces))
    piece = np.repeat(number, count)
    at = np.flatnonzero(piece >= 0)
    twin[order[at]] = -1 - piece[at]
    last = begin + count - 1
    following = np.arange(1, len(order) + 1)
    following[last] = begin
    ring[order[at]] = order[following[at]]
    ends = np.column_stack([low, high])[one[pieces]]
    return twin, ring, one[pieces], ends


def _faces(plc: Plc, twin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Face of each facet, and one facet of each face."""
    inside = np.flatnonzero(twin > np.arange(len(twin)))
    _, face = components(plc.n_facets, inside // 3, twin[inside] // 3)
    _, one = np.unique(face, return_index=True)
    return face, one


def _corners(
    plc: Plc,
    twin: np.ndarray,
    ring: np.ndarray,
    first: np.ndarray,
    segments: np.ndarray,
    face: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Which points are corners, and which lie inside a face."""
    n = len(plc.points)
    degree = np.bincount(segments.ravel(), minlength=n)
    half = np.arange(len(twin))
    # Half-edges that leave one vertex are joined across the triangles' edges: fans.
    inside = np.flatnonzero(twin >= 0)
    following = twin[inside] - twin[inside] % 3 + (twin[inside] % 3 + 1) % 3
    _, fan = components(len(twin), inside, following)
    vertex = plc.facets.ravel()
    _, one = np.unique(fan, return_index=True)
    fans = np.bincount(vertex[one], minlength=n)
    sheets = np.zeros(n, np.int64)
    at_piece = half[twin < 0]
    np.add.at(sheets, vertex[at_piece], 1)
    np.add.at(sheets, plc.facets[:, [1, 2, 0]].ravel()[at_piece], 1)
    corner = (degree != 0) & ((degree != 2) | (sheets != 2 * fans))
    corner |= (degree == 0) & (fans > 1)
    two = np.flatnonzero((degree == 2) & ~corner)
    if len(two):
        corner[two] = _turns(plc, ring, first, segments, face, two)
    inner = (degree == 0) & (fans == 1)
    corner |= inner & _apexes(plc)
    return corner, inner & ~corner


def _turns(
    plc: Plc,
    ring: np.ndarray,
    first: np.ndarray,
    segments: np.ndarray,
    face: np.ndarray,
    two: np.ndarray,
) -> np.ndarray:
    """Which of the points between two pieces lie between different curves, or at a kink."""
    order = np.argsort(segments.ravel(), kind="stable")
    start = np.searchsorted(segments.ravel()[order], two)
    one, other = order[start], order[start + 1]
    away = [plc.points[segments.ravel()[k ^ 1]] - plc.points[two] for k in (one, other)]
    long = [np.sqrt((a**2).sum(axis=1)) for a in away]
    cosine = (away[0] * away[1]).sum(axis=1) / (long[0] * long[1])
    kink = cosine > -np.cos(np.radians(_KINK))
    # The faces around a piece, as a sum of powers that no two different sets share by chance.
    share = np.random.default_rng(0).random(int(face.max()) + 1)
    total = np.zeros(len(first))
    at, going = first.copy(), np.arange(len(first))
    while len(going):
        total[going] += share[face[at[going] // 3]]
        at[going] = ring[at[going]]
        going = going[at[going] != first[going]]
    differ = np.abs(total[one // 2] - total[other // 2]) > 1e-12
    return np.asarray(kink | differ)


def _apexes(plc: Plc) -> np.ndarray:
    """Which points are apexes of cones, where a turned surface has no normal, (n,)."""
    out = np.zeros(len(plc.points), bool)
    surfaces = plc.surfaces
    turned = np.flatnonzero(surfaces.kind[plc.facet_surface] == REVOLVED)
    if not len(turned):
        return out
    pairs = np.unique(
        np.column_stack([plc.facets[turned].ravel(), np.repeat(plc.facet_surface[turned], 3)]),
        axis=0,
    )
    vertex, on = pairs.T
    local = np.einsum("kij,kj->ki", surfaces.inverse[on], plc.points[vertex] - surfaces.offset[on])
    extent = np.abs(surfaces.profile.data[on]).max(axis=1)
    near = np.flatnonzero(np.hypot(local[:, 0], local[:, 1]) < 1e-9 * extent)
    for k in near.tolist():
        step = 1e-4 * extent[k] * np.array([[1.0, 0, 0], [0, 1.0, 0]])
        beside = surfaces.matrix[on[k]] @ (local[k] + step)[..., None]
        which = np.full(2, on[k])
        beside = beside[..., 0] + surfaces.offset[on[k]]
        normal = surfaces.normals(which, surfaces.project(which, beside))
        axis = surfaces.normals(which, np.tile(plc.points[vertex[k]], (2, 1)))[0]
        out[vertex[k]] |= bool(abs((normal @ axis)[0]) < _APEX)
    return out


def _curves(n: int, segments: np.ndarray, is_corner: np.ndarray) -> np.ndarray:
    """Curve of each piece: pieces joined at points that are no corners."""
    if not len(segments):
        return np.zeros(0, np.int64)
    # A corner counts as one vertex a piece, so that nothing is joined there.
    ends = segments.copy()
    flat = ends.reshape(-1)
    at = np.flatnonzero(is_corner[flat])
    flat[at] = n + np.arange(len(at))
    _, label = components(n + len(at), ends[:, 0], ends[:, 1])
    return np.unique(label[ends[:, 0]], return_inverse=True)[1].reshape(-1)


def _pairs(
    plc: Plc, ring: np.ndarray, first: np.ndarray, segments: np.ndarray, curve: np.ndarray
) -> np.ndarray:
    """Two surfaces of each curve, as little parallel as can be; the same twice if it has one."""
    if not len(curve):
        return np.zeros((0, 2), np.int64)
    _, one = np.unique(curve, return_index=True)
    start = first[one]
    middle = plc.points[segments[one]].mean(axis=1)
    own = plc.facet_surface[start // 3]
    pairs = np.column_stack([own, own])
    normal = plc.surfaces.normals(own, middle)
    best = np.full(len(one), 1.0)
    at, going = ring[start], np.arange(len(one))
    going = going[at != start]
    while len(going):
        other = plc.facet_surface[at[going] // 3]
        cosine = np.abs((normal[going] * plc.surfaces.normals(other, middle[going])).sum(axis=1))
        better = (other != own[going]) & ((cosine < best[going]) | (pairs[going, 1] == own[going]))
        pairs[going[better], 1] = other[better]
        best[going[better]] = cosine[better]
        at[going] = ring[at[going]]
        going = going[at[going] != start[going]]
    return pairs

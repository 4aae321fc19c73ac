"""The mesh of a solid's boundary: what every mesher of volumes starts from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surfaces import Surfaces

CORNER, ON_CURVE, ON_FACE = 0, 1, 2

_STEPS = 12

#: Normals whose cross product is shorter count as parallel: where surfaces touch, a step along
#: the touching is ill-defined and stays out.
_PARALLEL = 1e-4


@dataclass(frozen=True, eq=False)
class SurfaceMesh:
    """Triangles on the exact surfaces of a `Plc`, conforming along its feature curves.

    A face is a connected part of the boundary on one surface, with one entry of names, between the
    same regions. A curve is a piece of the faces' boundary between two corners, or closed.

    Attributes
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int64
        Counterclockwise seen from outside their first region.
    face : (m,) int64
        Face of each triangle.
    face_surface, face_marker : (f,) int64
        Into ``plc.surfaces`` and ``plc.boundary_names``.
    face_region : (f, 2) int64
        Regions behind and in front of each face, -1 outside.
    segments : (k, 2) int64
        Pieces of the curves: edges of triangles that no swap may remove.
    segment_curve : (k,) int64
    curve_surfaces : (c, 2) int64
        Two exact surfaces each curve lies on; the same twice if there is only one.
    point_dim : (n,) int8
        0 at a corner, 1 on a curve, 2 inside a face.
    point_owner : (n,) int64
        Number of the corner, the curve or the face.
    plc : Plc
        Names, regions, exact surfaces and oracle.
    """

    points: np.ndarray
    triangles: np.ndarray
    face: np.ndarray
    face_surface: np.ndarray
    face_marker: np.ndarray
    face_region: np.ndarray
    segments: np.ndarray
    segment_curve: np.ndarray
    curve_surfaces: np.ndarray
    point_dim: np.ndarray
    point_owner: np.ndarray
    plc: Plc

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def n_triangles(self) -> int:
        """Number of triangles."""
        return len(self.triangles)

    @property
    def marker(self) -> np.ndarray:
        """Entry of ``plc.boundary_names`` of each triangle, (m,)."""
        return np.asarray(self.face_marker[self.face])

    @property
    def region(self) -> np.ndarray:
        """Regions behind and in front of each triangle, (m, 2)."""
        return np.asarray(self.face_region[self.face])

    def project(self, which: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Places near `points` (k, 3) where the mesh's points `which` (k,) may lie.

        Points of faces go to their surface, points of curves to both surfaces, corners stay.
        """
        out = np.array(points, dtype=float)
        dim, owner = self.point_dim[which], self.point_owner[which]
        corner = dim == CORNER
        out[corner] = self.points[which[corner]]
        inside = np.flatnonzero(dim == ON_FACE)
        on = self.face_surface[owner[inside]]
        out[inside] = self.plc.surfaces.project(on, out[inside])
        along = np.flatnonzero(dim == ON_CURVE)
        pairs = self.curve_surfaces[owner[along]]
        out[along] = project_on_pairs(self.plc.surfaces, pairs, out[along])
        return out


def project_on_pairs(surfaces: Surfaces, pairs: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Points of the common curves of pairs of surfaces (k, 2) near `points` (k, 3).

    Newton's method with the smallest step; where surfaces touch, only along their normal.
    """
    out = np.array(points, dtype=float)
    if not len(out):
        return out
    first, second = pairs.T
    going = np.arange(len(out))
    for _ in range(_STEPS):
        place = out[going]
        move = _step(surfaces, first[going], second[going], place)
        out[going] = place + move
        size = np.abs(move).max(axis=1)
        going = going[size > 4.0 * np.spacing(np.abs(place).max(axis=1))]
        if not len(going):
            break
    return out


def _step(surfaces: Surfaces, a: np.ndarray, b: np.ndarray, place: np.ndarray) -> np.ndarray:
    """The least motion onto both tangent planes, (k, 3)."""
    normals, gaps = [], []
    for on in (a, b):
        foot = surfaces.project(on, place)
        normal = surfaces.normals(on, foot)
        normals.append(normal)
        gaps.append(((foot - place) * normal).sum(axis=1))
    cosine = (normals[0] * normals[1]).sum(axis=1)
    sine = 1.0 - cosine**2
    touching = sine < _PARALLEL**2
    sine = np.where(touching, 1.0, sine)
    x = np.where(touching, gaps[0], (gaps[0] - cosine * gaps[1]) / sine)
    y = np.where(touching, 0.0, (gaps[1] - cosine * gaps[0]) / sine)
    # Surfaces that touch: half-way between the two, with the second seen along the first's normal.
    x = np.where(touching & (a != b), 0.5 * (gaps[0] + np.sign(cosine) * gaps[1]), x)
    return x[:, None] * normals[0] + y[:, None] * normals[1]

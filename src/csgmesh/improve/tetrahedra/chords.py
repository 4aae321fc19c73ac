"""How far the surface's triangles stray from the exact surfaces, and how far they may."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.domain.surfaces import PLANE

#: Triangles keep this cosine to the exact normals at their corners: 60 degrees.
UPRIGHT = 0.5
#: Squared sine of the smallest angle that a moved triangle may have, 25 degrees, unless it had a
#: smaller one.
THIN = 0.1786


class Chords:
    """Triangles of a surface mesh under improvement, with exact normals at their corners.

    The height of the exact surface over the middle of a chord is that of a parabola whose tangents
    at the ends turn as the exact normals do.

    Attributes
    ----------
    triangles, face
        As in a `SurfaceMesh`.
    normals : (m, 3, 3) float64
        Of the face's surface, at each corner.
    limit : (f,) float64
        How far chords of each face may stray: the domain's deviation, or what was there before.
    """

    def __init__(self, triangles: np.ndarray, face: np.ndarray, surface: SurfaceMesh) -> None:
        self.triangles = triangles
        self.face = face
        self.surface = surface
        surfaces = surface.plc.surfaces
        on = surface.face_surface[face]
        self.normals = np.repeat(surfaces.plane_normals[on][:, None], 3, axis=1)
        self.limit = np.full(len(surface.face_surface), surface.plc.deviation)
        bent = np.flatnonzero(surfaces.kind[on] != PLANE)
        if len(bent):
            self.normals[bent] = own = self._exact_normals(triangles[bent], on[bent])
            start, end = triangles[bent], triangles[bent][:, [1, 2, 0]]
            points = surface.points
            heights = _heights(points[start], points[end], own, own[:, [1, 2, 0]])
            np.maximum.at(self.limit, face[bent], heights.max(axis=1))

    def _exact_normals(self, triangles: np.ndarray, on: np.ndarray) -> np.ndarray:
        """Normals at the corners of triangles (m, 3) of surfaces `on` (m,), each found once."""
        points = self.surface.points
        n = max(len(points), 1)
        keys, where = np.unique(np.repeat(on, 3) * n + triangles.ravel(), return_inverse=True)
        normals = self.surface.plc.surfaces.normals(keys // n, points[keys % n])
        return np.asarray(normals[where].reshape(-1, 3, 3))

    def refused(
        self,
        triangles: np.ndarray,
        face: np.ndarray,
        normals: np.ndarray,
        points: np.ndarray,
        wishing: np.ndarray,
        places: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Which of some moves leave the surface too far off.

        Parameters
        ----------
        triangles, face, normals
            Of the part of the surface under work, numbered as `points`.
        points : (n, 3) float64
        wishing : (k,) int64
            Points that want to move, no two of one triangle.
        places : (k, 3) float64
            Where to, on the exact surface.

        Returns
        -------
        (k,) bool
            Moves that are refused.
        (c,) int64, (c,) int64, (c, 3) float64
            Row and column of each corner that a move concerns, and the normal there after it.
        """
        number = np.full(len(points), -1)
        number[wishing] = np.arange(len(wishing))
        row, column = np.nonzero(number[triangles] >= 0)
        move = number[triangles[row, column]]
        surface = self.surface
        new = surface.plc.surfaces.normals(surface.face_surface[face[row]], places[move])
        others = [(column + k) % 3 for k in (1, 2)]
        ends = [points[triangles[row, other]] for other in others]
        refused = np.zeros(len(wishing), bool)
        for other, end in zip(others, ends, strict=True):
            there = normals[row, other]
            before = _heights(points[wishing[move]], end, normals[row, column], there)
            after = _heights(places[move], end, new, there)
            refused[move[after > np.maximum(before, self.limit[face[row]])]] = True
        across, sharpest = _corners(places[move], *ends)
        size = np.sqrt((across**2).sum(axis=1))
        refused[move[(across * new).sum(axis=1) <= UPRIGHT * size]] = True
        before = _corners(points[wishing[move]], *ends)[1]
        refused[move[sharpest < np.minimum(before, THIN)]] = True
        return refused, row, column, new


def _corners(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normals of triangles (k, 3), twice their area long, and squared sines of smallest angles."""
    across = np.cross(b - a, c - a)
    lengths = np.stack([((p - q) ** 2).sum(axis=1) for p, q in ((b, a), (c, b), (a, c))])
    # The smallest angle is opposite the shortest edge.
    longer = lengths.prod(axis=0) / lengths.min(axis=0)
    return across, (across**2).sum(axis=1) / longer


def _heights(
    start: np.ndarray, end: np.ndarray, normal: np.ndarray, other: np.ndarray
) -> np.ndarray:
    return np.asarray(np.abs(((other - normal) * (end - start)).sum(axis=-1)) / 8.0)

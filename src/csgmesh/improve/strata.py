"""The boundary of a mesh of tetrahedra as a `SurfaceMesh`: which points may slide, and where."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import CORNER, ON_CURVE, ON_FACE, SurfaceMesh
from csgmesh.domain.surfaces import Surfaces
from csgmesh.improve.exact_surfaces import ExactSurfaces
from csgmesh.mesh import Mesh


def strata_of(mesh: Mesh) -> tuple[SurfaceMesh, np.ndarray]:
    """What the points of a mesh's triangles lie on.

    Facets with the same names and regions on the same exact surface are one face, whether they hang
    together or not. Points on facets without an exact surface count as corners, and so do those
    where more than two faces meet and those of curves that lie on one surface only.

    Parameters
    ----------
    mesh : Mesh
        Of tetrahedra, with triangles for facets.

    Returns
    -------
    surface : SurfaceMesh
    number : (n_points,) int64
        New number of each point of the mesh; those of the surface come first.
    """
    rows = mesh.facets.get("triangle", np.zeros((0, 3), np.int64))
    plc, on = _known_surfaces(mesh, rows)
    n_exact = len(plc.surfaces) - len(rows)
    marker = mesh.facet_marker.get("triangle", np.zeros(0, np.int64))
    region = mesh.facet_region.get("triangle", np.zeros((0, 2), np.int64))
    faces, face = np.unique(np.column_stack([on, marker, region]), axis=0, return_inverse=True)
    face = face.reshape(-1)
    fixed = mesh.point_marker >= 0
    first = np.unique(np.concatenate([rows.ravel(), np.flatnonzero(fixed)]))
    number = np.full(mesh.n_points, -1)
    number[first] = np.arange(len(first))
    number[number < 0] = np.arange(len(first), mesh.n_points)
    triangles = number[rows]
    segments, beside = _segments(triangles, face)
    pairs = np.sort(faces[:, 0][beside], axis=1)
    pairs[beside.min(axis=1) < 0] = 0
    curves, curve = np.unique(pairs, axis=0, return_inverse=True)
    curve = curve.reshape(-1)
    dim, owner = _dimensions(len(first), triangles, face, segments, curve)
    dim[fixed[first]] = CORNER
    dim[segments[(curves[:, 0] == curves[:, 1])[curve]]] = CORNER
    dim[triangles[on >= n_exact]] = CORNER
    owner[dim == CORNER] = np.arange((dim == CORNER).sum())
    surface = SurfaceMesh(
        points=mesh.points[first],
        triangles=triangles,
        face=face,
        face_surface=faces[:, 0],
        face_marker=faces[:, 1],
        face_region=faces[:, 2:],
        segments=segments,
        segment_curve=curve,
        curve_surfaces=curves,
        point_dim=dim,
        point_owner=owner,
        plc=plc,
    )
    return surface, number


def _known_surfaces(mesh: Mesh, rows: np.ndarray) -> tuple[Plc, np.ndarray]:
    """The mesh's domain with the plane of each facet added, and the surface of each facet.

    A facet that is on no exact surface is on its own plane.
    """
    a, b, c = (mesh.points[rows[:, k]] for k in range(3))
    planes = Surfaces.planes(a, np.cross(b - a, c - a))
    domain: object = mesh.domain
    if isinstance(domain, Plc):
        known = {field.name: getattr(domain, field.name) for field in fields(domain)}
        on = ExactSurfaces.of(mesh).facet_surface.get("triangle", np.zeros(0, np.int64))
    else:
        known = {"deviation": 0.0, "surfaces": Surfaces.empty()}
        on = np.full(len(rows), -1)
    n_exact = len(known["surfaces"])
    known["surfaces"] = Surfaces.concatenate([known["surfaces"], planes])
    missing = {field.name: None for field in fields(Plc) if field.name not in known}
    on = np.where(on < 0, n_exact + np.arange(len(rows)), on)
    return Plc.build(**known, **missing), on


def _segments(triangles: np.ndarray, face: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges but those between two triangles of one face, (k, 2), and their faces, -1 for many."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, of = edges[order], np.repeat(face, 3)[order]
    start = np.flatnonzero((np.diff(edges, axis=0, prepend=-1) != 0).any(axis=1))
    count = np.diff(np.append(start, len(edges)))
    last = np.minimum(start + 1, len(of) - 1)
    beside = np.column_stack([of[start], of[last]])
    beside[count != 2] = -1
    sharp = (count != 2) | (beside[:, 0] != beside[:, 1])
    return edges[start][sharp], beside[sharp]


def _dimensions(
    n: int, triangles: np.ndarray, face: np.ndarray, segments: np.ndarray, curve: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Dimension of the stratum of each of n points, and the face or curve."""
    dim, owner = np.full(n, CORNER, np.int8), np.zeros(n, np.int64)
    dim[triangles] = ON_FACE
    owner[triangles] = face[:, None]
    degree = np.bincount(segments.ravel(), minlength=n)
    low, high = np.full(n, len(curve)), np.full(n, -1)
    for end in segments.T:
        np.minimum.at(low, end, curve)
        np.maximum.at(high, end, curve)
    along = (degree == 2) & (low == high)
    dim[degree > 0] = CORNER
    dim[along] = ON_CURVE
    owner[along] = low[along]
    return dim, owner

"""Halving edges of a surface mesh keeps it closed, on its exact surfaces and curves."""

from __future__ import annotations

import numpy as np

import csgmesh as cm
from csgmesh.domain.surface_mesh import ON_CURVE
from csgmesh.meshers.surface import surface_mesh
from csgmesh.meshers.surface.halving import halve_longest


def test_halves_lie_on_surfaces_and_curves() -> None:
    lens = cm.evaluate(cm.Ball((0, 0, 0), 1) & cm.HalfSpace((0, 0, 0.3), (0, 0, 1)))
    whole = surface_mesh(lens, lambda points: np.full(len(points), 0.3))
    finer = halve_longest(whole, np.arange(whole.n_triangles))
    new = np.arange(whole.n_points, finer.n_points)
    assert len(new) > 20
    assert (finer.point_dim[new] == ON_CURVE).any()
    edges = np.sort(finer.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 2).all()
    on = np.repeat(finer.face_surface[finer.face], 3)
    corners = finer.points[finer.triangles].reshape(-1, 3)
    assert lens.surfaces.distance(on, corners).max() < 1e-12
    # The rim is one closed curve of edges.
    rim = np.sort(finer.segments, axis=1)
    assert (np.bincount(rim.ravel())[np.unique(rim)] == 2).all()
    assert {tuple(e) for e in rim.tolist()} <= {tuple(e) for e in edges.tolist()}
    area = np.cross(
        finer.points[finer.triangles[:, 1]] - finer.points[finer.triangles[:, 0]],
        finer.points[finer.triangles[:, 2]] - finer.points[finer.triangles[:, 0]],
    )
    outwards = lens.surfaces.normals(finer.face_surface[finer.face], corners[::3])
    assert ((area * outwards).sum(axis=1) > 0.0).all()


def test_a_domain_is_evaluated_again_with_finer_facets_at_places() -> None:
    domain = cm.evaluate(cm.Ball((0, 0, 0), 1) | cm.Ball((3, 0, 0), 1))
    finer = domain.finer(np.array([[0.0, 0.0, 1.0]]))
    count = np.bincount(domain.facet_surface), np.bincount(finer.facet_surface)
    assert count[1][0] > 8 * count[0][0]
    assert count[1][1] == count[0][1]
    assert finer.names == domain.names

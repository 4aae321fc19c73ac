"""No facet has turned over where exact surfaces cross beside a vertex of the facets."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.boundary.patchwork import Patchwork


@pytest.mark.parametrize("centre", [(0.66, 0.97, 0.4), (0.96, 0.66, 0.98)])
def test_no_facet_of_two_balls_is_turned_over(centre: tuple[float, float, float]) -> None:
    plc = cm.evaluate(cm.Ball((0, 0, 0), 1) | cm.Ball(centre, 0.8))
    corner = plc.points[plc.facets]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    outwards = plc.surfaces.normals(plc.facet_surface, corner.mean(axis=1))
    assert ((area * outwards).sum(axis=1) > 0.0).all()
    edges = np.sort(plc.facets[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    on = plc.surfaces.distance(np.repeat(plc.facet_surface, 3), corner.reshape(-1, 3))
    assert np.abs(on).max() < 1e-12


def test_contractions_keep_curves_and_surfaces() -> None:
    # Two squares with a common side 1-2-3, each a fan about its middle.
    one = [(0, 4, 5), (0, 5, 1), (0, 1, 2), (0, 2, 3), (0, 3, 4)]
    two = [(8, 3, 2), (8, 2, 1), (8, 1, 6), (8, 6, 7), (8, 7, 3)]
    triangles = np.array([*one, *two])
    work = Patchwork(triangles, np.repeat([0, 1], 5), np.ones(9, bool))
    assert work.is_inside(0) and not work.is_inside(2)
    # A vertex of the curve goes along it, not into a face; one inside a face goes anywhere.
    assert work.contracted(2, 0) is None
    assert work.contracted(1, 2) is None
    along = work.contracted(2, 1)
    assert along == [(3, (0, 1, 3)), (5, (8, 3, 1))]
    work.replace(work.beside(2, 1), along)
    assert sorted(work.rows) == [0, 1, 3, 4, 5, 7, 8, 9]
    assert work.neighbours(1) == [0, 3, 5, 6, 8]
    assert work.flipped(1, 3) is None
    assert work.flipped(0, 1) == [(1, (5, 1, 3)), (3, (5, 3, 0))]

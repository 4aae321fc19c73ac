"""Touchings are found however few pairs of facets are looked at."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.boundary import touching

#: Solids whose leaves touch, coincide, nest or cross, some of them close to a corner of a facet.
SOLIDS = {
    "a ball on an edge of a box": cm.Box((0, 0, 0), (2, 2, 2)) | cm.Ball((1, -1, 2), 1),
    "a cone that stands on a ball": cm.Ball((0, 0, 0), 1) | cm.Cone((0, 0, 2), (0, 0, 1), 0.5, 0),
    "a cylinder between two walls": cm.union(
        cm.Box((0, 0, 0), (1, 3, 3)),
        cm.Box((3, 0, 0), (4, 3, 3)),
        cm.Cylinder((1, 1.5, 1.5), (3, 1.5, 1.5), 1),
    ),
    "a box turned about an edge in common": cm.Box((0, 0, 0), (1, 1, 1))
    | cm.Box((0, 0, 0), (1, 1, 1)).rotate(135, axis=(0, 0, 1), center=(1, 0, 0)),
    "a torus around a cylinder": cm.Torus((0, 0, 0), (0, 0, 1), 1.5, 0.5)
    | cm.Cylinder((0, 0, -1), (0, 0, 1), 1),
    "bores that end at one another": cm.Box((0, 0, 0), (4, 4, 2))
    - cm.Cylinder((2, 2, -1), (2, 2, 3), 1)
    - cm.Cylinder((-1, 2, 1), (1, 2, 1), 0.5),
    "one material inside another": cm.Regions(
        {
            "core": cm.Ball((0, 0, 0), 1) & cm.Box((-2, -2, 0), (2, 2, 2)),
            "shell": cm.Box((-1, -1, 0), (1, 1, 1)),
        }
    ),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_nothing_that_touches_is_passed_over(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    quick = cm.evaluate(SOLIDS[name], deviation=0.02)
    monkeypatch.setattr(touching, "contacts", lambda sides, known, snap: _Everything(sides))
    slow = cm.evaluate(SOLIDS[name], deviation=0.02)
    assert np.array_equal(quick.points, slow.points)
    assert np.array_equal(quick.facets, slow.facets)
    assert np.array_equal(quick.facet_marker, slow.facet_marker)


class _Everything:
    """All facets may touch all leaves."""

    def __init__(self, sides: object) -> None:
        self.facets = np.arange(len(sides.triangles))

    def among(self, pairs: np.ndarray) -> np.ndarray:
        return pairs

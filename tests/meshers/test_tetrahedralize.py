"""Tetrahedra fill what a surface bounds, and every triangle of it is one of their faces."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh import kernels
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.meshers.tetrahedra import Tetrahedra, tetrahedralize
from tests.meshers.plc_surfaces import surface_of

NONE = np.zeros((0, 3))
CUBE = cm.Box((0, 0, 0), (1, 1, 1))
PLATE = cm.Box((0, 0, 0), (1, 1, 0.02))
FRAME = (CUBE - cm.Box((0.3, 0.3, -1), (0.7, 0.7, 2))).rotate(37, axis=(1, 2, 3))
WEDGE = cm.Polygon([(0, 0), (1, 0), (1, np.tan(np.radians(10)))])

SOLIDS = {
    "box": (CUBE, 0.25),
    "box of twelve triangles": (CUBE, 9.0),
    "tilted frame": (
        (CUBE - cm.Box((0.3, 0.3, -1), (0.7, 0.7, 2))).rotate(37, axis=(1, 2, 3)),
        0.2,
    ),
    "L": (cm.Box((0, 0, 0), (2, 2, 1)) - cm.Box((1, 1, -1), (3, 3, 3)), 0.3),
    "cube less ball": (CUBE - cm.Ball((0.5, 0.5, 0.5), 0.3), 0.2),
    "ball touching from inside": (CUBE - cm.Ball((0.5, 0.5, 0.5), 0.5), 0.2),
    "thin plate": (cm.Box((0, 0, 0), (1, 1, 0.01)), 0.1),
    "wedge of ten degrees": (cm.Extrude(WEDGE, 1), 0.15),
    "cube less a ball at a corner": (CUBE - cm.Ball((0, 0, 0), 0.5), 0.2),
    "thin plate with a bore": (PLATE - cm.Cylinder((0.5, 0.5, -1), (0.5, 0.5, 1), 0.2), 0.1),
    "torus": (cm.Torus((0, 0, 0), (0, 0, 1), 1, 0.3), 0.3),
    "two balls": (cm.Ball((0, 0, 0), 1) | cm.Ball((2.5, 0, 0), 1), 0.4),
    "thin shell": (cm.Ball((0, 0, 0), 1) - cm.Ball((0, 0, 0), 0.95), 0.4),
}


def volumes(cells: Tetrahedra) -> np.ndarray:
    """Volume of each region."""
    a, b, c, d = (cells.points[cells.tets[:, k]] for k in range(4))
    each = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    return np.bincount(cells.region, each)


def face_counts(cells: Tetrahedra) -> dict[tuple[int, ...], int]:
    """How many tetrahedra have each face."""
    rows = np.sort(cells.tets, axis=1)
    sides = np.vstack([np.delete(rows, k, axis=1) for k in range(4)])
    unique, counts = np.unique(sides, axis=0, return_counts=True)
    return dict(zip(map(tuple, unique.tolist()), counts.tolist(), strict=True))


def assert_conforming(cells: Tetrahedra, surface: SurfaceMesh) -> None:
    assert not len(cells.missing)
    assert (kernels.tetra_orientations(cells.points, cells.tets) > 0).all()
    counts = face_counts(cells)
    assert max(counts.values()) <= 2
    outer = (surface.face_region[cells.face] < 0).any(axis=1)
    wanted = np.where(outer, 1, 2).tolist()
    walls = [tuple(sorted(t)) for t in cells.triangles.tolist()]
    assert [counts.get(t, 0) for t in walls] == wanted
    assert sum(count == 1 for count in counts.values()) == int(outer.sum())
    assert volumes(cells) == pytest.approx(surface.plc.volumes(), rel=1e-12)


@pytest.mark.parametrize("name", SOLIDS)
def test_the_surface_is_there_and_the_volume_is_right(name: str) -> None:
    shape, size = SOLIDS[name]
    surface = surface_of(cm.evaluate(shape), size)
    assert_conforming(tetrahedralize(surface, NONE), surface)


def test_points_inside_become_vertices() -> None:
    surface = surface_of(cm.evaluate(CUBE), 0.2)
    inner = np.random.default_rng(3).uniform(0.1, 0.9, (2000, 3))
    cells = tetrahedralize(surface, inner)
    assert_conforming(cells, surface)
    assert (np.unique(cells.tets) == np.arange(len(cells.points))).all()
    others = np.random.default_rng(4).integers(0, len(cells.points), len(cells.tets))
    assert (kernels.in_spheres(cells.points, cells.tets, others) <= 0).all()


def test_equal_points_are_an_error_with_their_place() -> None:
    surface = surface_of(cm.evaluate(CUBE))
    with pytest.raises(cm.MeshingError, match=r"points 8 and 9 are both \(0.5, 0.25, 0.5\)"):
        tetrahedralize(surface, np.array([[0.5, 0.25, 0.5], [0.5, 0.25, 0.5]]))

"""Tetrahedra fill what a surface bounds, and every triangle of it is one of their faces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from plc_surfaces import surface_of

import csgmesh as cm
from csgmesh import kernels
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.meshers.tetrahedra import Tetrahedra, tetrahedralize

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


def assert_conforming(
    cells: Tetrahedra, surface: SurfaceMesh, wanted_volumes: np.ndarray | None = None
) -> None:
    assert not len(cells.missing)
    assert (kernels.tetra_orientations(cells.points, cells.tets) > 0).all()
    counts = face_counts(cells)
    assert max(counts.values()) <= 2
    outer = (surface.face_region[cells.face] < 0).any(axis=1)
    wanted = np.where(outer, 1, 2).tolist()
    walls = [tuple(sorted(t)) for t in cells.triangles.tolist()]
    assert [counts.get(t, 0) for t in walls] == wanted
    assert sum(count == 1 for count in counts.values()) == int(outer.sum())
    if wanted_volumes is None:
        wanted_volumes = surface.plc.volumes()
    assert volumes(cells) == pytest.approx(wanted_volumes, rel=1e-12)


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


def lattice(n: int, low: np.ndarray, side: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners and centres of n cubes along each axis, and the tetrahedra between two centres."""
    corner = np.indices((n + 1,) * 3).reshape(3, -1).T
    centre = np.indices((n,) * 3).reshape(3, -1).T
    tets = []
    for axis in range(3):
        one = centre[centre[:, axis] < n - 1]
        two = one + np.eye(3, dtype=int)[axis]
        u, v = np.eye(3, dtype=int)[[(axis + 1) % 3, (axis + 2) % 3]]
        square = [row @ [(n + 1) ** 2, n + 1, 1] for row in (two, two + u, two + u + v, two + v)]
        ends = [row @ [n**2, n, 1] + (n + 1) ** 3 for row in (one, two)]
        tets += [np.column_stack([square[k - 1], square[k], *ends]) for k in range(4)]
    points, rows = np.vstack([corner, centre + 0.5]) * side + low, np.vstack(tets)
    inverted = kernels.tetra_orientations(points, rows) < 0
    rows[inverted] = rows[inverted][:, [1, 0, 2, 3]]
    return points, rows


@pytest.mark.parametrize(("gap", "share"), [(0.12, 1.0), (0.02, 0.1)])
def test_lattice_tetrahedra_are_kept_where_they_are_delaunay(gap: float, share: float) -> None:
    surface = surface_of(cm.evaluate(CUBE), 0.2)
    inner, kept = lattice(6, np.full(3, gap), (1 - 2 * gap) / 6)
    cells = tetrahedralize(surface, inner, kept)
    assert_conforming(cells, surface)
    assert (np.unique(cells.tets) == np.arange(len(cells.points))).all()
    rows = {tuple(t) for t in np.sort(cells.tets, axis=1).tolist()}
    is_there = [tuple(sorted(t)) in rows for t in (kept + surface.n_points).tolist()]
    assert np.mean(is_there) >= share
    for k in range(3):
        others = np.random.default_rng(k).integers(0, len(cells.points), len(cells.tets))
        assert (kernels.in_spheres(cells.points, cells.tets, others) <= 0).all()


def nested(outer: SurfaceMesh, core: SurfaceMesh) -> SurfaceMesh:
    """One solid within another one, as two regions."""
    n, f = outer.n_points, len(outer.face_region)
    return replace(
        outer,
        points=np.vstack([outer.points, core.points]),
        triangles=np.vstack([outer.triangles, core.triangles + n]),
        face=np.append(outer.face, core.face + f),
        face_region=np.vstack([outer.face_region, np.tile([1, 0], (len(core.face_region), 1))]),
        segments=np.vstack([outer.segments, core.segments + n]),
    )


@pytest.mark.parametrize("keeps", [False, True])
def test_tetrahedra_take_the_region_around_them(keeps: bool) -> None:
    core = surface_of(cm.evaluate(cm.Ball((0, 0, 0), 1)), 0.3)
    surface = nested(
        surface_of(cm.evaluate(cm.Box((-1.5, -1.5, -1.5), (3.5, 1.5, 1.5))), 0.4), core
    )
    one, kept = lattice(5, np.full(3, -0.5), 0.2)
    inner = np.vstack([one, one + np.array([2.3, 0, 0])])
    kept = np.vstack([kept, kept + len(one)])
    cells = tetrahedralize(surface, inner, kept if keeps else None)
    ball = core.plc.volumes()[0]
    assert_conforming(cells, surface, np.array([45.0 - ball, ball]))


def test_rounding_leaves_no_flat_tetrahedra_on_flat_faces() -> None:
    shape, size = SOLIDS["cube less ball"]
    surface = surface_of(cm.evaluate(shape), size)
    cells = tetrahedralize(surface, NONE)
    a, b, c, d = (cells.points[cells.tets[:, k]] for k in range(4))
    # Facets of a turned profile are flat quads, cut in two.
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) > 1e-7).all()


def test_what_no_flips_recover_is_told_with_its_place() -> None:
    # A twisted prism (Schoenhardt 1928): no tetrahedra fill it without a point inside.
    turn = np.radians([0, 120, 240])
    low = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(3)])
    high = np.column_stack([np.cos(turn - 0.5), np.sin(turn - 0.5), np.ones(3)])
    sides = [[k, (k + 1) % 3, 3 + k] for k in range(3)]
    sides += [[(k + 1) % 3, 3 + (k + 1) % 3, 3 + k] for k in range(3)]
    triangles = np.array([[0, 2, 1], [3, 4, 5], *sides])
    edges = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    surface = replace(
        surface_of(cm.evaluate(CUBE)),
        points=np.vstack([low, high]),
        triangles=triangles,
        face=np.arange(8),
        face_region=np.tile([0, -1], (8, 1)),
        segments=edges,
    )
    cells = tetrahedralize(surface, NONE)
    assert len(cells.missing)
    assert not len(cells.tets)
    assert cells.places == pytest.approx(surface.points[triangles[cells.missing]].mean(axis=1))


def test_a_surface_with_a_hole_is_an_error_with_its_place() -> None:
    surface = surface_of(cm.evaluate(CUBE))
    open_ = replace(surface, triangles=surface.triangles[1:], face=surface.face[1:])
    with pytest.raises(cm.MeshingError, match=r"does not part its regions near \("):
        tetrahedralize(open_, NONE)


def test_equal_points_are_an_error_with_their_place() -> None:
    surface = surface_of(cm.evaluate(CUBE))
    with pytest.raises(cm.MeshingError, match=r"points 8 and 9 are both \(0.5, 0.25, 0.5\)"):
        tetrahedralize(surface, np.array([[0.5, 0.25, 0.5], [0.5, 0.25, 0.5]]))

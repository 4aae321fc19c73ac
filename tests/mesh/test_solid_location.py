"""Finding cells of meshes of space at points, and interpolation."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

import csgmesh as cm
from csgmesh.mesh.solid_location import tetrahedra_of

SWEPT = {
    "wedges": (cm.Extrude(cm.Disk((0, 0), 2) - cm.Disk((0, 0), 1), 0.5), cm.Sweep()),
    "hexahedra": (cm.Extrude(cm.Disk((0, 0), 2), 0.5), cm.Sweep(cm.QuadPairing())),
    "all kinds": (
        cm.Revolve(cm.Polygon([(0, 0), (1, -1), (2, 0), (1, 1)])),
        cm.Sweep(cm.Structured()),
    ),
    "at an axis": (cm.Revolve(cm.Disk((0, 0), 1), 200), cm.Sweep()),
}


def swept(name: str) -> cm.Mesh:
    shape, mesher = SWEPT[name]
    return cm.generate(shape, mesher, size=0.4)


def graded(n: int = 1500) -> cm.Mesh:
    """Tetrahedra of random points, half of them in a corner of a thousandth the size."""
    points = np.random.default_rng(3).random((n, 3))
    points[: n // 2] *= 1e-3
    rows = Delaunay(points).simplices.astype(np.int64)
    a, b, c = (points[rows[:, k]] - points[rows[:, 0]] for k in (1, 2, 3))
    turned = (a * np.cross(b, c)).sum(axis=1) < 0
    rows[turned] = rows[turned][:, [1, 0, 2, 3]]
    return cm.Mesh(points, {"tetra": rows})


def centres(mesh: cm.Mesh) -> np.ndarray:
    return np.concatenate([mesh.points[rows].mean(axis=1) for rows in mesh.cells.values()])


def inside(mesh: cm.Mesh, number: int) -> np.ndarray:
    return np.random.default_rng(number).uniform(
        mesh.points.min(axis=0) - 0.1, mesh.points.max(axis=0) + 0.1, (number, 3)
    )


def test_centres_lie_in_their_own_cells() -> None:
    mesh = graded()
    found = mesh.locate(centres(mesh))
    # Slivers on the hull are thinner than the rounding of their centres.
    assert (found == np.arange(mesh.n_cells)).mean() > 0.999


@pytest.mark.parametrize("name", SWEPT)
def test_centres_and_vertices_of_cells_of_any_kind(name: str) -> None:
    mesh = swept(name)
    assert (mesh.locate(centres(mesh)) == np.arange(mesh.n_cells)).all()
    lowest, before = np.full(mesh.n_points, mesh.n_cells), 0
    for rows in mesh.cells.values():
        owner = np.repeat(before + np.arange(len(rows)), rows.shape[1])
        np.minimum.at(lowest, rows.ravel(), owner)
        before += len(rows)
    assert (mesh.locate(mesh.points) == lowest).all()


@pytest.mark.parametrize("name", SWEPT)
def test_every_place_inside_is_found_and_none_outside(name: str) -> None:
    """Where all faces are flat but those on the boundary: the cells fill what the facets bound."""
    mesh = swept(name)
    points = inside(mesh, 20_000)
    share = (mesh.locate(points) >= 0).mean()
    box = np.prod(np.ptp(mesh.points, axis=0) + 0.2)
    assert share == pytest.approx(cm.quality(mesh).total_volume / box, abs=0.01)
    assert (mesh.locate(points[:100] + 1e3) == -1).all()
    tets, owner = tetrahedra_of(mesh.cells)
    a, b, c = (mesh.points[tets[:, k]] - mesh.points[tets[:, 0]] for k in (1, 2, 3))
    volume = np.bincount(owner, (a * np.cross(b, c)).sum(axis=1) / 6)
    np.testing.assert_allclose(volume, cm.quality(mesh).volume, rtol=0.1)


def test_points_on_faces_are_inside_and_points_beside_are_not() -> None:
    mesh = cm.Mesh(
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)],
        {"tetra": [[0, 1, 2, 3], [1, 2, 3, 4]]},
    )
    below = np.nextafter(0.0, -1.0)
    queries = [
        (0.25, 0.25, 0.0),
        (0.25, 0.25, below),
        (0.25, 0.25, 0.5),
        (0.5, 0.5, 0.5),
        (1, 1, 1),
        (np.nan, 0, 0),
        (np.inf, 0, 0),
    ]
    assert mesh.locate(queries).tolist() == [0, -1, 0, 1, 1, -1, -1]
    assert mesh.locate((0.1, 0.1, 0.1)).tolist() == [0]
    assert mesh.locate(np.zeros((0, 3))).tolist() == []


coordinate = st.integers(-3, 3)


@given(st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=5, max_size=5))
def test_the_same_as_rational_arithmetic(rows: list[tuple[int, int, int]]) -> None:
    """Points of a small grid, scaled so that products are rounded: ties abound."""
    points = np.array(rows, float) * 0.1
    exact = [[Fraction(x) for x in row] for row in points.tolist()]

    def volume(a, b, c, d) -> Fraction:
        u, v, w = ([q - p for p, q in zip(a, other, strict=True)] for other in (b, c, d))
        return sum(
            u[i] * (v[j] * w[k] - v[k] * w[j]) for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        )

    corners, query = exact[:4], exact[4]
    whole = volume(*corners)
    if whole == 0:
        return
    order = next(p for p in permutations(range(4)) if volume(*(corners[k] for k in p)) > 0)
    mesh = cm.Mesh(points[:4], {"tetra": [order]})
    sides = [
        volume(*(query if k == corner else corners[order[k]] for k in range(4)))
        for corner in range(4)
    ]
    assert mesh.locate(points[4:])[0] == (0 if min(sides) >= 0 else -1)


@pytest.mark.parametrize("name", SWEPT)
def test_linear_functions_are_interpolated_exactly(name: str) -> None:
    mesh, points = swept(name), inside(swept(name), 5000)
    slopes = np.array([(1.0, 2), (3, -1), (0.5, 4)])
    found = mesh.interpolate(mesh.points @ slopes + 7, points)
    is_inside = mesh.locate(points) >= 0
    assert (np.isnan(found).any(axis=1) == ~is_inside).all()
    wanted = points[is_inside] @ slopes + 7
    np.testing.assert_allclose(found[is_inside], wanted, rtol=0, atol=1e-12)


def test_trilinear_functions_on_boxes_are_interpolated_exactly() -> None:
    def f(p: np.ndarray) -> np.ndarray:
        x, y, z = p.T
        return 1 + x * y * z + x * y - 2 * y * z

    box = cm.Box((0, 0, 0), (2, 1, 1))
    hexahedra = cm.generate(box, cm.Sweep(cm.Structured(), layers=3), size=0.4)
    points = np.random.default_rng(0).random((1000, 3))
    np.testing.assert_allclose(hexahedra.interpolate(f(hexahedra.points), points), f(points))
    wedges = cm.generate(box, cm.Sweep(layers=3), size=0.4)

    def g(p: np.ndarray) -> np.ndarray:
        return (1 + 2 * p[:, 0] - p[:, 1]) * p[:, 2]

    np.testing.assert_allclose(wedges.interpolate(g(wedges.points), points), g(points))


def test_values_at_vertices_come_back() -> None:
    for name in SWEPT:
        mesh = swept(name)
        values = np.random.default_rng(1).random(mesh.n_points)
        np.testing.assert_allclose(mesh.interpolate(values, mesh.points), values, atol=1e-9)


def test_curved_cells_count_by_their_corners() -> None:
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    curved = cm.elevate(cm.Mesh(corners, {"tetra": [[0, 1, 2, 3]]}))
    values = curved.points @ [1.0, 2, 3]
    assert curved.locate([(0.2, 0.2, 0.2), (0.5, 0.5, 0.5)]).tolist() == [0, -1]
    assert curved.interpolate(values, [(0.2, 0.2, 0.2)])[0] == pytest.approx(1.2)


def test_refused_with_the_rule() -> None:
    mesh = graded(20)
    with pytest.raises(cm.InputError, match=r"points must have shape \(n, 3\); got \(5, 2\)"):
        mesh.locate(np.zeros((5, 2)))
    with pytest.raises(cm.InputError, match="points must be an"):
        mesh.locate("here")
    with pytest.raises(cm.InputError, match=r"values must have shape \(20,\) or \(20, k\)"):
        mesh.interpolate(np.zeros(3), [(0, 0, 0)])

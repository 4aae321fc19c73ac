"""Finding cells at points, and interpolation."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.mesh.orientation import orientations


def graded(n: int = 4000, seed: int = 3) -> Mesh:
    """A triangulation of random points, half of them in a corner of a thousandth the size."""
    from scipy.spatial import Delaunay

    points = np.random.default_rng(seed).random((n, 2))
    points[: n // 2] *= 1e-3
    rows = Delaunay(points).simplices.astype(np.int64)
    turned = orientations(points, rows) < 0
    rows[turned] = rows[turned][:, ::-1]
    return Mesh(points, {"triangle": rows[orientations(points, rows) > 0]})


def test_centres_lie_in_their_own_cells():
    mesh = graded()
    centres = mesh.points[mesh.cells["triangle"]].mean(axis=1)
    found = mesh.locate(centres)
    # Slivers on the hull are thinner than the rounding of their centres.
    assert (found == np.arange(mesh.n_cells)).mean() > 0.999


def test_vertices_get_the_lowest_cell_around_them():
    mesh = graded()
    rows = mesh.cells["triangle"]
    lowest = np.full(mesh.n_points, mesh.n_cells)
    np.minimum.at(lowest, rows.ravel(), np.repeat(np.arange(len(rows)), 3))
    used = lowest < mesh.n_cells
    assert (mesh.locate(mesh.points)[used] == lowest[used]).all()


def test_points_on_edges_are_inside_and_points_beside_are_not():
    mesh = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], {"triangle": [[0, 1, 2], [0, 2, 3]]})
    below = np.nextafter(0.0, -1.0)
    queries = [[0.5, 0.5], [0.5, 0.0], [0.5, below], [1.0, 1.0], [np.nan, 0.5], [np.inf, 0.0]]
    assert mesh.locate(queries).tolist() == [0, 0, -1, 0, -1, -1]
    above, under = [0.3, np.nextafter(0.3, 1)], [np.nextafter(0.3, 1), 0.3]
    assert mesh.locate([above, under]).tolist() == [1, 0]


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_needles_are_found_as_well_as_others(shift):
    """A fan of 500 needles, twenty thousand times longer than wide at the thin end."""
    t = np.linspace(0.3, 0.35, 501)
    rim = np.stack([np.cos(t), np.sin(t)], axis=1)
    points = np.concatenate([rim, [[0.0, 0.0]]]) + shift
    cells = np.stack([np.arange(500), np.arange(1, 501), np.full(500, 501)], axis=1)
    mesh = Mesh(points, {"triangle": cells})
    lo, hi = points.min(axis=0), points.max(axis=0)
    queries = np.concatenate([lo + (hi - lo) * np.random.default_rng(0).random((4000, 2)), rim])
    triples = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    wanted = np.full(len(queries), -1)
    for i, q in enumerate(queries):
        stacked = np.concatenate([points, q[None]])
        rows = np.column_stack([triples, np.full(len(triples), len(points))])
        inside = (orientations(stacked, rows) >= 0).reshape(3, -1).all(axis=0)
        wanted[i] = np.flatnonzero(inside)[0] if inside.any() else -1
    assert (mesh.locate(queries) == wanted).all()
    assert (wanted >= 0).sum() > 50


def test_holes_and_gaps_are_outside():
    ring = {"quad": [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]}
    outer = np.array([[-2, -2], [2, -2], [2, 2], [-2, 2]])
    mesh = Mesh(np.concatenate([outer, outer / 2]), ring)
    assert mesh.locate([[0, 0], [0, -1.5], [1.5, 0], [0, 1.5], [-1.5, 0], [3, 0]]).tolist() == [
        *(-1, 0, 1, 2, 3, -1)
    ]


def test_a_quad_with_a_reflex_corner():
    mesh = Mesh([[0, 0], [4, 0], [1, 1], [0, 4]], {"quad": [[0, 1, 2, 3]]})
    assert mesh.locate([[0.9, 0.9], [1.1, 1.1], [3, 0.1], [0.1, 3]]).tolist() == [0, -1, 0, 0]


def test_an_empty_mesh():
    mesh = Mesh(np.zeros((0, 2)), {})
    assert mesh.locate([[0.0, 0.0]]).tolist() == [-1]


def test_linear_functions_are_reproduced():
    mesh = graded()
    queries = np.random.default_rng(1).random((5000, 2))
    values = np.stack([1 + mesh.points @ [2.0, 3.0], mesh.points @ [-1.0, 1.0]], axis=1)
    found = mesh.interpolate(values, queries)
    inside = mesh.locate(queries) >= 0
    wanted = np.stack([1 + queries @ [2.0, 3.0], queries @ [-1.0, 1.0]], axis=1)
    assert np.allclose(found[inside], wanted[inside], atol=1e-10)
    assert np.isnan(found[~inside]).all() and inside.mean() > 0.9


def test_quads_are_interpolated_bilinearly():
    mesh = Mesh([[0, 0], [3, 0.5], [2.5, 2], [0.2, 1.5]], {"quad": [[0, 1, 2, 3]]})
    u, v = np.random.default_rng(0).random((2, 200))
    weight = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    values = np.array([1.0, -2.0, 5.0, 3.0])
    assert np.allclose(mesh.interpolate(values, weight @ mesh.points), weight @ values, atol=1e-12)


def test_wrong_arguments_are_told():
    mesh = graded(100)
    with pytest.raises(InputError, match="one row a point of the mesh"):
        mesh.interpolate([1.0, 2.0], [[0, 0]])
    with pytest.raises(InputError, match=r"points must have shape \(n, 2\); got \(4,\)"):
        mesh.locate([0.0, 0.0, 0.0, 0.0])


@given(
    st.lists(st.integers(0, 40), min_size=6, max_size=6),
    st.sampled_from([1.0, 0.1, 1e-9, 3e8]),
    st.sampled_from([0.0, 0.7, 1e9]),
)
def test_orientations_agree_with_rational_arithmetic(numbers, scale, offset):
    points = np.array(numbers, float).reshape(3, 2) * scale + offset
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in p] for p in points.tolist())
    det = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    assert orientations(points, np.array([[0, 1, 2]]))[0] == (det > 0) - (det < 0)


def test_complex_values_keep_their_imaginary_parts():
    mesh = graded(100)
    z = mesh.points[:, 0] + 2j * mesh.points[:, 1]
    at = np.array([[0.4, 0.5], [9, 9]])
    found = mesh.interpolate(z, at)
    assert found[0] == pytest.approx(0.4 + 1j) and np.isnan(found[1])


def test_no_points_and_no_numbers():
    mesh = graded(100)
    assert mesh.locate([]).shape == (0,)
    assert mesh.interpolate(mesh.points, []).shape == (0, 2)
    with pytest.raises(InputError, match="points must be an"):
        mesh.locate("x")
    with pytest.raises(InputError, match="values must be numbers; got 'x'"):
        mesh.interpolate("x", [[0, 0]])


def test_a_single_point_counts_as_one_row() -> None:
    mesh = Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
    assert mesh.locate((0.25, 0.25)).tolist() == [0]
    assert mesh.interpolate([0, 1, 2], (0.25, 0.25)).tolist() == [0.75]
    with pytest.raises(InputError, match=r"\(n, 2\).*\(3,\)"):
        mesh.locate((0.25, 0.25, 0.0))

"""Tetrahedra refined in places, longest edges first."""

from __future__ import annotations

import numpy as np
import pytest
from solid_meshes import BALL, DOME, ball, dome
from test_solid_refinement import two_regions

import csgmesh as cm


def near(mesh: cm.Mesh, place: tuple[float, float, float], radius: float) -> np.ndarray:
    away = mesh.points[mesh.cells["tetra"]].mean(axis=1) - place
    return np.sqrt((away**2).sum(axis=1)) < radius


@pytest.mark.parametrize(("make", "shape"), [(ball, BALL), (dome, DOME)])
def test_refined_towards_a_point_of_the_boundary(make, shape: cm.Shape) -> None:
    mesh = first = make(0.4)
    coarse = cm.quality(mesh).min_dihedral.min()
    for level in range(5):
        mesh = cm.refine(mesh, near(mesh, (0, 0, 1), 0.7 * 0.5**level), "longest edge")
        certificate = cm.check(mesh)
        assert certificate.ok, certificate
    assert cm.check(mesh, shape).ok
    assert mesh.info["points_on_chords"] == 0
    on = mesh.points[mesh.boundary_points("ball")]
    np.testing.assert_allclose(np.sqrt((on**2).sum(axis=1)), 1.0, rtol=0, atol=1e-15)
    quality = cm.quality(mesh)
    # Cells at the point are 2^5 times smaller, those far away are the first ones, none much worse.
    at = near(mesh, (0, 0, 1), 0.03)
    assert quality.max_edge[at].max() < 0.06
    assert quality.max_edge.max() > 0.8 * cm.quality(first).max_edge.max()
    assert mesh.n_cells < 0.005 * 8**5 * first.n_cells
    assert quality.min_dihedral.min() > 0.5 * coarse


def test_all_edges_of_marked_cells_are_halved_and_cells_know_their_parents() -> None:
    mesh = ball(0.4)
    marked = np.array([5, 100, 300])
    fine = cm.refine(mesh, marked, "longest edge")
    parent = fine.cell_parent["tetra"]
    count = np.bincount(parent, minlength=mesh.n_cells)
    assert (count[marked] == 8).all()
    assert count.min() == 1
    assert (np.diff(parent) >= 0).all()
    inner = np.setdiff1d(np.arange(mesh.n_points), mesh.boundary_points("ball"))
    whole = np.isin(mesh.cells["tetra"], inner).all(axis=1)
    volume = np.bincount(parent, cm.quality(fine).volume, mesh.n_cells)
    np.testing.assert_allclose(volume[whole], cm.quality(mesh).volume[whole], rtol=1e-12)


def test_all_cells_become_eight() -> None:
    fine = cm.refine(dome(0.4), method="longest edge")
    assert fine.n_cells == 8 * dome(0.4).n_cells
    assert cm.check(fine, DOME).ok


def test_nothing_marked_nothing_done() -> None:
    fine = cm.refine(ball(0.4), np.zeros(ball(0.4).n_cells, bool), "longest edge")
    np.testing.assert_array_equal(fine.cells["tetra"], ball(0.4).cells["tetra"])
    np.testing.assert_array_equal(fine.points, ball(0.4).points)


def test_interfaces_are_divided_alike_from_both_sides() -> None:
    fine = cm.refine(two_regions(), [0], "longest edge")
    assert len(fine.interface("rock", "core")["triangle"]) == 4
    assert len(fine.region("rock")["tetra"]) == 8
    checks = cm.check(fine)
    assert checks["conforming"].status == checks["orientation"].status == "passed"
    unlisted = [f for f in checks.failures if f.rule != "facets"]
    assert not unlisted


def test_edges_of_the_same_length_are_no_tie() -> None:
    """Cubes cut into six tetrahedra: diagonals of squares and of cubes abound."""
    n = 3
    at = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    points = np.stack(np.meshgrid(*[np.arange(n + 1.0)] * 3, indexing="ij"), axis=3).reshape(-1, 3)
    rows = []
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0)):
        corner, steps = np.zeros(3, int), [np.zeros(3, int)]
        for axis in order:
            corner = corner + np.eye(3, dtype=int)[axis]
            steps.append(corner)
        block = [at[tuple(slice(s, s + n) for s in step)].ravel() for step in steps]
        is_even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        rows.append(np.stack(block if is_even else [block[k] for k in (1, 0, 2, 3)], axis=1))
    mesh = cm.Mesh(points, {"tetra": np.concatenate(rows)})
    shapes = set()
    for _ in range(4):
        mesh = cm.refine(mesh, near(mesh, (0, 0, 0), 1.0), "longest edge")
        assert cm.check(mesh)["conforming"].status == "passed"
        quality = cm.quality(mesh)
        assert quality.total_volume == pytest.approx(27.0, rel=1e-13)
        shapes |= set(quality.min_dihedral.round(9).tolist())
    # Halved cubes' tetrahedra come in few shapes only.
    assert min(shapes) == pytest.approx(30.0)
    assert len(shapes) <= 4


def test_the_same_bytes_every_time() -> None:
    first, second = (cm.refine(ball(0.4), [1, 2], "longest edge") for _ in range(2))
    assert first.equals(second)

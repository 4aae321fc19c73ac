"""The lattices that fill a domain are part of its constrained Delaunay triangulation."""

from __future__ import annotations

import numpy as np
import pytest
from plane_domains import (
    assert_angles,
    assert_on_curves,
    assert_sound,
    disks,
    edge_lengths,
    loops,
    smallest_angles,
    square,
    star,
)

from csgmesh import kernels
from csgmesh.domain import Pslg
from csgmesh.mesh import Mesh
from csgmesh.meshers import DelaunayRefinement

FRAME = [(0, 0), (1, 0), (1, 1), (0, 1)]
TURNED = [(0, 0), (0.8, 0.6), (0.2, 1.4), (-0.6, 0.8)]


def framed(points, segments, sides, **more) -> Pslg:
    """A square of region 0 with points and segments inside."""
    n = len(segments)
    return Pslg.build(
        points=[*FRAME, *points],
        segments=[[0, 1], [1, 2], [2, 3], [3, 0], *segments],
        segment_marker=[0] * 4 + [1] * n,
        segment_region=[[0, -1]] * 4 + sides,
        boundary_names=(("frame",), ("inner",), ("probe",)),
        **more,
    )


DOMAINS = {
    "square": square(),
    "turned": loops(TURNED),
    "far away": loops(FRAME, scale=3.0, offset=1e6),
    "hole": loops(FRAME, [(0.3, 0.35), (0.6, 0.3), (0.7, 0.55), (0.4, 0.7)]),
    "island": disks([(0.5, 0.5, 0.4, -1, 0), (0.5, 0.5, 0.3, 1, -1)], n=12, box=(0, 0, 1, 1)),
    "inclusion": disks([(0.5, 0.5, 0.31, 1, 0)], n=6, box=(0, 0, 1, 1)),
    "slit": framed([(0.2, 0.31), (0.83, 0.62)], [[4, 5]], [[0, 0]]),
    "touching slit": framed([(0.4, 0.43)], [[0, 4]], [[0, 0]]),
    "point": framed([(0.41, 0.57)], [], [], point_marker=[-1] * 4 + [2]),
    "sharp": loops([(0, 0), (2, 0.1), (2, 1)]),
    "narrow": loops(FRAME, [(0.05, 0.05), (0.95, 0.05), (0.95, 0.95), (0.05, 0.95)]),
    "tiny hole": loops(FRAME, [(0.5, 0.5), (0.5005, 0.5), (0.5, 0.5005)]),
    "short chords": disks([(0.4, 0.45, 0.2, -1, 0), (0.8, 0.8, 0.1, 1, 0)], 90, (0, 0, 1, 1)),
}


def assert_delaunay(mesh: Mesh) -> None:
    """Every edge that is no facet is locally Delaunay, by exact arithmetic."""
    cells = mesh.cells["triangle"]
    n = mesh.n_points
    a, b = cells.ravel(), np.roll(cells, -1, axis=1).ravel()
    opposite = np.roll(cells, -2, axis=1).ravel()
    key = np.minimum(a, b) * n + np.maximum(a, b)
    order = np.argsort(key, kind="stable")
    pairs = np.flatnonzero(key[order][1:] == key[order][:-1])
    facets = np.sort(mesh.facets["line"], axis=1)
    first, second = order[pairs], order[pairs + 1]
    free = ~np.isin(key[first], facets[:, 0] * n + facets[:, 1])
    first, second = first[free], second[free]
    triangles = np.column_stack([a[first], b[first], opposite[first]])
    assert kernels.in_circles(mesh.points, triangles, opposite[second]).max() <= 0


@pytest.mark.parametrize("size", [0.11, 0.03, 0.0093])
@pytest.mark.parametrize("name", DOMAINS)
def test_what_surrounds_a_lattice_is_delaunay(name: str, size: float) -> None:
    domain = DOMAINS[name]
    mesh = DelaunayRefinement().generate(domain, size * (3.0 if name == "far away" else 1.0))
    assert_sound(mesh, domain)
    assert_delaunay(mesh)
    assert_angles(mesh, domain, 30)
    assert_on_curves(mesh, 1e-14)


@pytest.mark.parametrize("name", ["square", "inclusion", "slit", "short chords"])
def test_lattices_of_several_sizes_leave_a_delaunay_triangulation(name: str) -> None:
    def size(p: np.ndarray) -> np.ndarray:
        return 0.003 + 0.04 * np.hypot(p[:, 0] - 0.3, p[:, 1] - 0.2)

    domain = DOMAINS[name]
    mesh = DelaunayRefinement().generate(domain, size)
    assert_sound(mesh, domain)
    assert_delaunay(mesh)
    assert_angles(mesh, domain, 30)
    assert smallest_angles(mesh).mean() > 55


def test_a_plateau_of_sizes_gets_edges_of_just_that_length() -> None:
    mesh = DelaunayRefinement().generate(square(), {"default": 0.017, "boundary": 0.006})
    assert np.mean(np.abs(edge_lengths(mesh) / 0.017 - 1) < 1e-6) > 0.4


def test_both_shores_of_a_slit_share_one_lattice_row_by_row() -> None:
    mesh = DelaunayRefinement().generate(DOMAINS["slit"], 0.02)
    assert np.mean(np.abs(edge_lengths(mesh) / 0.02 - 1) < 1e-9) > 0.75


def test_neighbours_have_numbers_close_to_one_another() -> None:
    # Half bandwidth of a row-major numbering: what a solver's cache and fill-in depend on.
    mesh = DelaunayRefinement().generate(square(), 0.01)
    cells = mesh.cells["triangle"]
    spread = np.ptp(cells, axis=1)
    assert np.median(spread) <= 1.1 / 0.01
    assert np.median(np.abs(np.diff(cells[:, 0]))) <= 2


def test_a_size_near_the_coordinates_rounding_needs_no_lattice() -> None:
    domain = loops(FRAME, scale=1e-6, offset=1e5)
    mesh = DelaunayRefinement().generate(domain, 1e-7)
    assert_sound(mesh, domain)


def test_a_needle_star_around_one_lattice() -> None:
    mesh = DelaunayRefinement().generate(star(60, 0.5), 0.02)
    assert_sound(mesh, star(60, 0.5))
    assert_delaunay(mesh)


def test_short_chords_are_not_carried_into_the_domain() -> None:
    domain = disks([(0.3, 0.3, 0.15, -1, 0), (0.7, 0.6, 0.2, -1, 0)], 50, (0, 0, 1, 1))
    mesh = DelaunayRefinement().generate(domain, 0.05)
    assert np.mean(edge_lengths(mesh) > 0.6 * 0.05) > 0.74


def test_a_budget_is_not_taken_for_too_small_before_sizes_are_known() -> None:
    # Two corners and a few points of the boundary say nothing of the inside, which is coarse.
    mesh = DelaunayRefinement(max_points=60_000).generate(square(), {"boundary": 4e-4})
    assert mesh.n_points < 60_000

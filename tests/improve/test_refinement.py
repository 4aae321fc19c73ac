"""Refined meshes: conforming, named, on their curves, with the angles that were promised."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refinable import SHAPES, mesh_of, quads

import csgmesh as cm
from csgmesh.domain.curves import Curves
from csgmesh.errors import InputError, MeshingError
from csgmesh.mesh import Mesh

METHODS = ("red-green", "longest edge", "newest vertex")
#: Smallest angle after refinement of a mesh of straight cells, from its own.
BOUNDS = {
    "red-green": lambda a: np.degrees(np.arctan(np.tan(np.radians(a)) / 3)),
    "longest edge": lambda a: a / 2,
    "newest vertex": lambda a: a / 2,
}
NEEDLE = Mesh(
    [[0, 0], [3, 0], [2.5, 0.8], [0.3, 1.1], [1.2, 2.9]],
    {"triangle": [[0, 1, 2], [0, 2, 3], [3, 2, 4]]},
    facets={"line": [[0, 1], [1, 2], [2, 4], [4, 3], [3, 0]]},
    facet_marker={"line": [0, 0, 1, 1, 1]},
    facet_region={"line": [[0, -1]] * 5},
    boundary_names=[["floor"], ["wall"]],
)


def centres(mesh: Mesh) -> np.ndarray:
    return np.concatenate([mesh.points[rows].mean(axis=1) for rows in mesh.cells.values()])


def near(mesh: Mesh, place: tuple[float, float], radius: float) -> np.ndarray:
    return np.hypot(*(centres(mesh) - place).T) < radius


def smallest(mesh: Mesh) -> float:
    return float(cm.quality(mesh).min_angle.min())


def length(mesh: Mesh, name: str) -> float:
    ends = mesh.points[mesh.facets["line"][mesh.boundary(name)["line"]]]
    return float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())


@pytest.mark.parametrize("name", SHAPES)
def test_a_refined_mesh_passes_the_certificate(name: str) -> None:
    mesh, shape = mesh_of(name), SHAPES[name][0]
    fine = cm.refine(mesh)
    assert fine.n_cells == 4 * mesh.n_cells
    certificate = cm.check(fine, shape)
    assert certificate.ok, str(certificate)
    for method in METHODS:
        local = cm.check(cm.refine(mesh, np.arange(0, mesh.n_cells, 3), method))
        assert local.ok, str(local)


@pytest.mark.parametrize("method", METHODS)
def test_ten_levels_conform_and_keep_the_bound(method: str) -> None:
    mesh, bound = NEEDLE, BOUNDS[method](smallest(NEEDLE))
    for level in range(10):
        mesh = cm.refine(mesh, near(mesh, (0.3, 1.1), 1.5 * 0.6**level), method)
        certificate = cm.check(mesh)
        assert certificate.ok, str(certificate)
        assert smallest(mesh) >= bound - 1e-9
    assert cm.quality(mesh).total_area == pytest.approx(cm.quality(NEEDLE).total_area, abs=1e-13)


def test_uniform_refinement_keeps_all_angles() -> None:
    assert smallest(cm.refine(cm.refine(NEEDLE))) == pytest.approx(smallest(NEEDLE), abs=1e-9)


def test_newest_vertex_makes_four_shapes_of_a_triangle() -> None:
    mesh = Mesh([[0, 0], [3, 0], [2.2, 0.9]], {"triangle": [[0, 1, 2]]})
    shapes = set()
    for _ in range(6):
        mesh = cm.refine(mesh, [0, mesh.n_cells - 1], "newest vertex")
        quality = cm.quality(mesh)
        shapes |= set(zip(quality.min_angle.round(6), quality.max_angle.round(6), strict=True))
    assert len(shapes) == 4


def test_green_cells_are_put_together_before_they_are_refined() -> None:
    mesh = cm.refine(NEEDLE, [0])
    for _ in range(6):
        green = mesh.cell_green.get("triangle")
        mesh = cm.refine(mesh, [0] if green is None else green >= 0)
    assert smallest(mesh) >= BOUNDS["red-green"](smallest(NEEDLE)) - 1e-9
    assert cm.check(mesh).ok


def test_parents_are_the_cells_that_children_are_part_of() -> None:
    mesh = mesh_of("square")
    for method in METHODS:
        local = cm.refine(mesh, near(mesh, (0.2, 0.2), 0.3), method)
        parent = local.cell_parent["triangle"]
        assert (parent == mesh.locate(centres(local))).all()


@pytest.mark.parametrize("triangles", [False, True])
def test_quads_become_four_and_green_ones_triangles(triangles: bool) -> None:
    mesh = quads(4, 0.0, triangles)
    fine = cm.refine(mesh)
    assert len(fine.cells["quad"]) == 4 * len(mesh.cells["quad"])
    assert cm.check(fine).ok
    local = mesh
    for level in range(5):
        local = cm.refine(local, near(local, (0.4, 0.3), 0.5 * 0.6**level))
        certificate = cm.check(local)
        assert certificate.ok, str(certificate)
        assert cm.quality(local).total_area == pytest.approx(1, abs=1e-13)
    # Of squares cut along a diagonal, and of squares.
    assert smallest(local) >= np.degrees(np.arctan(1 / 3 if triangles else 1 / 2)) - 1e-9


def test_cells_are_given_as_a_mask_as_numbers_or_by_kind() -> None:
    mesh = quads(3, 0.0, triangles=True)
    mask = np.zeros(mesh.n_cells, bool)
    mask[[1, len(mesh.cells["triangle"]) + 2]] = True
    given = [mask, np.flatnonzero(mask), {"triangle": [1], "quad": [2]}]
    results = [cm.refine(mesh, cells) for cells in given]
    assert results[0].equals(results[1])
    assert results[0].equals(results[2])


def test_names_regions_points_and_lengths_are_inherited() -> None:
    mesh = mesh_of("crack")
    fine = cm.refine(mesh, near(mesh, (0, 0), 0.7))
    assert fine.names == mesh.names
    assert length(fine, "crack") == pytest.approx(length(mesh, "crack"), abs=1e-14)
    assert (fine.points[fine.boundary_points("probe")] == [[0.1, 0.5]]).all()
    errors = []
    for _ in range(3):
        errors.append(2 * np.pi - length(mesh, "disk"))
        mesh = cm.refine(mesh)
    ratio = np.array(errors[:-1]) / np.array(errors[1:])
    assert ((ratio > 3.9) & (ratio < 4.1)).all()


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), method=st.sampled_from(METHODS))
def test_any_marks_give_a_valid_mesh(seed: int, method: str) -> None:
    rng = np.random.default_rng(seed)
    mesh = mesh_of("regions")
    for _ in range(3):
        mesh = cm.refine(mesh, rng.random(mesh.n_cells) < rng.choice([0.01, 0.1, 0.5]), method)
    certificate = cm.check(mesh)
    assert certificate.ok, str(certificate)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), triangles=st.booleans())
def test_any_marks_among_quads_give_a_valid_mesh(seed: int, triangles: bool) -> None:
    rng = np.random.default_rng(seed)
    mesh = quads(4, 0.3, triangles)
    for _ in range(3):
        mesh = cm.refine(mesh, rng.random(mesh.n_cells) < rng.choice([0.03, 0.1, 0.5]))
    certificate = cm.check(mesh)
    assert certificate.ok, str(certificate)


def test_a_mesh_from_a_file_is_refined_along_its_chords(tmp_path) -> None:
    mesh = mesh_of("disk")
    cm.write(tmp_path / "disk.msh", mesh)
    read = cm.refine(cm.read(tmp_path / "disk.msh"))
    assert cm.check(read).ok
    assert length(read, "disk") == pytest.approx(length(mesh, "disk"), abs=1e-13)


def test_green_closures_survive_an_archive(tmp_path) -> None:
    mesh = cm.refine(NEEDLE, [0])
    cm.write(tmp_path / "mesh.npz", mesh)
    again = cm.read(tmp_path / "mesh.npz")
    assert again.equals(mesh)
    assert cm.refine(again, [0]).equals(cm.refine(mesh, [0]))


def test_a_curve_that_would_turn_cells_over_makes_room_or_is_refused() -> None:
    shape = cm.Disk((0, 0), 1) - cm.Disk((0.3, 0), 0.62)
    domain = cm.evaluate(shape, deviation=0.2)
    mesh = cm.generate(domain, cm.ConstrainedDelaunay())
    try:
        for _ in range(3):
            mesh = cm.refine(mesh)
            assert cm.check(mesh, shape).ok
    except MeshingError as error:
        assert "cannot follow the exact boundary" in str(error)


def test_facets_across_a_narrow_gap_are_halved_together() -> None:
    # A wedge of a disk, and across a gap far narrower than the chords' deviation a cell with a
    # hollow side: the wedge's new vertex on its circle would lie in that cell.
    angle = np.radians([60, 120])
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.concatenate([[[0, 0]], 0.999 * rim, rim, [[0, 2.5]]])
    mesh = Mesh(
        points,
        {"triangle": [[0, 1, 2], [4, 3, 5]]},
        facets={"line": [[0, 1], [1, 2], [2, 0], [4, 3], [3, 5], [5, 4]]},
        facet_marker={"line": [0] * 6},
        facet_region={"line": [[0, -1]] * 6},
        boundary_names=[["rim"]],
        facet_curve={"line": [-1, 0, -1, 1, -1, -1]},
        facet_interval={"line": [[0, 0], angle, [0, 0], angle[::-1], [0, 0], [0, 0]]},
        curves=Curves.arcs(
            np.zeros((2, 2)),
            np.array([[0.999, 0], [1, 0]]),
            np.array([[0, 0.999], [0, 1]]),
            angle[0],
            angle[1],
        ),
    )
    fine = cm.refine(mesh, [0])
    assert cm.check(fine)["overlap"].status == "passed"
    assert fine.n_cells == 4 + 2
    on_top = fine.points[np.abs(fine.points[:, 0]) < 1e-12, 1]
    assert np.sort(on_top) == pytest.approx([0, 0.999, 1, 2.5], abs=1e-15)


def test_what_cannot_be_refined_is_refused() -> None:
    with pytest.raises(InputError, match="method must be one of"):
        cm.refine(NEEDLE, method="blue")
    with pytest.raises(InputError, match="from 0 to 2; got 3 to 3"):
        cm.refine(NEEDLE, [3])
    with pytest.raises(InputError, match="must have 3 entries; got 2"):
        cm.refine(NEEDLE, [True, False])
    with pytest.raises(InputError, match="longest edge refinement is for plane meshes of straight"):
        cm.refine(quads(2), method="longest edge")
    with pytest.raises(InputError, match="cells must be of kinds in the mesh"):
        cm.refine(NEEDLE, {"quad": [0]})

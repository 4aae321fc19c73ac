"""Meshes of space divided: conforming, named, on the exact surfaces, of stable shapes."""

from __future__ import annotations

import numpy as np
import pytest
from solid_meshes import BALL, DOME, SWEPT, ball, dome, swept

import csgmesh as cm
from csgmesh.improve.refinement.solid_templates import CELLS
from csgmesh.meshers.hexahedra import hexahedral_mesh


@pytest.mark.parametrize("name", SWEPT)
def test_swept_meshes_stay_right(name: str) -> None:
    mesh = swept(name)
    fine = cm.refine(mesh)
    certificate = cm.check(fine)
    assert certificate.ok, certificate
    assert fine.info["points_on_chords"] == 0
    assert fine.boundary_names == mesh.boundary_names
    children = {kind: sum(len(t) for t in CELLS[kind].values()) for kind in mesh.cells}
    assert fine.n_cells == sum(n * len(mesh.cells[kind]) for kind, n in children.items())
    assert fine.n_facets == 4 * mesh.n_facets
    np.testing.assert_array_equal(fine.points[: mesh.n_points], mesh.points)


@pytest.mark.parametrize(("make", "shape"), [(ball, BALL), (dome, DOME)])
def test_tetrahedra_follow_curved_surfaces(make, shape: cm.Shape) -> None:
    mesh = make(0.4)
    for level in range(2):
        mesh = cm.refine(mesh)
        certificate = cm.check(mesh, shape if level == 0 else None)
        assert certificate.ok, certificate
        on = mesh.points[mesh.boundary_points("ball")]
        np.testing.assert_allclose(np.sqrt((on**2).sum(axis=1)), 1.0, rtol=0, atol=1e-15)
    if shape is DOME:
        floor = mesh.points[mesh.boundary_points("floor")]
        np.testing.assert_allclose(floor[:, 2], 0.2, rtol=0, atol=1e-15)


def test_vertices_of_a_rim_lie_on_both_surfaces() -> None:
    fine = cm.refine(dome(0.4))
    both = np.intersect1d(fine.boundary_points("ball"), fine.boundary_points("floor"))
    coarse = np.intersect1d(dome(0.4).boundary_points("ball"), dome(0.4).boundary_points("floor"))
    assert len(both) == 2 * len(coarse)
    x, y, z = fine.points[both].T
    np.testing.assert_allclose(z, 0.2, rtol=0, atol=1e-15)
    np.testing.assert_allclose(np.hypot(x, y), np.sqrt(0.96), rtol=0, atol=1e-15)


def test_the_volume_converges_with_the_square_of_the_size() -> None:
    mesh = ball(0.4)
    off = []
    for _ in range(3):
        off.append(4 / 3 * np.pi - cm.quality(mesh).total_volume)
        mesh = cm.refine(mesh)
    ratio = np.array(off[:-1]) / off[1:]
    assert ((ratio > 3.5) & (ratio < 4.5)).all(), ratio


def test_tetrahedra_have_three_shapes_however_often_they_are_divided() -> None:
    corners = np.random.default_rng(3).random((4, 3))
    if np.linalg.det(corners[1:] - corners[0]) < 0:
        corners = corners[[1, 0, 2, 3]]
    mesh = cm.Mesh(corners, {"tetra": [[0, 1, 2, 3]]})
    shapes = set()
    for level in range(1, 5):
        mesh = cm.refine(mesh)
        p = mesh.points[mesh.cells["tetra"]]
        pairs = [(i, j) for i in range(4) for j in range(i)]
        edges = np.stack([((p[:, i] - p[:, j]) ** 2).sum(axis=1) for i, j in pairs], axis=1)
        shapes |= set(map(tuple, np.sort(edges * 4.0**level, axis=1).round(10).tolist()))
        # All of the same volume, and together that of the first.
        np.testing.assert_allclose(
            cm.quality(mesh).volume * 8**level,
            np.abs(np.linalg.det(corners[1:] - corners[0])) / 6,
            rtol=1e-10,
        )
    assert len(shapes) <= 3


def test_straight_cells_give_children_of_their_shape() -> None:
    box = cm.Box((0, 0, 0), (2, 1, 1))
    mesh = cm.refine(cm.generate(box, cm.Sweep(cm.Structured(), layers=2), size=0.5))
    np.testing.assert_allclose(cm.quality(mesh).scaled_jacobian, 1.0, atol=1e-12)
    assert cm.quality(mesh).max_edge.max() == 0.25


def test_hexahedra_of_a_grid_stay_as_good() -> None:
    shape = cm.Box((0, 0, 0), (1, 1, 1)) - cm.Cylinder((0.5, 0.5, -1), (0.5, 0.5, 2), 0.25)
    mesh = hexahedral_mesh(cm.evaluate(shape), lambda points: np.full(len(points), 0.16))
    fine = cm.refine(mesh)
    certificate = cm.check(fine, shape)
    assert certificate.ok, certificate
    assert fine.info["points_on_chords"] == 0
    worst = [cm.quality(m).scaled_jacobian.min() for m in (mesh, fine)]
    assert worst[1] > worst[0] - 1e-6


def test_cells_know_their_parents_and_regions() -> None:
    mesh = swept("wedges, pyramids and tetrahedra")
    fine = cm.refine(mesh)
    parent = np.concatenate(list(fine.cell_parent.values()))
    volume = np.bincount(parent, cm.quality(fine).volume, mesh.n_cells)
    inner = np.ones(mesh.n_points, bool)
    inner[mesh.boundary_points("*")] = False
    before = 0
    for kind, rows in mesh.cells.items():
        own = np.flatnonzero(inner[rows].all(axis=1))
        np.testing.assert_allclose(
            volume[before + own], cm.quality(mesh).volume[before + own], rtol=1e-12, err_msg=kind
        )
        before += len(rows)


def two_regions() -> cm.Mesh:
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
    return cm.Mesh(
        points,
        {"tetra": [[0, 1, 2, 3], [1, 2, 3, 4]]},
        {"tetra": [0, 1]},
        ["rock", "core"],
        facets={"triangle": [[1, 2, 3]]},
        facet_marker={"triangle": [0]},
        boundary_names=[["seam"]],
        facet_region={"triangle": [[0, 1]]},
    )


def test_interfaces_keep_their_sides() -> None:
    fine = cm.refine(two_regions())
    assert len(fine.interface("rock", "core")["triangle"]) == 4
    assert [len(fine.region(name)["tetra"]) for name in ("rock", "core")] == [8, 8]
    checks = cm.check(fine)
    assert checks["conforming"].status == checks["orientation"].status == "passed"


def test_a_vertex_that_would_turn_a_cell_over_stays_on_its_chord() -> None:
    # A flat cell on a cavity: its corner lies nearer to the chords than the sphere does.
    plc = cm.evaluate(cm.Box((-3, -3, -3), (3, 3, 3)) - cm.Ball((0, 0, 0), 1, name="hollow"))
    turn = np.radians([0, 120, 240])
    ring = 0.9 * np.column_stack([np.cos(turn), np.sin(turn)])
    base = np.column_stack([ring, np.full(3, np.sqrt(1 - 0.81))])
    marker = plc.boundary_names.index(("hollow",))
    mesh = cm.Mesh(
        [*base, (0, 0, 0.8)],
        {"tetra": [[0, 1, 2, 3]]},
        facets={"triangle": [[0, 2, 1]]},
        facet_marker={"triangle": [marker]},
        facet_region={"triangle": [[0, -1]]},
        boundary_names=plc.boundary_names,
        domain=plc,
    )
    assert cm.quality(mesh).volume[0] > 0
    fine = cm.refine(mesh)
    assert fine.info["points_on_chords"] == 3
    assert (cm.quality(fine).volume > 0).all()


def test_a_mesh_without_a_domain_is_divided_along_its_chords(tmp_path) -> None:
    mesh = swept("hexahedra")
    cm.write(tmp_path / "ring.npz", mesh)
    read = cm.refine(cm.read(tmp_path / "ring.npz"))
    assert read.info["points_on_chords"] == 0
    assert cm.quality(read).total_volume == pytest.approx(cm.quality(mesh).total_volume, rel=1e-12)
    assert cm.refine(mesh).names == read.names


def test_the_same_bytes_every_time() -> None:
    assert cm.refine(ball(0.4)).equals(cm.refine(ball(0.4)))


def test_refused_with_the_rule() -> None:
    mesh = two_regions()
    with pytest.raises(cm.InputError, match='some cells are refined by method="longest edge"'):
        cm.refine(mesh, cells=[0])
    with pytest.raises(cm.InputError, match="refinement in space is for tetrahedra; this mesh hol"):
        cm.refine(swept("wedges"), [0], "longest edge")
    with pytest.raises(cm.InputError, match="cells must hold numbers from 0 to 1"):
        cm.refine(mesh, [2], "longest edge")
    with pytest.raises(cm.InputError, match="newest vertex refinement is for plane meshes"):
        cm.refine(mesh, method="newest vertex")
    curved = cm.Mesh(np.eye(10, 3), {"tetra10": [range(10)]})
    with pytest.raises(cm.InputError, match="holds tetra10: refine first, then elevate"):
        cm.refine(curved)

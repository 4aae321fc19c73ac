"""Curved tetrahedra: nodes on the exact surfaces, Jacobians positive, volumes of fourth order."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from solid_meshes import BALL, DOME, ball, dome, swept

import csgmesh as cm
from csgmesh.measures.space.curved import curved_volumes, tetra_bounds
from csgmesh.mesh import KINDS

EXACT = {"ball": 4 / 3 * np.pi, "dome": np.pi * 0.8**2 * (3 - 0.8) / 3}


@pytest.mark.parametrize(("make", "shape"), [(ball, BALL), (dome, DOME)])
def test_curved_meshes_pass_every_check(make, shape: cm.Shape) -> None:
    curved = cm.elevate(cm.refine(make(0.4)))
    certificate = cm.check(curved, shape)
    assert certificate.ok, certificate
    assert certificate["edge nodes"].status == "passed"
    assert curved.info["nodes_off_surfaces"] == 0
    assert list(curved.cells) == ["tetra10"]
    assert curved.names == make(0.4).names


def test_nodes_lie_on_the_exact_surfaces_and_on_both_along_a_rim() -> None:
    curved = cm.elevate(cm.refine(dome(0.4)))
    on, floor = (curved.boundary_points(name) for name in ("ball", "floor"))
    np.testing.assert_allclose((curved.points[on] ** 2).sum(axis=1), 1.0, rtol=0, atol=1e-15)
    np.testing.assert_allclose(curved.points[floor, 2], 0.2, rtol=0, atol=1e-15)
    rim = np.intersect1d(on, floor)
    assert (rim >= cm.refine(dome(0.4)).n_points).sum() > 30


@pytest.mark.parametrize(("make", "name"), [(ball, "ball"), (dome, "dome")])
def test_volumes_converge_at_fourth_order(make, name: str) -> None:
    mesh, off = cm.refine(make(0.4)), []
    for _ in range(2):
        off.append(cm.quality(cm.elevate(mesh)).total_volume - EXACT[name])
        mesh = cm.refine(mesh)
    order = np.log2(np.array(off[:-1]) / off[1:])
    assert (order > 3.9).all(), order


def random_cell(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1.0)])
    middles = np.array([corners[list(edge)].mean(axis=0) for edge in KINDS["tetra10"].edges])
    return np.vstack([corners, middles + rng.uniform(-0.15, 0.15, middles.shape)])


def jacobians(nodes: np.ndarray, share: np.ndarray) -> np.ndarray:
    """By differences of the map, at barycentric coordinates (k, 4)."""

    def place(at: np.ndarray) -> np.ndarray:
        value = [at[:, k] * (2 * at[:, k] - 1) for k in range(4)]
        value += [4 * at[:, a] * at[:, b] for a, b in KINDS["tetra10"].edges]
        return np.stack(value, axis=1) @ nodes

    step = 1e-5
    slopes = []
    for k in (1, 2, 3):
        move = np.zeros(4)
        move[[0, k]] = -step, step
        slopes.append((place(share + move) - place(share - move)) / (2 * step))
    return np.linalg.det(np.stack(slopes, axis=1))


def test_bounds_enclose_the_jacobian_and_the_volume_is_its_integral() -> None:
    share = np.random.default_rng(0).dirichlet(np.ones(4), 4000)
    n_valid = 0
    for seed in range(30):
        nodes = random_cell(seed)
        value = jacobians(nodes, share)
        bounds = tetra_bounds(nodes[None])
        assert bounds.least[0] <= value.min() + 1e-8
        assert bounds.most[0] >= value.max() - 1e-8
        if bounds.found[0] > 0:
            n_valid += 1
            assert bounds.least[0] >= bounds.found[0] - 0.05 * np.abs(bounds.most[0])
        # 4000 samples of a polynomial that varies by about its mean.
        assert curved_volumes(nodes[None])[0] == pytest.approx(value.mean() / 6, abs=0.01)
    assert 5 < n_valid < 30


def test_straight_cells_keep_their_jacobian() -> None:
    mesh = cm.Mesh([(0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 3)], {"tetra": [[0, 1, 2, 3]]})
    quality = cm.quality(cm.elevate(mesh))
    assert quality.volume[0] == pytest.approx(1.0, rel=1e-12)
    assert quality.min_jacobian[0] == pytest.approx(1.0, rel=1e-9)
    assert quality.scaled_jacobian[0] == pytest.approx(1.0, rel=1e-9)


def test_nodes_go_back_towards_the_chords_where_cells_would_turn_over() -> None:
    curved = cm.elevate(dome(0.4))
    assert curved.info["nodes_off_surfaces"] == 1
    assert cm.quality(curved).min_jacobian.min() > 0
    certificate = cm.check(curved, DOME)
    # The certificate does not look away.
    assert [failure.rule for failure in certificate.failures] == ["edge nodes"]


def test_a_turned_over_cell_is_found_between_its_corners() -> None:
    nodes = random_cell(0)
    nodes[4:] = np.array([nodes[list(edge)].mean(axis=0) for edge in KINDS["tetra10"].edges])
    nodes[4] = (0.5, 0.45, 0.4)
    mesh = cm.Mesh(nodes, {"tetra10": [range(10)]})
    assert cm.check(mesh)["orientation"].status == "failed"


def test_two_nodes_on_one_edge_are_found() -> None:
    mesh = cm.elevate(ball(0.4))
    cells = mesh.cells["tetra10"].copy()
    points = np.concatenate([mesh.points, mesh.points[cells[0, 4:5]]])
    cells[0, 4] = mesh.n_points
    split = cm.Mesh(points, {"tetra10": cells})
    assert cm.check(split)["edge nodes"].status == "failed"


@pytest.mark.parametrize("suffix", ["msh", "vtu", "inp", "npz"])
def test_files_hold_curved_tetrahedra(suffix: str, tmp_path: Path) -> None:
    mesh = cm.elevate(ball(0.4))
    cm.write(tmp_path / f"ball.{suffix}", mesh)
    read = cm.read(tmp_path / f"ball.{suffix}")
    assert read.names == mesh.names
    np.testing.assert_array_equal(read.cells["tetra10"], mesh.cells["tetra10"])
    np.testing.assert_allclose(read.points, mesh.points, rtol=0, atol=1e-15)
    assert len(read.facets["triangle6"]) == mesh.n_facets
    assert cm.check(read).ok
    assert cm.quality(read).total_volume == pytest.approx(cm.quality(mesh).total_volume, rel=1e-14)


def test_abaqus_gets_plain_elements(tmp_path: Path) -> None:
    cm.write(tmp_path / "ball.inp", cm.elevate(ball(0.4)))
    cm.write(tmp_path / "ring.inp", swept("hexahedra"))
    types = [
        line.split("TYPE=")[1]
        for name in ("ball", "ring")
        for line in (tmp_path / f"{name}.inp").read_text().splitlines()
        if "TYPE=" in line
    ]
    assert types == ["C3D10", "STRI65", "C3D8", "S4"]


def test_gmsh_orders_the_last_two_nodes_otherwise(tmp_path: Path) -> None:
    import meshio

    mesh = cm.elevate(ball(0.4))
    cm.write(tmp_path / "ball.msh", mesh)
    other = meshio.read(tmp_path / "ball.msh")
    np.testing.assert_array_equal(other.cells_dict["tetra10"], mesh.cells["tetra10"])


def test_refused_with_the_rule() -> None:
    with pytest.raises(cm.InputError, match="only those of straight tetrahedra can be elevated"):
        cm.elevate(swept("wedges"))
    with pytest.raises(cm.InputError, match="can be elevated to order 2; got 3"):
        cm.elevate(ball(0.4), 3)
    with pytest.raises(cm.InputError, match="this one holds tetra10, triangle6"):
        cm.elevate(cm.elevate(ball(0.4)))

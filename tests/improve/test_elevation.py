"""Curved cells: exact boundaries, areas of high order, positive Jacobians, files that agree."""

from __future__ import annotations

import functools
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refinable import SHAPES, mesh_of, with_quads

import csgmesh as cm
from csgmesh.errors import InputError
from csgmesh.io.vtk_kinds import vtk_order
from csgmesh.measures.jacobians import jacobian_bounds
from csgmesh.mesh import Mesh
from csgmesh.mesh.lagrange import gradients, reference_nodes

DISK = cm.Disk((0, 0), 1)
ROUND = {
    "disk": DISK,
    "ellipse": cm.Ellipse((0, 0), (2, 1), angle=20),
    "half disk": DISK & cm.HalfSpace((0, 0), (0, 1)),
    "lens": DISK & cm.Disk((1, 0), 1),
    "crescent": DISK - cm.Disk((0.5, 0), 0.8),
}
KINDS = ("triangle6", "triangle10", "triangle15", "triangle21", "quad9", "quad16", "quad25")


@functools.cache
def levels(name: str) -> list[Mesh]:
    meshes = [cm.generate(ROUND[name], size=0.5, deviation=0.05)]
    for _ in range(3):
        meshes.append(cm.refine(meshes[-1]))
    return meshes


def area_errors(name: str, order: int, nodes: str) -> list[float]:
    exact = cm.evaluate(ROUND[name]).areas().sum()
    curved = (cm.elevate(mesh, order, nodes) for mesh in levels(name))
    return [abs(cm.quality(mesh).total_area - exact) for mesh in curved]


@pytest.mark.parametrize("name", ROUND)
@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_areas_converge_with_twice_the_order(name: str, order: int) -> None:
    for nodes, wanted in (("lobatto", 2 * order), ("equispaced", 2 * (order // 2) + 2)):
        errors = area_errors(name, order, nodes)
        assert errors[-1] < 1e-6
        # The last step before rounding shows.
        steps = [(a, b) for a, b in pairwise(errors) if b > 1e-13]
        assert not steps or np.log2(steps[-1][0] / steps[-1][1]) > wanted - 0.3


@pytest.mark.parametrize("name", SHAPES)
def test_elevated_meshes_pass_the_certificate(name: str) -> None:
    for mesh, order in ((mesh_of(name), 2), (with_quads(name), 5)):
        curved = cm.elevate(mesh, order)
        certificate = cm.check(curved, SHAPES[name][0])
        assert certificate.ok, str(certificate)
        assert curved.names == mesh.names
        assert certificate["Jacobian"].status == "passed"
        assert (curved.points[: mesh.n_points] == mesh.points).all()


@settings(max_examples=40, deadline=None)
@given(kind=st.sampled_from(KINDS), seed=st.integers(0, 10**6), noise=st.floats(0, 0.15))
def test_jacobians_keep_to_their_bounds(kind: str, seed: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    nodes = reference_nodes(kind, "lobatto")
    moved = (nodes + noise * rng.uniform(-1, 1, nodes.shape))[None]
    bounds = jacobian_bounds(moved, kind, "lobatto")
    at = rng.random((500, 2))
    if kind.startswith("triangle"):
        at = np.where(at.sum(axis=1, keepdims=True) > 1, 1 - at, at)
    du, dv = (d @ moved[0] for d in gradients(kind, "lobatto", at))
    jacobian = du[:, 0] * dv[:, 1] - du[:, 1] * dv[:, 0]
    assert bounds.least[0] <= jacobian.min() and jacobian.max() <= bounds.most[0]
    if bounds.found[0] > 0:
        # Nothing is called turned over that is far from it.
        assert bounds.least[0] > jacobian.min() - 0.15 * bounds.most[0]


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".npz"])
@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_files_hold_curved_cells(tmp_path, suffix: str, order: int) -> None:
    mesh = cm.elevate(with_quads("regions"), order)
    cm.write(tmp_path / f"mesh{suffix}", mesh)
    read = cm.read(tmp_path / f"mesh{suffix}")
    assert read.names == mesh.names
    assert list(read.cells) == list(mesh.cells)
    assert cm.quality(read).area == pytest.approx(cm.quality(mesh).area, abs=1e-14)
    if order in (2, 5):
        certificate = cm.check(read, SHAPES["regions"][0])
        assert certificate.ok, str(certificate)


def test_meshio_gets_equispaced_nodes_and_gives_them_back() -> None:
    mesh = cm.elevate(mesh_of("disk"), 3)
    given = cm.to_meshio(mesh)
    a, b, p, q = given.points[given.cells_dict["line4"]].transpose(1, 0, 2)
    assert np.hypot(*(p - a).T) == pytest.approx(np.hypot(*(b - q).T), rel=1e-9)
    assert cm.quality(cm.from_meshio(given)).total_area == pytest.approx(
        cm.quality(mesh).total_area, abs=1e-14
    )


def test_vtk_orders_the_nodes_of_a_quad_along_its_axes() -> None:
    assert vtk_order("quad16").tolist() == [0, 1, 2, 3, 4, 5, 6, 7, 9, 8, 11, 10, 12, 13, 15, 14]
    assert vtk_order("triangle10") is None


def test_flat_cells_bend_their_neighbours() -> None:
    shape = DISK - cm.Disk((0.3, 0), 0.62)
    mesh = cm.generate(cm.evaluate(shape, deviation=0.02), cm.ConstrainedDelaunay())
    curved = cm.elevate(mesh, 2)
    certificate = cm.check(curved, shape)
    assert certificate.ok, str(certificate)
    assert curved.n_cells == mesh.n_cells
    assert cm.quality(curved).scaled_jacobian.min() > 0.1


@pytest.mark.parametrize("order", [2, 3, 5])
def test_cells_with_two_edges_on_a_smooth_curve_are_divided(order: int) -> None:
    mesh = cm.generate(cm.evaluate(DISK, deviation=0.02), cm.ConstrainedDelaunay())
    curved = cm.elevate(mesh, order)
    assert curved.n_cells > mesh.n_cells
    assert curved.info["divided_to_curve"] > 0
    certificate = cm.check(curved, DISK)
    assert certificate.ok, str(certificate)
    assert cm.quality(curved).scaled_jacobian.min() > 0.01


def test_the_certificate_sees_bent_cells_that_turn_over_and_nodes_off_the_curve() -> None:
    mesh = cm.elevate(mesh_of("disk"), 3)
    rows = mesh.cells["triangle10"]
    inner = np.array(mesh.points)
    inner[rows[0, 9]] += [0.4, 0.0]
    certificate = cm.check(replace(mesh, points=inner))
    assert [failure.rule for failure in certificate.failures] == ["Jacobian"]
    off = np.array(mesh.points)
    off[mesh.facets["line4"][0, 2]] *= 1 + 1e-9
    certificate = cm.check(replace(mesh, points=off))
    assert "edge nodes" in [failure.rule for failure in certificate.failures]


def test_scikit_fem_integrates_over_curved_cells() -> None:
    skfem = pytest.importorskip("skfem")
    mesh = cm.elevate(mesh_of("disk"), 2)
    basis = skfem.Basis(cm.to_skfem(mesh), skfem.ElementTriP2(), intorder=6)
    area = skfem.Functional(lambda w: 1.0 + 0.0 * w.x[0]).assemble(basis)
    assert area == pytest.approx(cm.quality(mesh).total_area, abs=1e-13)


def test_a_mesh_without_curves_keeps_straight_edges(tmp_path) -> None:
    cm.write(tmp_path / "disk.msh", mesh_of("disk"))
    read = cm.read(tmp_path / "disk.msh")
    assert cm.quality(cm.elevate(read, 4)).scaled_jacobian == pytest.approx(1)


def test_what_cannot_be_elevated_is_refused() -> None:
    mesh = mesh_of("square")
    with pytest.raises(InputError, match="order must be one of 2, 3, 4, 5; got 6"):
        cm.elevate(mesh, 6)
    with pytest.raises(InputError, match="nodes must be one of"):
        cm.elevate(mesh, 3, "chebyshev")
    with pytest.raises(InputError, match="only plane meshes of straight triangles and quads"):
        cm.elevate(cm.elevate(mesh, 2), 3)
    with pytest.raises(InputError, match="holds triangle6"):
        cm.refine(cm.elevate(mesh, 2))


def test_a_quad_of_eight_points_is_measured_by_its_corners() -> None:
    corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
    middles = [[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]]
    mesh = Mesh([*corners, *middles], {"quad8": [list(range(8))]})
    assert cm.quality(mesh).total_area == 1

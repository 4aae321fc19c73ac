"""Hexahedra around the axis of a revolution."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

O_GRID = cm.Sweep(cm.Structured(), axis="o-grid")
ROD = cm.Revolve(cm.Box((0, 0), (1, 2)), name="rod")
DISH = cm.Revolve(cm.Box((0, 0), (1, 3)) - cm.Disk((0, 3), 1.5), name="dish")


@pytest.mark.parametrize("size", [0.5, 0.25, 0.1])
def test_a_cylinder_is_all_hexahedra_of_good_shape(size: float) -> None:
    mesh = cm.generate(ROD, O_GRID, size=size)
    quality = cm.quality(mesh)
    worst, mean = quality.scaled_jacobian.min(), quality.scaled_jacobian.mean()
    print(f"size {size}: {mesh.n_cells} hexahedra, scaled Jacobian {worst:.3f}, mean {mean:.3f}")
    assert list(mesh.cells) == ["hexahedron"]
    assert worst >= 0.8
    assert mean >= 0.94
    assert mesh.info["layers"] % 4 == 0
    assert mesh.names == cm.evaluate(ROD).names
    certificate = cm.check(mesh, ROD)
    assert certificate.ok, certificate


def test_names_and_surfaces_of_the_disks_at_the_ends() -> None:
    mesh = cm.generate(DISH, O_GRID, size=0.25)
    assert list(mesh.cells) == ["hexahedron"]
    assert cm.check(mesh, DISH).ok
    assert cm.quality(mesh).scaled_jacobian.min() > 0.5
    hollow = mesh.points[mesh.boundary_points("dish.side.disk")]
    np.testing.assert_allclose(np.linalg.norm(hollow - [0, 0, 3], axis=1), 1.5, atol=1e-13)
    floor = mesh.points[mesh.boundary_points("dish.side.box.bottom")]
    assert (floor[:, 2] == 0.0).all()


@pytest.mark.parametrize(
    "shape",
    [
        ROD.mirror((0, 0, 0), (1, 1, 0)),
        ROD.scale((1, 2, 1)).rotate(40, axis=(1, 1, 0)),
        cm.Revolve(cm.Disk((2, 0), 0.5)),
        cm.Revolve(cm.Polygon([(0, 0), (1, 0), (1, 1), (0, 1.3)])),
    ],
    ids=["mirrored", "placed", "off the axis", "cone"],
)
def test_o_grids_pass_every_check(shape: cm.Shape) -> None:
    mesh = cm.generate(shape, O_GRID, size=0.3)
    assert list(mesh.cells) == ["hexahedron"]
    assert cm.quality(mesh).scaled_jacobian.min() > 0.2
    certificate = cm.check(mesh, shape)
    assert certificate.ok, certificate


def test_the_size_may_vary_along_the_turn() -> None:
    mesh = cm.generate(ROD, O_GRID, size=lambda p: 0.3 + 0.1 * p[:, 0])
    assert cm.check(mesh, ROD).ok
    assert cm.quality(mesh).scaled_jacobian.min() > 0.2


REFUSED = [
    (lambda: cm.Sweep(axis="hexes"), cm.InputError, "axis"),
    (lambda: cm.Sweep(layers=6, axis="o-grid"), cm.InputError, "layers must be a multiple of 4"),
    (
        lambda: cm.generate(cm.Revolve(cm.Box((0, 0), (1, 2)), 90), O_GRID, size=0.5),
        cm.MeshingError,
        "needs a full turn; this one is of 90 degrees",
    ),
    (
        lambda: cm.generate(ROD, cm.Sweep(axis="o-grid"), size=0.5),
        cm.MeshingError,
        r"at \(0, 0, 0\) a triangle has a side on it",
    ),
    (
        lambda: cm.generate(
            cm.Revolve(cm.Polygon([(0, 0), (1, -1), (2, 0), (1, 1)])), O_GRID, size=0.5
        ),
        cm.MeshingError,
        r"at \(0, 0, 0\) a quad has a corner on it",
    ),
]


@pytest.mark.parametrize(("made", "error", "message"), REFUSED)
def test_refused_with_the_place(made, error, message: str) -> None:
    with pytest.raises(error, match=message):
        made()


def test_from_a_domain_file(tmp_path) -> None:
    file = tmp_path / "rod.yaml"
    file.write_text(
        "csgmesh: 1\n"
        "domain: {revolve: {shape: {box: {lo: [0, 0], hi: [1, 2]}}}}\n"
        "mesh: {sweep: {mesher: {structured: {}}, axis: o-grid}, size: 0.5}\n"
    )
    assert list(cm.load(file).generate().cells) == ["hexahedron"]

"""All-hexahedral meshes from a grid: valid cells, exact surfaces, names, volumes."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.mesh import Mesh
from csgmesh.meshers.hexahedra import hexahedral_mesh

CUBE = cm.Box((0, 0, 0), (1, 1, 1))
PLATE = cm.Box((0, 0, 0), (2, 2, 0.6), name="plate")
BRACKET = (
    (cm.Box((0, 0, 0), (4, 2, 0.5), name="plate") | cm.Box((0, 0, 0), (0.5, 2, 2), name="wall"))
    - cm.Cylinder((2.5, 1, -1), (2.5, 1, 2), 0.4, name="bore")
    - cm.Cylinder((-1, 1, 1.3), (2, 1, 1.3), 0.35, name="eye")
)

#: Solid, size, least scaled Jacobian asked for.
SMOOTH = {
    "ball": (cm.Ball((0, 0, 0), 1), 0.2),
    "coarse ball": (cm.Ball((0, 0, 0), 1), 0.35),
    "ellipsoid": (cm.Ellipsoid((1, 2, 3), (1, 0.7, 0.5)), 0.15),
    "torus": (cm.Torus((0, 0, 0), (0, 0, 1), 1, 0.4), 0.15),
}
SHARP = {
    "cylinder": (cm.Cylinder((0, 0, 0), (0, 0, 2), 1), 0.25),
    "leaning cylinder": (cm.Cylinder((0, 0, 0), (1, 1, 2), 0.6), 0.2),
    "turned box": (CUBE.rotate(30, (0, 0, 0), axis=(1, 2, 3)), 0.2),
    "cavity": (CUBE - cm.Ball((0.5, 0.5, 0.5), 0.3), 0.12),
    "bore": (CUBE - cm.Cylinder((0.5, 0.5, -1), (0.5, 0.5, 2), 0.25), 0.12),
    "bite": (CUBE - cm.Ball((0, 0, 1), 0.5), 0.12),
    "bracket": (BRACKET, 0.2),
    "boss": (PLATE | cm.Cylinder((1, 1, 0.3), (1, 1, 1.2), 0.5, name="boss"), 0.15),
    "knob": (PLATE | cm.Ball((1, 1, 0.6), 0.5, name="knob"), 0.15),
    "cone": (PLATE | cm.Cone((1, 1, 0.6), (1, 1, 1.4), 0.5, 0.2, name="cone"), 0.15),
    "apex": (cm.Cone((0, 0, 0), (0, 0, 1), 0.6, 0), 0.08),
    "corner": (CUBE | cm.Ball((1, 1, 1), 0.4, name="ball"), 0.12),
    "tee": (
        cm.Cylinder((-1.2, 0, 0), (1.2, 0, 0), 0.5) | cm.Cylinder((0, 0, 0), (0, 0, 1), 0.35),
        0.15,
    ),
    "pocket": (PLATE - cm.Cylinder((1, 1, 0.3), (1, 1, 1), 0.5, name="pocket"), 0.15),
}


def meshed(shape: cm.Shape, size: float, **options: int) -> Mesh:
    domain = cm.evaluate(shape)
    return hexahedral_mesh(domain, lambda points: np.full(len(points), size), **options)


@pytest.mark.parametrize("name", [*SMOOTH, *SHARP])
def test_hexahedra_pass_every_check(name: str) -> None:
    shape, size = (SMOOTH | SHARP)[name]
    mesh = meshed(shape, size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, certificate
    assert list(mesh.cells) == ["hexahedron"]
    assert mesh.names == cm.evaluate(shape).names
    quality = cm.quality(mesh)
    assert quality.min_jacobian.min() > 0
    assert quality.scaled_jacobian.min() >= (0.2 if name in SMOOTH else 0.1)
    assert quality.scaled_jacobian.mean() >= 0.8
    assert mesh.info["lost_corners"] == 0


def test_boxes_are_met_exactly() -> None:
    step = cm.Box((0, 0, 0), (3, 1, 1), name="low") | cm.Box((0, 0, 0), (1.3, 1, 2.1), name="high")
    mesh = meshed(step, 0.25)
    assert cm.check(mesh, step).ok
    np.testing.assert_allclose(cm.quality(mesh).scaled_jacobian, 1.0, atol=1e-12)
    assert cm.quality(mesh).total_volume == pytest.approx(3.0 + 1.3 * 1.1, abs=1e-12)


def test_sharp_edges_are_kept() -> None:
    shape, size = SHARP["bore"]
    mesh = meshed(shape, size)
    rim = np.intersect1d(mesh.boundary_points("cylinder.side"), mesh.boundary_points("box.top"))
    x, y, z = mesh.points[rim].T
    assert len(rim) >= 12
    np.testing.assert_allclose(np.hypot(x - 0.5, y - 0.5), 0.25, atol=1e-12)
    np.testing.assert_array_equal(z, 1.0)
    corners = {tuple(p) for p in mesh.points.tolist()}
    assert {
        (float(a), float(b), float(c)) for a in (0, 1) for b in (0, 1) for c in (0, 1)
    } < corners


def test_two_materials_share_their_interface() -> None:
    hard = cm.Ball((1, 1, 1), 0.6, name="ball")
    regions = cm.Regions({"soft": cm.Box((0, 0, 0), (2, 2, 2)), "hard": hard})
    mesh = hexahedral_mesh(cm.evaluate(regions), lambda points: np.full(len(points), 0.2))
    assert cm.check(mesh, regions).ok
    assert cm.quality(mesh).scaled_jacobian.min() >= 0.2
    shared = mesh.interface("soft", "hard")["quad"]
    assert len(shared) > 100
    np.testing.assert_array_equal(shared, mesh.boundary("ball")["quad"])


def test_cells_far_from_curved_faces_stay_cubes() -> None:
    mesh = meshed(CUBE - cm.Ball((0, 0, 0), 0.3), 0.05)
    far = (mesh.points[mesh.cells["hexahedron"]].mean(axis=1) ** 2).sum(axis=1) > 0.65**2
    assert far.sum() > 4_000
    np.testing.assert_allclose(cm.quality(mesh).scaled_jacobian[far], 1.0, atol=1e-12)


def test_reentrant_edges_are_kept() -> None:
    shape, size = SHARP["boss"]
    mesh = meshed(shape, size)
    foot = np.intersect1d(mesh.boundary_points("boss.side"), mesh.boundary_points("plate.top"))
    x, y, z = mesh.points[foot].T
    assert len(foot) >= 16
    np.testing.assert_allclose(np.hypot(x - 1, y - 1), 0.5, atol=1e-12)
    np.testing.assert_allclose(z, 0.6, atol=1e-15)


def test_meshes_are_the_same_every_time() -> None:
    shape, size = SMOOTH["ball"]
    assert meshed(shape, size).equals(meshed(shape, size))


def test_budgets_are_kept() -> None:
    with pytest.raises(cm.BudgetError, match="max_points"):
        meshed(CUBE, 0.1, max_points=500)
    with pytest.raises(cm.BudgetError, match="max_points"):
        meshed(CUBE, 0.01, max_points=500)


def test_what_cannot_be_meshed_is_refused_with_a_place() -> None:
    thin = cm.Ball((0, 0, 0), 1) - cm.Ball((0, 0, 0), 0.99)
    with pytest.raises(cm.MeshingError, match=r"size 0\.4 .*\(.*, .*, .*\)"):
        meshed(thin, 0.4)
    touching = CUBE | cm.Box((1, 1, 0), (2, 2, 1))
    with pytest.raises(cm.MeshingError, match=r"touches itself at \(1, 1, 0\.5\)"):
        meshed(touching, 0.5)
    with pytest.raises(cm.SizeError, match="positive"):
        meshed(CUBE, 0.0)

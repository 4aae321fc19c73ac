"""All quads by pairing triangles: never a triangle, never a fold, few irregular vertices."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.domain.input_angles import input_angles
from csgmesh.errors import BudgetError, InputError
from csgmesh.meshers.quad_pairing.coarse import joined_chords

sys.path.append(str(Path(__file__).parents[1] / "corpus"))
from glyphs import drawable, outline
from seeded_trees import domain as seeded_tree

TWO_DISKS = cm.Box((0, 0), (1, 1)) - cm.Disk((0.3, 0.3), 0.15) - cm.Disk((0.7, 0.7), 0.15)
INCLUSION = cm.Regions(
    {"rock": cm.Box((0, 0), (1, 1), name="b"), "core": cm.Disk((0.4, 0.5), 0.2, name="bond")}
)


def meshed(shape, size=None, **options) -> cm.Mesh:
    mesh = cm.generate(shape, cm.QuadPairing(**options), size=size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, str(certificate)
    assert list(mesh.cells) == ["quad"]
    return mesh


def irregular(mesh: cm.Mesh) -> float:
    """Share of inner vertices without four quads."""
    inner = np.ones(mesh.n_points, bool)
    inner[mesh.facets["line"]] = False
    n_quads = np.bincount(mesh.cells["quad"].ravel(), minlength=mesh.n_points)
    return float((n_quads[inner] != 4).mean())


def test_square_minus_two_disks() -> None:
    # Gmsh's four algorithms reach 0.43 to 0.67, and 0.92 to 0.98 on average.
    quality = cm.quality(meshed(TWO_DISKS, 0.03))
    assert quality.sicn.min() >= 0.67
    assert quality.sicn.mean() >= 0.95


def test_a_square_has_no_irregular_vertex_and_a_disk_few() -> None:
    square = meshed(cm.Box((0, 0), (1, 1)), 0.03)
    assert irregular(square) == 0
    assert cm.quality(square).sicn.min() > 1 - 1e-9
    assert irregular(meshed(cm.Disk((0, 0), 1), 0.04)) <= 0.05


@pytest.mark.parametrize("size", [None, 0.06, {"bond": 0.01, "default": 0.06}])
def test_regions_names_and_sizes(size) -> None:
    mesh = meshed(INCLUSION, size)
    assert mesh.names == cm.generate(INCLUSION, size=0.2).names
    assert set(np.unique(mesh.cell_region["quad"])) == {0, 1}
    if isinstance(size, dict):
        bond = mesh.facets["line"][mesh.boundary("bond")["line"]]
        edge = np.hypot(*(mesh.points[bond[:, 1]] - mesh.points[bond[:, 0]]).T)
        assert edge.min() > 0.006
        assert edge.max() < 0.014
    if size == 0.06:
        lengths = cm.quality(mesh).max_edge
        assert 0.6 * size < np.median(lengths) < 1.4 * size


def test_embedded_paths_and_points_stay() -> None:
    crack = cm.EmbeddedPath([(0.2, 0.2), (0.5, 0.6)], name="crack")
    probe = cm.EmbeddedPoints([(0.7, 0.3)], name="probe")
    shape = cm.Embed(cm.Box((0, 0), (1, 1)), [crack, probe])
    mesh = meshed(shape, 0.1)
    assert (mesh.points[mesh.boundary_points("probe")] == (0.7, 0.3)).all()
    assert len(mesh.boundary("crack")["line"]) >= 4


def sharp_cells(mesh: cm.Mesh, domain: cm.Pslg) -> np.ndarray:
    """Quads at input angles below 60 degrees, or in their shells."""
    near = np.zeros(mesh.n_points, bool)
    for apex, _, radius in zip(*input_angles(domain), strict=True):
        near |= np.hypot(*(mesh.points - apex).T) <= radius * (1 + 1e-3)
    return near[mesh.cells["quad"]].any(axis=1)


def test_glyphs_and_random_trees() -> None:
    shapes = [outline("DejaVuSans", i) for i in list(drawable("DejaVuSans"))[4::600]]
    shapes += [seeded_tree(seed) for seed in (225, 245, 420)]
    jacobian, sicn = [], []
    for k, shape in enumerate(shapes):
        domain = cm.evaluate(shape)
        mesh = meshed(domain, domain.diagonal / 50 if k % 2 else None)
        quality = cm.quality(mesh)
        jacobian.append(quality.scaled_jacobian)
        sicn.append(quality.sicn.mean())
    assert np.concatenate(jacobian).min() > 0
    assert (np.concatenate(jacobian) >= 0.3).mean() >= 0.99
    assert np.mean(sicn) >= 0.85


def test_quads_at_sharp_input_angles_are_excused_and_counted() -> None:
    wedge = cm.Triangle((0, 0), (2, 0), (2, 0.4))
    mesh = meshed(wedge, 0.1)
    assert mesh.info["excused"] >= 1
    at = np.flatnonzero((mesh.points == 0).all(axis=1))
    worst = np.argsort(cm.quality(mesh).scaled_jacobian)[: mesh.info["excused"]]
    assert np.isin(mesh.cells["quad"][worst], at).any(axis=1).all()


def test_between_curves_that_touch_no_quad_folds() -> None:
    shape = cm.Disk((0, 0), 1) - cm.Disk((0.5, 0), 0.5)
    mesh = meshed(shape, 0.07)
    assert cm.quality(mesh).scaled_jacobian.min() > 0


def test_joined_chords_leave_every_corner_and_name() -> None:
    domain = cm.evaluate(INCLUSION)
    joined = joined_chords(domain)
    assert joined.n_segments == 4 + 25
    assert joined.areas() == pytest.approx(domain.areas(), rel=1e-12)


def test_the_same_bytes() -> None:
    first, second = (cm.generate(TWO_DISKS, cm.QuadPairing(), size=0.05) for _ in range(2))
    assert first.equals(second)


def test_errors() -> None:
    with pytest.raises(InputError, match=r"sweeps must be a whole number, at least 0; got 1\.5"):
        cm.QuadPairing(sweeps=1.5)
    with pytest.raises(InputError, match="min_angle must be between 0 and 34 degrees; got '30'"):
        cm.QuadPairing(min_angle="30")
    with pytest.raises(InputError, match="min_angle must be between"):
        cm.QuadPairing(min_angle=40)
    with pytest.raises(InputError, match="sweeps"):
        cm.QuadPairing(sweeps=-1)
    with pytest.raises(BudgetError):
        cm.generate(TWO_DISKS, cm.QuadPairing(max_points=200), size=0.01)


def test_domain_file(tmp_path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text(
        "{csgmesh: 1, domain: {disk: {center: [0, 0], radius: 1}}, "
        "mesh: {quad_pairing: {sweeps: 3}, size: 0.2}}"
    )
    assert list(cm.load(path).generate().cells) == ["quad"]


@pytest.mark.parametrize("mesher", [cm.QuadPairing(), cm.Structured()])
def test_periodic_sides_are_refused(mesher) -> None:
    cell = cm.Periodic(cm.Box((0, 0), (1, 1), name="c"), [("c.left", "c.right")])
    with pytest.raises(InputError, match="periodic sides alike; use DelaunayRefinement"):
        cm.generate(cell, mesher, size=0.2)

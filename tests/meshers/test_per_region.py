"""A mesher a region: the parts fit together."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.errors import DomainFileError, InputError, MeshingError

INCLUSION = cm.Regions(
    {"rock": cm.Box((0, 0), (2, 1), name="b"), "core": cm.Disk((1, 0.5), 0.25, name="bond")}
)
THREE = cm.Regions(
    {
        "a": cm.Box((0, 0), (1, 1)),
        "b": cm.Box((1, 0), (2, 1)),
        "c": cm.Box((2, 0), (3, 1)) - cm.Disk((2.5, 0.5), 0.2),
    }
)
GRID, QUADS, TRIANGLES = cm.Structured(), cm.QuadPairing(), cm.DelaunayRefinement()

CASES = {
    "grid inside": (INCLUSION, cm.PerRegion({"core": GRID}), 0.06),
    "grid outside": (INCLUSION, cm.PerRegion({"rock": GRID}), 0.06),
    "quads inside": (INCLUSION, cm.PerRegion({"core": QUADS}), 0.06),
    "quads outside": (INCLUSION, cm.PerRegion({"rock": QUADS}), 0.06),
    "all three": (THREE, cm.PerRegion({"a": GRID, "b": TRIANGLES}, default=QUADS), 0.08),
    "coarse grid": (INCLUSION, cm.PerRegion({"core": GRID}), {"core": 0.1, "rock": 0.02}),
    "fine grid": (INCLUSION, cm.PerRegion({"core": GRID}), {"core": 0.02, "rock": 0.15}),
}


@pytest.mark.parametrize("name", CASES)
def test_cases(name: str) -> None:
    shape, mesher, size = CASES[name]
    mesh = cm.generate(shape, mesher, size=size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, str(certificate)
    assert mesh.names == cm.generate(shape, size=0.2).names
    assert mesh.region_names == cm.evaluate(shape).region_names


def test_cells_are_of_the_region_s_kind() -> None:
    mesh = cm.generate(INCLUSION, CASES["grid inside"][1], size=0.06)
    assert set(mesh.cell_region["quad"]) == {1}
    assert set(mesh.cell_region["triangle"]) == {0}
    assert next(iter(mesh.blocks)) == "core"
    assert len(mesh.interface("rock", "core")["line"]) >= 26
    # Where both want the same size nothing is thin.
    assert cm.quality(mesh).min_angle.min() > 25


def test_the_same_mesher_for_all_gives_the_same_mesh() -> None:
    mesh = cm.generate(INCLUSION, cm.PerRegion({"rock": TRIANGLES, "core": TRIANGLES}), size=0.1)
    other = cm.generate(INCLUSION, TRIANGLES, size=0.1)
    assert mesh.n_cells == other.n_cells


def test_layers_in_one_region() -> None:
    walls = cm.DelaunayRefinement(layers={"b.bottom": cm.Layers(0.01, n=5)})
    mesh = cm.generate(INCLUSION, cm.PerRegion({"core": GRID, "rock": walls}), size=0.08)
    assert cm.check(mesh, INCLUSION).ok
    assert set(mesh.cell_region["quad"]) == {0, 1}


def test_embedded_points() -> None:
    shape = cm.Embed(INCLUSION, [cm.EmbeddedPoints([(0.3, 0.3)], name="probe")])
    mesh = cm.generate(shape, cm.PerRegion({"core": GRID}), size=0.08)
    assert cm.check(mesh, shape).ok
    assert len(mesh.boundary_points("probe")) == 1


def test_errors() -> None:
    with pytest.raises(MeshingError, match=r"QuadPairing needs a vertex at .*DelaunayRefinement"):
        cm.generate(INCLUSION, cm.PerRegion({"core": GRID, "rock": QUADS}), size=0.06)
    with pytest.raises(InputError, match="mesher of 'core' must be an object"):
        cm.PerRegion({"core": cm.Structured})
    with pytest.raises(InputError, match="no region matches 'cor'; did you mean 'core'"):
        cm.generate(INCLUSION, cm.PerRegion({"cor": GRID}), size=0.1)


def test_domain_file(tmp_path) -> None:
    text = """
csgmesh: 1
regions:
  rock: {box: {lo: [0, 0], hi: [2, 1]}}
  core: {disk: {center: [1, 0.5], radius: 0.25}}
mesh:
  per_region:
    core: {structured: {counts: {disk: 64}}}
    rock: {delaunay_refinement: {min_angle: 25}}
  size: 0.1
"""
    path = tmp_path / "a.yaml"
    path.write_text(text)
    mesh = cm.load(path).generate()
    assert len(mesh.interface("rock", "core")["line"]) == 64
    for old, new, place in (
        ("core: {structured:", "cor: {structured:", "a.yaml:8:5"),
        ("counts:", "count:", "a.yaml:8:25"),
        ("min_angle: 25", "min_angle: 50", "a.yaml:9:45"),
        ("{structured: {counts: {disk: 64}}}", "{}", "a.yaml:8:11"),
    ):
        path.write_text(text.replace(old, new))
        with pytest.raises(DomainFileError, match=place):
            cm.load(path).generate()
    assert np.isin(["core", "rock"], mesh.region_names).all()

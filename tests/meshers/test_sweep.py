"""Sweeps of planar meshes: valid cells, exact surfaces, names, volumes."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

WASHER = cm.Extrude(cm.Disk((0, 0), 2, name="rim") - cm.Disk((0, 0), 1, name="bore"), 0.5)
BOWL = cm.Revolve(cm.Disk((0, 2), 2) - cm.Disk((0, 2), 1.5) - cm.HalfSpace((0, 2), (0, -1)))
SOLIDS = {
    "washer": WASHER,
    "bowl": BOWL,
    "quarter": cm.Revolve(cm.Box((0, 0), (1, 2)), 90, name="quarter"),
    "ring": cm.Revolve(cm.Disk((2, 0), 0.5), name="ring"),
    "three quarters": cm.Revolve(cm.Polygon([(0.2, 0), (2, 0), (1, 1)]), 270),
    "cylinder": cm.Cylinder((0, 0, 0), (1, 2, 2), 0.5, name="rod"),
    "box": cm.Box((0, 0, 0), (2, 1, 1), name="beam"),
    "moved": WASHER.rotate(30, axis=(1, 1, 0)).translate((5, 0, 1)),
    "mirrored": BOWL.mirror((0, 0, 0), (1, 1, 0)),
    "stretched": WASHER.scale((1, 2, 3)),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_sweeps_pass_every_check(name: str) -> None:
    shape = SOLIDS[name]
    mesh = cm.generate(shape, cm.Sweep(), size=0.3)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, certificate
    assert mesh.names == cm.evaluate(shape).names
    assert cm.quality(mesh).min_jacobian.min() > 0


@pytest.mark.parametrize(
    "shape", [cm.Box((0, 0, 0), (2, 1, 1)), cm.Extrude(cm.Box((0, 0), (2, 1)), 1)]
)
def test_quads_become_hexahedra(shape: cm.Shape) -> None:
    mesh = cm.generate(shape, cm.Sweep(cm.Structured(), layers=4), size=0.25)
    assert list(mesh.cells) == ["hexahedron"]
    assert mesh.n_cells == 8 * 4 * 4
    assert cm.check(mesh, shape).ok
    np.testing.assert_allclose(cm.quality(mesh).scaled_jacobian, 1.0, atol=1e-12)
    assert cm.quality(mesh).total_volume == pytest.approx(2.0, abs=1e-13)


def test_cells_at_the_axis() -> None:
    shape = cm.Revolve(cm.Box((0, 0), (1, 2)), 120)
    quads = cm.generate(shape, cm.Sweep(cm.Structured()), size=0.25)
    assert set(quads.cells) == {"hexahedron", "wedge"}
    triangles = cm.generate(shape, cm.Sweep(), size=0.25)
    assert set(triangles.cells) == {"wedge", "pyramid", "tetra"}
    for mesh in (quads, triangles):
        assert cm.check(mesh, shape).ok
        on_axis = np.hypot(*mesh.points[:, :2].T) == 0.0
        # One vertex for each place on the axis, not one a layer.
        assert len(np.unique(mesh.points[on_axis, 2])) == on_axis.sum()


def test_a_quad_with_a_corner_on_the_axis_becomes_two_pyramids() -> None:
    diamond = cm.Polygon([(0, 0), (1, -1), (2, 0), (1, 1)], name="diamond")
    flat = cm.Structured()
    shape = cm.Revolve(diamond)
    mesh = cm.generate(shape, cm.Sweep(flat), size=0.5)
    assert "pyramid" in mesh.cells
    assert cm.check(mesh, shape).ok


def test_volume_converges_to_the_exact_one() -> None:
    rod = cm.Cylinder((0, 0, 0), (0, 0, 0.2), 1)
    off = [
        0.2 * np.pi - cm.quality(cm.generate(rod, cm.Sweep(), size=h)).total_volume
        for h in (0.16, 0.08, 0.04)
    ]
    # The area between chords and circle falls with the square of the size.
    assert 0 < off[2] < 0.2 * off[0]


def test_layers_follow_the_size() -> None:
    beam = cm.Box((0, 0, 0), (1, 1, 3))
    assert cm.generate(beam, cm.Sweep(), size=0.25).info["layers"] == 12
    assert cm.generate(beam, cm.Sweep(layers=5), size=0.25).info["layers"] == 5
    long = cm.generate(beam.scale((1, 1, 2)), cm.Sweep(), size=0.25)
    assert long.info["layers"] >= 24


def test_sizes_by_name_and_by_place() -> None:
    def edges(mesh: cm.Mesh, name: str) -> np.ndarray:
        found = []
        for kind, rows in mesh.boundary(name).items():
            corners = mesh.points[mesh.facets[kind][rows]]
            found.append(np.sqrt(((corners[:, 1] - corners[:, 0]) ** 2).sum(axis=1)))
        return np.concatenate(found)

    size = {"extrude.side.bore": 0.1, "default": 0.4}
    by_name = cm.generate(WASHER, cm.Sweep(), size=size)
    assert np.median(edges(by_name, "extrude.side.bore")) < 0.15
    assert np.median(edges(by_name, "extrude.side.rim")) > 0.25

    by_place = cm.generate(WASHER, cm.Sweep(), size=lambda p: 0.1 + 0.2 * (p[:, 0] > 0))
    assert by_place.n_cells > cm.generate(WASHER, cm.Sweep(), size=0.3).n_cells


def heights(mesh: cm.Mesh) -> np.ndarray:
    """Thickness of each layer of an extrusion along z."""
    return np.diff(np.unique(mesh.points[:, 2]))


BEAM = cm.Extrude(cm.Box((0, 0), (1, 1)), 4, name="beam")


@pytest.mark.parametrize("made", [lambda h: h, lambda h: cm.minimum(h, 0.5)])
def test_layers_follow_a_size_that_varies_along_the_sweep(made) -> None:
    size = made(lambda p: 0.05 + 0.1 * p[:, 2])
    mesh = cm.generate(BEAM, cm.Sweep(cm.Structured()), size=size)
    thick = heights(mesh)
    middle = np.unique(mesh.points[:, 2])[:-1] + thick / 2
    # The integral of 1 / h is 10 log 9.
    assert mesh.info["layers"] == len(thick) == 22
    assert (np.diff(thick) > 0).all()
    np.testing.assert_allclose(thick, 0.05 + 0.1 * middle, rtol=0.02)
    assert cm.check(mesh, BEAM).ok
    # Where the number is given, too, the layers are as thick as the size in proportion.
    fewer = heights(cm.generate(BEAM, cm.Sweep(cm.Structured(), layers=11), size=size))
    assert len(fewer) == 11
    np.testing.assert_allclose(fewer, thick[::2] + thick[1::2], rtol=1e-9)


def test_a_size_of_an_end_makes_its_layers_thin() -> None:
    size = {"beam.start": 0.01, "beam.end": 0.03, "default": 0.5}
    mesh = cm.generate(BEAM, cm.Sweep(cm.Structured()), size=size)
    thick = heights(mesh)
    assert 0.009 < thick[0] < 0.0125
    assert 0.025 < thick[-1] < 0.04
    assert 0.4 < thick.max() < 0.51
    ratio = thick[1:] / thick[:-1]
    assert ratio.max() < 1.37
    assert ratio.min() > 1 / 1.37
    assert cm.check(mesh, BEAM).ok
    only_there = heights(cm.generate(BEAM, cm.Sweep(cm.Structured()), size={"beam.end": 0.03}))
    assert only_there[-1] < 0.04


def test_layers_of_a_turn_follow_the_size() -> None:
    ring = cm.Revolve(cm.Disk((2, 0), 0.5), name="ring")
    mesh = cm.generate(ring, cm.Sweep(), size=lambda p: 0.15 + 0.1 * (p[:, 0] < 0) * -p[:, 0])
    assert cm.check(mesh, ring).ok
    turn = np.unique(np.degrees(np.arctan2(mesh.points[:, 1], mesh.points[:, 0])).round(9))
    thick = np.diff(turn)
    assert thick[turn[:-1] < -170].max() > 1.5 * thick[np.abs(turn[:-1]) < 40].max()
    # At the rim, 2.5 from the axis, no edge is longer than wanted where the size is smallest.
    assert np.radians(thick).min() * 2.5 < 0.15 * 1.01


def test_a_size_that_varies_across_alone_leaves_layers_even() -> None:
    mesh = cm.generate(BEAM, cm.Sweep(), size=lambda p: 0.25 + 0.25 * p[:, 0])
    np.testing.assert_allclose(heights(mesh), 0.25, rtol=1e-9)


def test_facets_carry_the_names_of_their_parts() -> None:
    mesh = cm.generate(WASHER, cm.Sweep(), size=0.3)
    for name, z in (("extrude.start", 0.0), ("extrude.end", 0.5)):
        points = mesh.points[mesh.boundary_points(name)]
        assert (points[:, 2] == z).all()
    bore = mesh.points[mesh.boundary_points("extrude.side.bore")]
    np.testing.assert_allclose(np.hypot(*bore[:, :2].T), 1.0, atol=1e-14)


def test_the_same_bytes_every_time() -> None:
    first, second = (cm.generate(BOWL, cm.Sweep(), size=0.4) for _ in range(2))
    assert first.equals(second)


REFUSED = [
    (
        lambda: cm.generate(WASHER, cm.Sweep(max_points=100), size=0.1),
        cm.MeshingError,
        "max_points",
    ),
    (
        lambda: cm.generate(WASHER, cm.Sweep(layers=10**9), size=0.5),
        cm.BudgetError,
        "1000000000 layers of .* max_points is 10000000",
    ),
    (
        lambda: cm.generate(WASHER, cm.Sweep(), size={"extrude.start": 0.0, "default": 1}),
        cm.SizeError,
        "size of 'extrude.start' must be positive",
    ),
    (
        lambda: cm.generate(WASHER, cm.Sweep(), size=lambda p: 0.3 - p[:, 2]),
        cm.SizeError,
        "positive",
    ),
    (lambda: cm.Sweep(layers=0), cm.InputError, "layers must be at least 1; got 0"),
    (lambda: cm.Sweep(layers=2.5), cm.InputError, "layers must be a whole number; got 2.5"),
    (lambda: cm.Sweep(mesher=3), cm.InputError, "mesher must be a mesher of the plane"),
    (
        lambda: cm.generate(WASHER - cm.Ball((2, 0, 0), 1), cm.Sweep()),
        cm.MeshingError,
        "this solid is a combination",
    ),
    (
        lambda: cm.generate(cm.Disk((0, 0), 1), cm.Sweep()),
        cm.InputError,
        "Sweep meshes domains in space",
    ),
    (
        lambda: cm.generate(WASHER, cm.DelaunayRefinement()),
        cm.InputError,
        "Sweep extrusions",
    ),
    (lambda: cm.generate(WASHER, cm.Sweep(), size=0), cm.SizeError, "positive"),
    (
        lambda: cm.generate(WASHER, cm.Sweep(), size={"rimm": 0.1, "default": 1}),
        cm.NameLookupError,
        "rimm",
    ),
]


@pytest.mark.parametrize(("made", "error", "message"), REFUSED)
def test_refused_with_the_rule(made, error, message: str) -> None:
    with pytest.raises(error, match=message):
        made()


def test_from_a_domain_file(tmp_path) -> None:
    file = tmp_path / "washer.yaml"
    file.write_text(
        "csgmesh: 1\n"
        "domain: {extrude: {shape: {disk: {center: [0, 0], radius: 1}}, height: 0.5}}\n"
        "mesh: {sweep: {layers: 2}, size: 0.3}\n"
    )
    mesh = cm.load(file).generate()
    assert mesh.info["layers"] == 2
    assert set(mesh.cells) == {"wedge"}


WASHER_FILE = """csgmesh: 1
domain: {extrude: {shape: {disk: {center: [0, 0], radius: 1}}, height: 0.5}}
mesh:
  sweep:
    mesher:
      MESHER
    layers: 2
  size: 0.3
"""


def test_a_nested_mesher_from_a_domain_file(tmp_path) -> None:
    file = tmp_path / "washer.yaml"
    file.write_text(WASHER_FILE.replace("MESHER", "quad_pairing: {}"))
    mesh = cm.load(file).generate()
    assert set(mesh.cells) == {"hexahedron"}
    assert mesh.info["profile"] == "QuadPairing"


@pytest.mark.parametrize(
    ("mesher", "message"),
    [
        ("quad_pairing: {pairs: 3}", r"washer.yaml:6:22: .*pairs"),
        ("sweep: {}", r"washer.yaml:6:7: mesher must be a mesher of the plane"),
        ("delaunay_refinement: {min_angle: 90}", r"washer.yaml:6:\d+: .*min_angle"),
        ("quad_paring: {}", r"washer.yaml:6:7: .*quad_paring"),
    ],
)
def test_a_nested_mesher_is_refused_with_its_line(tmp_path, mesher: str, message: str) -> None:
    file = tmp_path / "washer.yaml"
    file.write_text(WASHER_FILE.replace("MESHER", mesher))
    with pytest.raises(cm.DomainFileError, match=message):
        cm.load(file)


def test_the_schema_knows_nested_meshers() -> None:
    from csgmesh.domainfile import json_schema

    parts = json_schema()["$defs"]
    sweep = parts["SweepArguments"]["anyOf"][0]["properties"]
    region = parts["PerRegionArguments"]["anyOf"][0]["properties"]
    for field in (sweep["mesher"], region["default"]):
        assert field["$ref"].endswith("/MesherChoice")

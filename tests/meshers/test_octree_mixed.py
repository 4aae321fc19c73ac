"""Hexahedra inside, pyramids around them, tetrahedra up to the surface."""

import numpy as np
import pytest

import csgmesh as cm

BOX = cm.Box((0, 0, 0), (2, 2, 2), name="plate")
BALL = cm.Ball((0.7, 0.7, 0.7), 0.4, name="ball")
SOLID = BOX - BALL - cm.Cylinder((1.4, 1.4, -1), (1.4, 1.4, 3), 0.3, name="bore")
MIXED = cm.Octree(cells="mixed")


def shares(mesh):
    """Share of the volume in each kind of cell."""
    volume = cm.quality(mesh).volume
    ends = np.cumsum([len(rows) for rows in mesh.cells.values()])
    parts = np.split(volume, ends[:-1])
    return {k: v.sum() / volume.sum() for k, v in zip(mesh.cells, parts, strict=True)}


def test_the_inside_is_hexahedra_and_the_whole_conforms():
    mesh = cm.generate(SOLID, MIXED, size=0.1)
    assert list(mesh.cells) == ["hexahedron", "pyramid", "tetra"]
    certificate = cm.check(mesh, SOLID)
    assert certificate.ok, certificate.failures
    assert mesh.names == cm.evaluate(SOLID).names
    share = shares(mesh)
    assert share["hexahedron"] > 0.4
    assert share["tetra"] < 0.5
    quality = cm.quality(mesh)
    exact = 8 - 4 / 3 * np.pi * 0.4**3 - 2 * np.pi * 0.3**2
    assert abs(quality.total_volume / exact - 1) < 2e-3
    assert quality.min_dihedral.min() > 15
    assert np.nanmin(quality.scaled_jacobian) > 1 - 1e-12
    assert np.array_equal(
        np.unique(np.concatenate([r.ravel() for r in mesh.cells.values()])),
        np.arange(mesh.n_points),
    )
    again = cm.generate(SOLID, MIXED, size=0.1)
    for kind, rows in mesh.cells.items():
        assert rows.tobytes() == again.cells[kind].tobytes()


def test_what_meshes_are_for_works_on_mixed_ones(tmp_path):
    mesh = cm.generate(BOX, MIXED, size=0.25)
    points = np.random.default_rng(1).uniform(-0.5, 2.5, (5000, 3))
    values = mesh.interpolate(mesh.points @ [1.0, 2.0, 3.0], points)
    inside = mesh.locate(points) >= 0
    assert (inside == BOX.contains(points)).all()
    assert np.abs(values - points @ [1.0, 2.0, 3.0])[inside].max() < 1e-12
    fine = cm.refine(mesh)
    assert fine.n_cells == 8 * (len(mesh.cells["hexahedron"]) + len(mesh.cells["tetra"])) + (
        10 * len(mesh.cells["pyramid"])
    )
    assert cm.check(fine, BOX).ok
    for name in ("part.msh", "part.vtu", "part.inp"):
        cm.write(tmp_path / name, mesh)
        read = cm.read(tmp_path / name)
        assert {k: len(v) for k, v in read.cells.items()} == {
            k: len(v) for k, v in mesh.cells.items()
        }
        assert set(read.names) == set(mesh.names)
    with pytest.raises(cm.InputError, match=r"one kind.*got \['hexahedron', 'pyramid', 'tetra'\]"):
        cm.to_skfem(mesh)


def test_materials_keep_their_cells_where_sizes_vary():
    core = cm.Ball((1, 1, 1), 0.7, name="core")
    regions = cm.Regions({"soft": BOX, "hard": core})
    mesh = cm.generate(regions, MIXED, size={"core": 0.1, "default": 0.2})
    assert cm.check(mesh, regions).ok
    hexahedra, materials = mesh.cells["hexahedron"], mesh.cell_region["hexahedron"]
    assert set(materials) == {0, 1}
    radius = np.linalg.norm(mesh.points[hexahedra] - 1, axis=2)
    assert ((radius < 0.7).all(axis=1) == (materials == 1)).all()


def test_one_size_stays_one_where_the_boundary_needs_a_little_less():
    core = cm.Ball((1, 1, 1), 0.6)
    mesh = cm.generate(cm.Regions({"soft": BOX, "hard": core}), MIXED, size=0.12)
    assert shares(mesh)["hexahedron"] > 0.4
    sides = np.ptp(mesh.points[mesh.cells["hexahedron"]], axis=1)
    assert 0.5 * 0.12 < sides.min() <= sides.max() < sides.min() + 1e-12


def test_solids_without_room_for_a_hexahedron_are_tetrahedra():
    bar = cm.Box((0, 0, 0), (1, 0.2, 0.2))
    mesh = cm.generate(bar, MIXED, size=0.2)
    assert list(mesh.cells) == ["tetra"]
    assert cm.check(mesh, bar).ok


def test_domain_files_ask_for_mixed_cells(tmp_path):
    path = tmp_path / "part.yaml"
    path.write_text(
        "csgmesh: 1\ndomain: {box: {lo: [0, 0, 0], hi: [1, 1, 1]}}\n"
        "mesh: {octree: {cells: mixed}, size: 0.125}\nexpect: {volume: 1}\n"
    )
    file = cm.load(path)
    assert file.mesher == MIXED
    assert list(file.generate().cells) == ["hexahedron", "pyramid", "tetra"]

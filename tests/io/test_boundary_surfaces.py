"""Boundaries of meshes of space for other programs: closed, outward, named where they can be."""

import sys
import types

import numpy as np
import pytest
import trimesh

import csgmesh as cm

PIPE = cm.Extrude(cm.Disk((0, 0), 2, name="rim") - cm.Disk((0, 0), 1, name="bore"), 3, name="pipe")
NAMES = {"pipe.start", "pipe.end", "pipe.side.rim", "pipe.side.bore"}


@pytest.fixture(scope="module")
def wedges():
    return cm.generate(PIPE, cm.Sweep(), size=0.6)


@pytest.fixture(scope="module")
def hexes():
    return cm.generate(PIPE, cm.Sweep(cm.QuadPairing()), size=0.6)


@pytest.fixture(scope="module")
def two():
    """Two cubes of different materials, one upon the other."""
    points = [(x, y, z) for z in (0, 1, 2) for y in (0, 1) for x in (0, 1)]
    cell = np.array([0, 1, 3, 2, 4, 5, 7, 6])
    return cm.Mesh(
        points,
        {"hexahedron": [cell + 4, cell]},
        {"hexahedron": [1, 0]},
        ["lower", "upper"],
        facets={"quad": [[0, 2, 3, 1], [4, 5, 7, 6]]},
        facet_marker={"quad": [0, 1]},
        facet_region={"quad": [[0, -1], [0, 1]]},
        boundary_names=[["floor"], ["seam"]],
    )


@pytest.mark.parametrize("kind", ["wedges", "hexes"])
def test_trimesh_gets_a_closed_surface_with_names(kind, request):
    mesh = request.getfixturevalue(kind)
    surface = cm.to_trimesh(mesh)
    assert surface.is_watertight and surface.is_winding_consistent
    facets = sum(len(rows) * (len(rows[0]) - 2) for rows in mesh.facets.values())
    assert len(surface.faces) == facets
    assert surface.volume == pytest.approx(9 * np.pi, rel=0.05)
    names = surface.metadata["boundary_names"]
    marker = surface.face_attributes["marker"]
    assert {n for m in np.unique(marker) for n in names[m]} == NAMES
    end = marker == names.index(["pipe.end"])
    assert (surface.triangles[end][:, :, 2] == 3).all()
    np.testing.assert_allclose(surface.face_normals[end], [[0, 0, 1]] * end.sum(), atol=1e-12)


def test_interfaces_come_along_if_asked(two):
    assert len(cm.to_trimesh(two).faces) == 20
    whole = cm.to_trimesh(two, interfaces=True)
    between = whole.face_attributes["region"].tolist().count([0, 1])
    assert (len(whole.faces), between) == (22, 2)
    seam = whole.face_attributes["marker"] == 1
    np.testing.assert_allclose(whole.face_normals[seam], [[0, 0, 1]] * 2)
    assert cm.to_trimesh(two).volume == pytest.approx(2)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".off", ".3mf", ".glb"])
def test_files_hold_the_closed_boundary(tmp_path, hexes, suffix):
    path = tmp_path / f"pipe{suffix}"
    cm.write(path, hexes)
    exact = cm.to_trimesh(hexes).volume
    if suffix != ".3mf":
        loaded = trimesh.load_scene(path, process=True).to_mesh()
        loaded.merge_vertices(merge_norm=True, merge_tex=True)
        assert loaded.is_watertight
        assert loaded.volume == pytest.approx(exact, rel=1e-6)
    if suffix != ".glb":
        shape = cm.read_shape(path)
        assert cm.evaluate(shape).volumes()[0] == pytest.approx(exact, rel=1e-6)
    again = tmp_path / f"again{suffix}"
    cm.write(again, hexes)
    assert again.read_bytes() == path.read_bytes()


def test_names_survive_as_groups(tmp_path, hexes):
    cm.write(tmp_path / "pipe.obj", hexes)
    parts = cm.evaluate(cm.read_shape(tmp_path / "pipe.obj")).names
    assert {p.removeprefix("pipe.") for p in parts} == NAMES
    cm.write(tmp_path / "pipe.stl", hexes, binary=False)
    text = (tmp_path / "pipe.stl").read_text()
    assert {line[6:] for line in text.splitlines() if line.startswith("solid ")} == NAMES
    cm.write(tmp_path / "pipe.glb", hexes)
    assert set(trimesh.load_scene(tmp_path / "pipe.glb").geometry) == NAMES


def test_3mf_has_an_object_a_region(tmp_path, two):
    cm.write(tmp_path / "two.3mf", two)
    shape = cm.read_shape(tmp_path / "two.3mf")
    domain = cm.evaluate(shape)
    assert domain.volumes()[0] == pytest.approx(2)
    assert set(domain.names) == {"two.lower", "two.upper"}
    assert cm.evaluate(shape.children[0]).volumes()[0] == pytest.approx(1)


def test_surfaces_of_solids_are_read_as_shapes(tmp_path, hexes):
    for suffix in (".3mf", ".glb"):
        cm.write(tmp_path / f"pipe{suffix}", hexes)
        with pytest.raises(cm.FileFormatError, match=r"use csgmesh\.read_shape"):
            cm.read(tmp_path / f"pipe{suffix}")
    for suffix in (".stl", ".obj", ".ply", ".off"):
        cm.write(tmp_path / f"pipe{suffix}", hexes)
        with pytest.raises(cm.FileFormatError, match="read_shape"):
            cm.read(tmp_path / f"pipe{suffix}")


def test_what_the_plane_cannot_be(tmp_path):
    plane = cm.generate(cm.Disk((0, 0), 1), size=0.5)
    with pytest.raises(cm.InputError, match="this one lies in the plane"):
        cm.to_trimesh(plane)
    with pytest.raises(cm.FileFormatError, match=r"a \.3mf file holds solids"):
        cm.write(tmp_path / "a.3mf", plane)


def test_pyvista_is_asked_for_in_words(hexes, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(cm.InputError, match="pip install pyvista"):
        cm.to_pyvista(hexes)


def test_pyvista_gets_all_cells_facets_and_names(two, wedges, monkeypatch):
    class Grid:
        def __init__(self, cells, types, points):
            self.cells, self.types, self.points = cells, types, points
            self.cell_data, self.field_data = {}, {}

    stand_in = types.SimpleNamespace(UnstructuredGrid=Grid)
    monkeypatch.setitem(sys.modules, "pyvista", stand_in)
    grid = cm.to_pyvista(two)
    assert grid.types.tolist() == [12, 12, 9, 9]
    assert grid.cells[:9].tolist() == [8, 4, 5, 7, 6, 8, 9, 11, 10]
    assert grid.cell_data["name"].tolist() == ["upper", "lower", "floor", "seam"]
    assert grid.cell_data["region"].tolist() == [1, 0, -1, -1]
    assert grid.cell_data["marker"].tolist() == [-1, -1, 0, 1]
    assert grid.field_data["boundary_names"].tolist() == ["floor", "seam"]
    grid = cm.to_pyvista(wedges)
    assert len(grid.types) == wedges.n_cells + wedges.n_facets
    plane = cm.to_pyvista(cm.elevate(cm.generate(cm.Disk((0, 0), 1), size=0.5), order=3))
    assert plane.points.shape[1] == 3 and set(plane.types.tolist()) == {68, 69}


def test_abaqus_holds_all_kinds_of_cells_and_sets_over_several_kinds(tmp_path):
    turned = cm.Revolve(cm.Box((0, 0), (1, 1)), name="drum")
    mesh = cm.generate(turned, cm.Sweep(), size=0.5)
    assert set(mesh.cells) == {"wedge", "pyramid", "tetra"}
    cm.write(tmp_path / "drum.inp", mesh)
    types = [t for t in (tmp_path / "drum.inp").read_text().splitlines() if "TYPE=" in t]
    assert {t.split("=")[1] for t in types} == {"C3D6", "C3D5", "C3D4", "S4", "S3"}
    back = cm.read(tmp_path / "drum.inp")
    assert {k: len(v) for k, v in back.cells.items()} == {k: len(v) for k, v in mesh.cells.items()}
    assert set(back.names) == set(mesh.names)
    for name in mesh.names:
        assert {k: len(v) for k, v in back.boundary(name).items() if len(v)} == {
            k: len(v) for k, v in mesh.boundary(name).items() if len(v)
        }
    assert cm.check(back, turned).ok

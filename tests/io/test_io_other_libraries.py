"""What meshio, Gmsh and scikit-fem see, and what they make."""

import meshio
import numpy as np
import pytest

import csgmesh as cm


def edges_named(found, name):
    """Sorted point pairs of the lines in a meshio cell set."""
    parts = [
        found.cells[block].data[members]
        for block, members in enumerate(found.cell_sets[name])
        if found.cells[block].type == "line"
    ]
    return sorted(map(tuple, np.sort(np.concatenate(parts), axis=1).tolist()))


@pytest.mark.parametrize("binary", [True, False])
def test_meshio_finds_the_names_of_a_plate(tmp_path, binary):
    plate = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
    mesh = cm.generate(plate, size=0.4)
    cm.write(tmp_path / "plate.msh", mesh, binary=binary)
    found = meshio.read(tmp_path / "plate.msh")
    sides = {"plate.left", "plate.right", "plate.bottom", "plate.top", "hole"}
    assert set(found.field_data) == sides | {"domain"}
    assert all(found.field_data[name][1] == 1 for name in sides)
    assert found.field_data["domain"].tolist() == [1, 2]
    np.testing.assert_array_equal(found.points[:, :2], mesh.points)
    physical = found.cell_data_dict["gmsh:physical"]
    tags = {int(found.field_data[name][0]): name for name in found.field_data}
    assert {tags[t] for t in np.unique(physical["line"])} == sides
    assert (physical["triangle"] == 1).all()
    p = found.points[found.cells_dict["line"]]
    length = np.linalg.norm(p[:, 1] - p[:, 0], axis=1)
    hole = physical["line"] == found.field_data["hole"][0]
    assert length[hole].sum() == pytest.approx(np.pi, rel=0.02)
    left = physical["line"] == found.field_data["plate.left"][0]
    assert (p[left][..., 0] == 0).all() and length[left].sum() == pytest.approx(2)


def test_a_facet_with_several_names_is_in_several_groups(tmp_path, plate):
    cm.write(tmp_path / "a.msh", plate)
    found = meshio.read(tmp_path / "a.msh")
    top, lid = edges_named(found, "plate.top"), edges_named(found, "lid")
    assert top == lid and len(top) == 8
    assert len(edges_named(found, "crack")) == 2


def test_group_numbers_are_unique_over_dimensions(tmp_path, plate):
    cm.write(tmp_path / "a.msh", plate, binary=False)
    text = (tmp_path / "a.msh").read_text()
    groups = text.split("$PhysicalNames\n")[1].split("$End")[0].splitlines()[1:]
    assert len({line.split()[1] for line in groups}) == len(groups) == 11
    assert '2 2 "core"' in groups and sum('"core"' in line for line in groups) == 2


def test_gmsh_opens_it(tmp_path, plate):
    gmsh = pytest.importorskip("gmsh", exc_type=ImportError)
    cm.write(tmp_path / "a.msh", plate)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "a.msh"))
        model = gmsh.model
        groups = {model.getPhysicalName(*key): key for key in model.getPhysicalGroups()}
        assert set(groups) == {*plate.names, "rock", "core"}
        entities = model.getEntitiesForPhysicalGroup
        assert entities(*groups["plate.top"]).tolist() == entities(*groups["lid"]).tolist()
        nodes, _ = model.mesh.getNodesForPhysicalGroup(*groups["plate.left"])
        assert sorted(n - 1 for n in nodes) == plate.boundary_points("plate.left").tolist()
        assert len(model.mesh.getElementsByType(2)[0]) == plate.n_cells
        gmsh.write(str(tmp_path / "b.msh"))
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.write(str(tmp_path / "c.msh"))
        gmsh.model.mesh.refine()
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.option.setNumber("Mesh.Binary", 1)
        gmsh.write(str(tmp_path / "d.msh"))
    finally:
        gmsh.finalize()
    back = cm.read(tmp_path / "b.msh")
    assert set(back.names) == set(plate.names) and back.n_cells == plate.n_cells
    old = cm.read(tmp_path / "c.msh")
    assert old.n_cells == plate.n_cells and len(old.boundary("plate.top")["line"]) == 8
    assert set(old.boundary_names[old.facet_marker["line"][old.boundary("lid")["line"][0]]]) == {
        "plate.top",
        "lid",
    }
    fine = cm.read(tmp_path / "d.msh")
    assert fine.n_cells == 4 * plate.n_cells and len(fine.boundary("lid")["line"]) == 16


def test_meshio_reads_vtu(tmp_path, plate):
    for options in ({}, {"compress": True}, {"encoding": "base64"}):
        cm.write(tmp_path / "a.vtu", plate, **options)
        found = meshio.read(tmp_path / "a.vtu")
        assert found.field_data["boundary:lid"].tolist() == [3]
        assert cm.from_meshio(found).equals(plate)


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("compression", [None, "zlib"])
def test_vtu_of_meshio_is_read(tmp_path, binary, compression):
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    given = meshio.Mesh(points, [("triangle", [[0, 1, 2], [1, 3, 2]]), ("line", [[0, 1]])])
    given.cell_data = {"region": [np.array([4, 7]), np.array([-1])]}
    given.cell_data["marker"] = [np.array([-1, -1]), np.array([2])]
    meshio.vtu.write(tmp_path / "a.vtu", given, binary=binary, compression=compression)
    mesh = cm.read(tmp_path / "a.vtu")
    assert mesh.region_names == ("region4", "region7")
    assert mesh.names == ("boundary2", "boundary", "interface")
    assert len(mesh.interface("region4", "region7")["line"]) == 1


def test_meshio_mesh_and_back(plate, quads):
    assert cm.from_meshio(cm.to_meshio(quads)).equals(quads)
    found = cm.to_meshio(plate)
    assert set(found.cell_sets) == {*plate.names, "rock", "core"}
    assert edges_named(found, "lid") == edges_named(found, "plate.top")
    back = cm.from_meshio(found)
    assert set(back.boundary_names) == set(plate.boundary_names)
    assert back.region_names == plate.region_names


def test_sides_and_missing_facets_are_worked_out():
    """Clockwise cells, a facet the wrong way round and listed twice, a stray line and point."""
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1], [9, 9]]
    given = meshio.Mesh(
        points,
        [
            ("quad", [[0, 3, 2, 1], [1, 2, 5, 4], [0, 3, 2, 1]]),
            ("line", [[1, 0], [0, 1], [2, 1], [0, 6]]),
        ],
        cell_sets={
            "rock": [np.array([0, 2]), np.array([], int)],
            "core": [np.array([1]), np.array([], int)],
            "floor": [np.array([], int), np.array([0])],
            "wet": [np.array([], int), np.array([1])],
            "seam": [np.array([], int), np.array([2, 3])],
        },
    )
    mesh = cm.from_meshio(given)
    assert mesh.n_points == 6 and mesh.n_cells == 2
    assert dict(mesh.info) == {"skipped": {"points": 1, "lines": 1, "repeated cells": 1}}
    facets = dict(zip(map(tuple, mesh.facets["line"].tolist()), range(7), strict=False))
    floor, seam = facets[0, 1], facets[1, 2]
    assert set(mesh.boundary_names[mesh.facet_marker["line"][floor]]) == {"floor", "wet"}
    assert mesh.facet_region["line"][floor].tolist() == [0, -1]
    assert mesh.facet_region["line"][seam].tolist() == [0, 1]
    assert len(mesh.boundary("boundary")["line"]) == 5
    a, b, c, _ = mesh.points[mesh.cells["quad"][0]]
    assert (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0] > 0


def test_scikit_fem_integrates_over_names(plate):
    import skfem

    mesh = cm.to_skfem(plate)
    one = skfem.Functional(lambda w: 1.0 + 0.0 * w.x[0])
    normal = [skfem.Functional(lambda w, i=i: w.n[i]) for i in (0, 1)]
    expected = {
        "plate.left": (2, -2, 0),
        "plate.right": (2, 2, 0),
        "plate.bottom": (4, 0, -4),
        "plate.top": (4, 0, 4),
        "lid": (4, 0, 4),
        # Out of the region on the left of the facet: from rock into core, from above the crack.
        "core": (2, None, None),
        "crack": (1, 0, -1),
    }
    assert set(mesh.boundaries) == set(expected)
    for name, (length, nx, ny) in expected.items():
        basis = skfem.FacetBasis(mesh, skfem.ElementTriP1(), facets=name)
        assert one.assemble(basis) == pytest.approx(length)
        if nx is not None:
            assert [f.assemble(basis) for f in normal] == pytest.approx([nx, ny], abs=1e-12)
    basis = skfem.FacetBasis(mesh, skfem.ElementTriP1(), facets="core")
    left = plate.facet_region["line"][plate.boundary("core")["line"]][:, 0]
    assert (left == 0).all() and normal[0].assemble(basis) == pytest.approx(2)
    for name in plate.region_names:
        cells = skfem.CellBasis(mesh, skfem.ElementTriP1(), elements=name)
        assert one.assemble(cells) == pytest.approx(4)


def test_scikit_fem_second_order_and_quads(curved, quads):
    import skfem

    mesh = cm.to_skfem(curved)
    assert isinstance(mesh, skfem.MeshTri2)
    assert {name: len(facets) for name, facets in mesh.boundaries.items()} == {"wall": 2, "arc": 1}
    ends = mesh.p[:, mesh.facets[:, mesh.boundaries["arc"][0]]].T
    assert sorted(ends.tolist()) == [[0, 1], [1, 0]]
    with pytest.raises(cm.InputError, match="needs cells of one kind"):
        cm.to_skfem(quads)


@pytest.mark.parametrize("convert", [cm.to_skfem, cm.to_meshio])
def test_only_meshes_are_converted(convert):
    with pytest.raises(cm.InputError, match="needs a Mesh, as generate returns; got Box"):
        convert(cm.Box((0, 0), (1, 1)))

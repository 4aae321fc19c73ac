"""What is written comes back."""

import os
import stat
import time

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.domain.curves import Curves
from csgmesh.io.registry import FORMATS

NATIVE = [
    (".npz", {}),
    (".npz", {"compress": True}),
    (".vtu", {}),
    (".vtu", {"compress": True}),
    (".vtu", {"encoding": "base64"}),
    (".vtu", {"encoding": "base64", "compress": True}),
    (".msh", {}),
    (".msh", {"binary": False}),
]


@pytest.mark.parametrize(("suffix", "options"), NATIVE)
@pytest.mark.parametrize("which", ["plate", "quads", "curved"])
def test_native_formats_lose_nothing(tmp_path, request, suffix, options, which):
    mesh = request.getfixturevalue(which)
    path = tmp_path / f"a{suffix}"
    cm.write(path, mesh, **options)
    assert cm.read(path).equals(mesh)


@pytest.mark.parametrize("suffix", [".npz", ".vtu", ".msh"])
def test_a_generated_mesh_comes_back(tmp_path, suffix):
    plate = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
    mesh = cm.generate(plate, size=0.4)
    cm.write(tmp_path / f"a{suffix}", mesh)
    back = cm.read(tmp_path / f"a{suffix}")
    assert back.names == mesh.names and back.region_names == mesh.region_names
    np.testing.assert_array_equal(back.points, mesh.points)
    np.testing.assert_array_equal(back.cells["triangle"], mesh.cells["triangle"])
    for name in mesh.names:
        ours = mesh.facets["line"][mesh.boundary(name)["line"]]
        theirs = back.facets["line"][back.boundary(name)["line"]]
        assert sorted(map(tuple, ours.tolist())) == sorted(map(tuple, theirs.tolist()))


def test_npz_keeps_curves_and_info(tmp_path, plate):
    arc = Curves.arcs([[0, 0]], [[1, 0]], [[0, 1]], [0.0], [1.0])
    mesh = cm.Mesh(
        plate.points,
        plate.cells,
        facets={"line": plate.facets["line"][:1]},
        facet_curve={"line": [0]},
        facet_interval={"line": [[0.25, 0.5]]},
        curves=arc,
        info={"min_angle": 30.0, "method": "by hand"},
    )
    cm.write(tmp_path / "a.npz", mesh)
    back = cm.read(tmp_path / "a.npz")
    assert back.equals(mesh) and dict(back.info) == dict(mesh.info)
    np.testing.assert_array_equal(back.curves.interval, arc.interval)


@pytest.mark.parametrize("suffix", [".npz", ".vtu", ".msh"])
@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_coordinates_keep_every_bit(tmp_path, plate, suffix, scale):
    points = plate.points * scale + scale / 3
    mesh = cm.Mesh(points, plate.cells)
    for options in ({}, {"binary": False}) if suffix == ".msh" else ({},):
        cm.write(tmp_path / f"a{suffix}", mesh, **options)
        np.testing.assert_array_equal(cm.read(tmp_path / f"a{suffix}").points, points)


@pytest.mark.parametrize("suffix", list(FORMATS))
def test_every_format_keeps_the_cells(tmp_path, plate, suffix):
    cm.write(tmp_path / f"a{suffix}", plate)
    back = cm.read(tmp_path / f"a{suffix}")

    def area(mesh, region):
        p = mesh.points[mesh.cells["triangle"][mesh.cell_region["triangle"] == region]]
        a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
        return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()

    if suffix in (".stl", ".obj", ".off", ".ply"):
        assert back.region_names == ("domain",) and area(back, 0) == pytest.approx(8)
    else:
        assert area(back, 0) == pytest.approx(4) and area(back, 1) == pytest.approx(4)
        counts = np.bincount(back.facet_marker["line"])
        assert sorted(counts.tolist()) == sorted(np.bincount(plate.facet_marker["line"]).tolist())


def test_abaqus_sets_keep_names(tmp_path, plate):
    cm.write(tmp_path / "a.inp", plate)
    back = cm.read(tmp_path / "a.inp")
    assert back.region_names == ("rock", "core")
    assert set(back.names) == {*plate.names} - {"core"} | {"core.boundary"}
    assert ("plate.top", "lid") in back.boundary_names
    assert len(back.boundary_points("sensor")) == 2


@pytest.mark.parametrize("suffix", list(FORMATS))
def test_the_same_mesh_gives_the_same_bytes(tmp_path, plate, suffix, monkeypatch):
    cm.write(tmp_path / f"a{suffix}", plate)
    monkeypatch.setattr(time, "time", lambda: 2_000_000_000.0)
    monkeypatch.setattr(time, "localtime", lambda *_: time.gmtime(2_000_000_000))
    cm.write(tmp_path / f"b{suffix}", plate)
    data = (tmp_path / f"a{suffix}").read_bytes()
    assert data == (tmp_path / f"b{suffix}").read_bytes()
    assert time.strftime("%Y-%m").encode() not in data


def test_point_and_cell_data_reach_vtu(tmp_path, plate):
    import meshio

    u, q = plate.points[:, 0] ** 2, np.arange(plate.n_cells)
    cm.write(tmp_path / "a.vtu", plate, point_data={"u": u}, cell_data={"q": q})
    found = meshio.read(tmp_path / "a.vtu")
    np.testing.assert_array_equal(found.point_data["u"], u)
    np.testing.assert_array_equal(found.cell_data_dict["q"]["triangle"], q)
    assert (found.cell_data_dict["q"]["line"] == -1).all()
    with pytest.raises(cm.InputError, match=r"point_data\['u'\] must have shape"):
        cm.write(tmp_path / "a.vtu", plate, point_data={"u": u[:-1]})


def test_files_appear_whole_or_not_at_all(tmp_path, plate):
    path = tmp_path / "a.msh"
    cm.write(path, plate)
    before = path.read_bytes()
    bad = cm.Mesh(plate.points, plate.cells, region_names=['a "quoted" name'])
    with pytest.raises(cm.FileFormatError, match="cannot hold the name"):
        cm.write(path, bad)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["a.msh"]
    umask = os.umask(0)
    os.umask(umask)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~umask


def test_many_boundaries_stay_quick(tmp_path):
    """Ten thousand markers: nothing is quadratic in them."""
    n = 10_000
    points = np.column_stack([np.repeat(np.arange(n + 1.0), 2), np.tile([0.0, 1.0], n + 1)])
    a = 2 * np.arange(n)
    mesh = cm.Mesh(
        points,
        {"quad": np.column_stack([a, a + 2, a + 3, a + 1])},
        facets={"line": np.column_stack([a, a + 2])},
        facet_marker={"line": np.arange(n)},
        boundary_names=[(f"disk.{i}",) for i in range(n)],
        facet_region={"line": np.tile([0, -1], (n, 1))},
    )
    for suffix in (".npz", ".vtu", ".msh"):
        cm.write(tmp_path / f"a{suffix}", mesh)
        back = cm.read(tmp_path / f"a{suffix}")
        assert back.boundary_names[:n] == mesh.boundary_names

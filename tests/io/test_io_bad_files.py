"""Bad files and bad calls end in one kind of error that says what and where."""

import io
import zipfile

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.io.registry import FORMATS

NATIVE = [(".npz", {}), (".vtu", {}), (".vtu", {"encoding": "base64", "compress": True})]
NATIVE += [(".msh", {}), (".msh", {"binary": False})]


@pytest.mark.parametrize(("suffix", "options"), NATIVE)
def test_a_file_cut_anywhere_is_an_error_or_whole(tmp_path, plate, suffix, options):
    path = tmp_path / f"a{suffix}"
    cm.write(path, plate, **options)
    data = path.read_bytes()
    for end in np.linspace(0, len(data) - 2, 60).astype(int):
        path.write_bytes(data[:end])
        try:
            back = cm.read(path)
        except cm.FileFormatError as error:
            assert str(path) in str(error)
        else:
            assert back.equals(plate)


@pytest.mark.parametrize(("suffix", "options"), NATIVE)
def test_damaged_bytes_never_raise_anything_else(tmp_path, plate, suffix, options):
    path = tmp_path / f"a{suffix}"
    cm.write(path, plate, **options)
    data = path.read_bytes()
    rng = np.random.default_rng(1)
    for _ in range(150):
        broken = bytearray(data)
        for at in rng.integers(0, len(data), 3):
            broken[at] = rng.integers(0, 256)
        path.write_bytes(bytes(broken))
        try:
            back = cm.read(path)
        except cm.FileFormatError as error:
            assert str(path) in str(error)
        else:
            assert isinstance(back, cm.Mesh)


@pytest.mark.parametrize("suffix", list(FORMATS))
@pytest.mark.parametrize(
    "content", [b"", b"hello\n", b"\x00\xff" * 500, b"<?xml version='1.0'?><a/>"]
)
def test_foreign_files_are_refused(tmp_path, suffix, content):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(content)
    with pytest.raises(cm.FileFormatError, match=path.name):
        cm.read(path)


@pytest.mark.parametrize(
    ("suffix", "end"), [(".ply", b"end_header"), (".off", b"45 64"), (".bdf", b"GRID")]
)
def test_files_on_which_meshio_never_stops_are_refused(tmp_path, plate, suffix, end):
    path = tmp_path / f"a{suffix}"
    cm.write(path, plate)
    path.write_bytes(path.read_bytes().split(end)[0])
    with pytest.raises(cm.FileFormatError, match="or is cut short"):
        cm.read(path)


def test_npz_of_others_and_pickles_are_refused(tmp_path):
    path = tmp_path / "a.npz"
    np.savez(path, points=np.zeros((3, 2)))
    with pytest.raises(cm.FileFormatError, match="holds no csgmesh mesh"):
        cm.read(path)
    np.savez(path, header=np.array([object()], dtype=object))
    with pytest.raises(cm.FileFormatError, match="damaged"):
        cm.read(path)


def test_npz_numbers_are_checked(tmp_path, plate):
    path = tmp_path / "a.npz"
    cm.write(path, plate)
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    cells = np.array(plate.cells["triangle"])
    cells[5, 1] = 10_000
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, cells)
    files["cells.triangle.npy"] = buffer.getvalue()
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    with pytest.raises(
        cm.FileFormatError, match=r"a\.npz is damaged: cells.* points 0 to 44; row 5 is \("
    ):
        cm.read(path)


def test_msh_errors_name_the_section(tmp_path, plate):
    path = tmp_path / "a.msh"
    cm.write(path, plate, binary=False)
    text = path.read_text()
    for old, new, said in (
        ("$Elements\n", "$Elements\nx ", r"damaged.*in \$Elements"),
        ("$EndNodes", "", r"is cut short.*\$EndNodes.*in \$Nodes"),
        ("4.1 0 8", "4 0 8", "MSH version 4; known are 4.1 and 2.2"),
        ("4.1 0 8", "4.1 7 8", "bad format line '4.1 7 8'"),
    ):
        path.write_text(text.replace(old, new, 1))
        with pytest.raises(cm.FileFormatError, match=said):
            cm.read(path)


def test_surfaces_in_space_are_read_from_vtu_and_refused_elsewhere(tmp_path):
    import meshio

    points = np.eye(4, 3)
    for suffix in (".vtu", ".vtk"):
        meshio.write(tmp_path / f"b{suffix}", meshio.Mesh(points, [("triangle", [[0, 1, 2]])]))
    mesh = cm.read(tmp_path / "b.vtu")
    assert (mesh.dim, mesh.names, mesh.region_names) == (3, ("boundary",), ("domain",))
    with pytest.raises(cm.FileFormatError, match="point 2 has z = 1"):
        cm.read(tmp_path / "b.vtk")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("a.mhs", r"unknown suffix '\.mhs'; did you mean .*'\.msh'.*Known are \.vtu, \.msh"),
        ("a.qqqqqqq", r"unknown suffix '\.qqqqqqq'\. Known are"),
        ("a", "no suffix"),
        ("a.png", r"is a picture.*csgmesh\.draw"),
        ("no/such/a.msh", r"cannot be written: there is no directory .*no/such"),
    ],
)
def test_bad_paths_to_write(tmp_path, plate, name, said):
    with pytest.raises(cm.FileFormatError, match=said):
        cm.write(tmp_path / name, plate)


def test_bad_paths_to_read(tmp_path):
    with pytest.raises(cm.FileFormatError, match=r"a\.msh: there is no such file"):
        cm.read(tmp_path / "a.msh")
    (tmp_path / "b.msh").mkdir()
    with pytest.raises(cm.FileFormatError, match="is a directory"):
        cm.read(tmp_path / "b.msh")


def test_unknown_options_and_arguments(tmp_path, plate):
    with pytest.raises(
        cm.InputError, match=r"a \.vtu file has no option 'comprss'; did you mean 'comp"
    ):
        cm.write(tmp_path / "a.vtu", plate, comprss=True)
    with pytest.raises(cm.InputError, match=r"a \.off file has no option 'binary'; there are none"):
        cm.write(tmp_path / "a.off", plate, binary=True)
    with pytest.raises(cm.InputError, match="of a plane mesh is text"):
        cm.write(tmp_path / "a.stl", plate, binary=True)
    with pytest.raises(cm.InputError, match="encoding must be one of 'raw', 'base64'; got 'hex'"):
        cm.write(tmp_path / "a.vtu", plate, encoding="hex")
    with pytest.raises(cm.InputError, match=r"needs a Mesh.*got Disk"):
        cm.write(tmp_path / "a.vtu", cm.Disk((0, 0), 1))
    assert not list(tmp_path.iterdir())


def test_quads_do_not_fit_into_stl(tmp_path, quads):
    with pytest.raises(cm.FileFormatError, match="cannot hold cells of kind 'quad'"):
        cm.write(tmp_path / "a.stl", quads)

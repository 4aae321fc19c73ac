"""Surfaces from files: what is safe is repaired, all else refused with its reason and place."""

import struct
import zipfile

import numpy as np
import pytest
import trimesh

import csgmesh as cm

BOX = trimesh.creation.box((1, 2, 3))
SUFFIXES = (".stl", ".obj", ".ply", ".off", ".3mf")


@pytest.fixture
def saved(tmp_path):
    def save(points, triangles, suffix=".off", stem="part"):
        path = tmp_path / f"{stem}{suffix}"
        points, triangles = np.asarray(points), np.asarray(triangles)
        if suffix == ".3mf":
            from csgmesh.io.solids.threemf import write_parts

            write_parts(path, [("", np.asarray(points, float), triangles)])
        else:
            trimesh.Trimesh(points, triangles, process=False).export(path)
        return path

    return save


def volume(shape):
    return float(cm.evaluate(shape).volumes()[0])


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_format(saved, suffix):
    shape = cm.read_shape(saved(BOX.vertices, BOX.faces, suffix, stem="block"))
    domain = cm.evaluate(shape)
    assert domain.volumes()[0] == pytest.approx(6, rel=1e-6)
    assert len(domain.surfaces) == 6
    assert domain.names in (("block",), ("object1",))
    assert shape.contains([(0, 0, 0), (0.6, 0, 0)]).tolist() == [True, False]
    low, high = shape.bounds()
    np.testing.assert_allclose(high - low, (1, 2, 3))


def test_a_solid_read_is_a_value_and_a_leaf(saved):
    shape = cm.read_shape(saved(BOX.vertices, BOX.faces), name="block")
    assert cm.Shape.from_dict(shape.to_dict()) == shape
    assert eval(repr(shape), {"FacetedSolid": cm.FacetedSolid}) == shape
    bored = shape - cm.Cylinder((0, 0, -2), (0, 0, 2), 0.3)
    assert cm.evaluate(bored).names == ("block", "cylinder.side")
    assert volume(bored.scale(2)) == pytest.approx(8 * (6 - 3 * np.pi * 0.09), rel=1e-2)


def test_ascii_solids_name_their_parts(tmp_path):
    def text(name, mesh):
        return trimesh.exchange.stl.export_stl_ascii(mesh).replace("solid \n", f"solid {name}\n", 1)

    one = tmp_path / "one.stl"
    one.write_text(text("front plate", BOX))
    assert cm.evaluate(cm.read_shape(one)).names in (("front_plate",), ("one",))
    apart = BOX.copy().apply_translation((5, 0, 0))
    both = tmp_path / "both.stl"
    both.write_text(
        "".join(
            "solid {0}\n{1}endsolid {0}\n".format(
                name,
                "".join(
                    "facet normal 0 0 0\nouter loop\n"
                    + "".join("vertex {} {} {}\n".format(*p) for p in triangle)
                    + "endloop\nendfacet\n"
                    for triangle in mesh.triangles
                ),
            )
            for name, mesh in (("left", BOX), ("right", apart))
        )
    )
    domain = cm.evaluate(cm.read_shape(both))
    assert domain.names == ("both.left", "both.right")
    assert domain.volumes()[0] == pytest.approx(12)


def test_groups_of_one_surface_are_its_parts(tmp_path):
    path = tmp_path / "tank.obj"
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = {
        "wall": [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7)],
        "floor": [(1, 3, 7, 5)],
        "lid": [(2, 6, 8, 4)],
    }
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    for name, own in faces.items():
        lines += [f"g {name}", *(f"f {' '.join(map(str, face))}" for face in own)]
    path.write_text("\n".join(lines) + "\n")
    domain = cm.evaluate(cm.read_shape(path))
    assert set(domain.names) == {"tank.wall", "tank.floor", "tank.lid"}
    assert domain.area("tank.wall") == pytest.approx(4)
    assert domain.area("tank.lid") == pytest.approx(1)


def test_a_split_angle_finds_the_sides(saved):
    mesh = trimesh.creation.cylinder(1, 3, sections=48)
    shape = cm.read_shape(saved(mesh.vertices, mesh.faces), split_angle=30)
    domain = cm.evaluate(shape)
    assert domain.names == ("part.face1", "part.face2", "part.face3")
    areas = sorted(domain.area(name) for name in domain.names)
    chord = 2 * np.sin(np.pi / 48)
    assert areas[2] == pytest.approx(48 * chord * 3)
    with pytest.raises(cm.InputError, match="split_angle must be more than 0"):
        cm.read_shape(saved(mesh.vertices, mesh.faces), split_angle=0)


def turned(faces, which):
    out = np.array(faces)
    out[which] = out[which][:, ::-1]
    return out


REPAIRED = {
    "vertices apart": (BOX.triangles.reshape(-1, 3), np.arange(36).reshape(-1, 3)),
    "vertices nearly the same": (
        BOX.triangles.reshape(-1, 3) + 1e-7 * np.sin(np.arange(108)).reshape(36, 3),
        np.arange(36).reshape(-1, 3),
    ),
    "all inverted": (BOX.vertices, BOX.faces[:, ::-1]),
    "some inverted": (BOX.vertices, turned(BOX.faces, [0, 5, 7])),
    "a triangle twice": (BOX.vertices, np.vstack([BOX.faces, BOX.faces[3:4]])),
    "a triangle without corners": (BOX.vertices, np.vstack([BOX.faces, [[0, 0, 1]]])),
}


@pytest.mark.parametrize("name", REPAIRED)
def test_what_is_safe_is_repaired(saved, name):
    assert volume(cm.read_shape(saved(*REPAIRED[name]))) == pytest.approx(6, rel=1e-6)


def test_a_small_hole_is_filled_and_a_large_one_refused(saved):
    ball = trimesh.creation.icosphere(4)
    filled = cm.read_shape(saved(ball.vertices, ball.faces[1:]))
    assert volume(filled) == pytest.approx(ball.volume, rel=1e-6)
    with pytest.raises(cm.FileFormatError, match=r"3 belong to one triangle only, the first from"):
        cm.read_shape(saved(BOX.vertices, BOX.faces[1:]))


def test_cavities_stay_when_windings_are_mended(saved):
    outer, inner = trimesh.creation.box((4, 4, 4)), BOX
    points = np.vstack([outer.vertices, inner.vertices])
    faces = np.vstack([turned(outer.faces, [2, 3]), inner.faces + 8])
    assert volume(cm.read_shape(saved(points, faces))) == pytest.approx(64 - 6)


def crossing_boxes():
    other = BOX.copy().apply_translation((0.4, 0.3, 0.2))
    return np.vstack([BOX.vertices, other.vertices]), np.vstack([BOX.faces, other.faces + 8])


def fin():
    points = np.vstack([BOX.vertices, [(5, 5, 5)]])
    a, b, c = BOX.faces[0]
    return points, np.vstack([BOX.faces, [[a, b, 8], [b, a, 8]], [[a, c, 8], [c, b, 8]]])


def moebius():
    strip = 8
    angle = 2 * np.pi * np.arange(strip) / strip
    wide = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    offset = 0.3 * np.column_stack(
        [np.cos(angle) * np.cos(angle / 2), np.sin(angle) * np.cos(angle / 2), np.sin(angle / 2)]
    )
    points = np.vstack([wide - offset, wide + offset])
    quads = [(k, (k + 1), strip + k + 1, strip + k) for k in range(strip - 1)]
    quads.append((strip - 1, strip, 0, 2 * strip - 1))
    return points, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


FLAT = ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (1, 3, 2), (2, 1, 0), (2, 3, 1)])


@pytest.mark.parametrize(
    ("surface", "said"),
    [
        (crossing_boxes(), r"must not pass through itself; it does near \("),
        (fin(), "to three or more"),
        (moebius(), "belong to one triangle only"),
        (FLAT, "four triangles"),
        ((BOX.vertices * [1, 1, 0], BOX.faces), "each edge must belong|four triangles|enclose"),
        ((np.where(BOX.vertices > 1, np.inf, BOX.vertices), BOX.faces), "finite|cannot be read"),
    ],
)
def test_what_encloses_no_solid_is_refused(saved, surface, said):
    with pytest.raises(cm.FileFormatError, match=said):
        cm.read_shape(saved(*surface))


def binary(count, n=12):
    return b"\0" * 80 + struct.pack("<I", count) + b"\0" * 50 * n


BAD = {
    "empty.stl": b"",
    "short.stl": binary(12)[:300],
    "gigantic.stl": binary(2**32 - 1),
    "zeros.stl": binary(12),
    "words.stl": b"solid x\nfacet normal 0 0 1\nouter loop\nvertex a b c\nendloop\nendfacet\n"
    b"endsolid",
    "cut.stl": b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1",
    "gigantic.ply": b"ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\n"
    b"property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
    b"end_header\n0 0 0\n",
    "cut.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\n",
    "gigantic.off": b"OFF\n999999999 999999999 0\n0 0 0\n",
    "beyond.off": b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n3 0 1 3\n3 1 2 3\n3 0 2 3\n",
    "text.off": b"OFF\nfour\n",
    "empty.obj": b"# nothing\n",
    "plane.obj": b"v 0 0\nv 1 0\nv 0 1\nv 1 1\nf 1 2 3\n",
    "far.off": b"OFF\n4 4 0\n0 0 0\n1e40 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 2 3\n",
    "words.obj": b"v 0 0 a\nf 1 2 3\n",
    "noise.ply": bytes(range(256)) * 20,
    "noise.stl": bytes(range(256)) * 20,
    "noise.obj": bytes(range(256)) * 20,
    "noise.off": bytes(range(256)) * 20,
    "noise.3mf": bytes(range(256)) * 20,
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_in_our_words(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(BAD[name])
    with pytest.raises(cm.FileFormatError, match=name.replace(".", r"\.")):
        cm.read_shape(path)


@pytest.mark.parametrize(
    ("model", "said"),
    [
        ("<model", "cannot be read"),
        ("<model><resources/><build><item objectid='1'/></build></model>", "no object '1'"),
        (
            "<model><resources><object id='1'><components><component objectid='1'/></components>"
            "</object></resources><build><item objectid='1'/></build></model>",
            "nest 16 deep",
        ),
        (
            "<model><resources><object id='1'><mesh>"
            "<vertices><vertex x='0' y='0' z='0'/></vertices>"
            "<triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh></object></resources>"
            "<build><item objectid='1'/></build></model>",
            "points it has not",
        ),
        ("<model><build/></model>", "holds no triangles"),
    ],
)
def test_bad_models_in_3mf(tmp_path, model, said):
    path = tmp_path / "part.3mf"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("3D/3dmodel.model", model)
    with pytest.raises(cm.FileFormatError, match=said):
        cm.read_shape(path)

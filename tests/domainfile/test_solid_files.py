"""Every solid in a domain file, and mistakes in each shown at their line."""

import pytest

import csgmesh as cm
from csgmesh.csg.primitive import Primitive

TETRAHEDRON = "points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]"
SOLIDS = {
    "box": "lo: [0, 0, 0], hi: [1, 2, 3]",
    "half_space": "point: [0, 0, 0], normal: [0, 0, 1]",
    "ball": "center: [0, 0, 0], radius: 1",
    "ellipsoid": "center: [0, 0, 0], semi_axes: [1, 2, 3]",
    "cylinder": "base: [0, 0, 0], top: [0, 0, 2], radius: 1",
    "cone": "base: [0, 0, 0], top: [0, 0, 2], base_radius: 1, top_radius: 0.5",
    "torus": "center: [0, 0, 0], axis: [0, 0, 1], major_radius: 2, minor_radius: 0.5",
    "tetrahedron": "a: [0, 0, 0], b: [1, 0, 0], c: [0, 1, 0], d: [0, 0, 1]",
    "polyhedron": f"{TETRAHEDRON}, faces: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]",
    "faceted_solid": f"{TETRAHEDRON}, triangles: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], "
    "part_names: [foot, rest], part: [0, 1, 1, 1]",
    "extrude": "shape: {disk: {center: [0, 0], radius: 1}}, height: 2",
    "revolve": "shape: {disk: {center: [3, 0], radius: 1}}, angle: 90",
    "hull": "shapes: [{ball: {center: [0, 0, 0], radius: 1}}, {ball: {center: [3, 0, 0], "
    "radius: 1}}]",
}
MISTAKES = {
    "box": ("hi: [1, 2, 3]", "hi: [1, 2, -3]", "lo must be below hi"),
    "half_space": ("normal: [0, 0, 1]", "normal: [0, 0, 0]", "normal must not be zero"),
    "ball": ("radius: 1", "radius: 0", "radius must be positive"),
    "ellipsoid": ("semi_axes: [1, 2, 3]", "semi_axes: [1, 2]", "must have 3"),
    "cylinder": ("top: [0, 0, 2]", "top: [0, 0, 0]", "must be different points"),
    "cone": ("top_radius: 0.5", "top_radius: -1", "radii must not be negative"),
    "torus": ("minor_radius: 0.5", "minor_radius: 3", "minor_radius"),
    "tetrahedron": ("d: [0, 0, 1]", "d: [1, 1, 0]", "Tetrahedron"),
    "polyhedron": ("[1, 2, 3]]", "[1, 2, 4]]", "names point 4; there are 4 points"),
    "faceted_solid": ("[1, 2, 3]]", "[1, 2, 4]]", "whole numbers from 0 to 3; got 4"),
    "extrude": ("height: 2", "height: -2", "height must be positive"),
    "revolve": ("angle: 90", "angle: 400", "angle must be at most 360"),
    "hull": ("center: [3, 0, 0], radius: 1", "center: [3, 0, 0], radius: -1", "must be positive"),
}


def load(tmp_path, kind, arguments):
    path = tmp_path / "solid.yaml"
    # One argument a line: the mistake's line is its own.
    rows = arguments.replace(", hi", ",\n    hi").replace("}, {", "},\n    {")
    path.write_text(f"csgmesh: 1\nshapes:\n  part: {{{kind}: {{\n    {rows}}}}}\ndomain: part\n")
    return cm.load(path)


def test_no_solid_is_forgotten():
    planar = {"disk", "ellipse", "polygon", "triangle", "regular_polygon", "outline"}
    assert set(SOLIDS) == set(MISTAKES) == {
        kind for kind, leaf in Primitive.kinds.items() if leaf.__module__.startswith("csgmesh.")
    } - planar  # fmt: skip


@pytest.mark.parametrize("kind", SOLIDS)
def test_every_solid_is_loaded(tmp_path, kind):
    shape = load(tmp_path, kind, SOLIDS[kind]).shape
    assert shape.dim == 3
    assert shape.kind == kind
    if kind != "half_space":
        assert cm.evaluate(shape).volumes()[0] > 0
        assert all(name.startswith("part") for name in cm.evaluate(shape).names)


@pytest.mark.parametrize("kind", MISTAKES)
def test_a_mistake_is_shown_at_its_line(tmp_path, kind):
    before, after, said = MISTAKES[kind]
    assert before in SOLIDS[kind]
    with pytest.raises(cm.DomainFileError, match=said) as caught:
        load(tmp_path, kind, SOLIDS[kind].replace(before, after))
    assert caught.value.line in (3, 4, 5)
    expected = {"hull": 5, "ball": 4, "extrude": 4, "revolve": 4, "half_space": 4}
    assert caught.value.line == expected.get(kind, caught.value.line)


def test_an_unknown_argument_is_shown_at_its_place(tmp_path):
    with pytest.raises(cm.DomainFileError, match="unknown key 'radios'; did you mean 'radius'"):
        load(tmp_path, "ball", "center: [0, 0, 0], radios: 1")
    with pytest.raises(cm.DomainFileError, match=r":4:\d+: key 'radius' is missing|'radius'"):
        load(tmp_path, "ball", "center: [0, 0, 0]")


def test_shapes_from_other_programs(tmp_path):
    (tmp_path / "part.csg").write_text(
        "difference() { cube(size = [4, 4, 4], center = true);\n"
        "cylinder($fn = 20, h = 9, r1 = 1, r2 = 1, center = true); }"
    )
    cm.write(tmp_path / "block.stl", cm.generate(cm.Box((0, 0, 0), (1, 1, 1)), cm.Sweep(), size=1))
    path = tmp_path / "solid.yaml"
    text = (
        "csgmesh: 1\n"
        "shapes:\n"
        "  part: {read_shape: part.csg}\n"
        "  block: {read_shape: {path: block.stl, split_angle: 30}, translate: [9, 0, 0]}\n"
        "domain: {union: [part, block]}\n"
    )
    path.write_text(text)
    domain = cm.evaluate(cm.load(path).shape, deviation=1e-4)
    assert domain.volumes()[0] == pytest.approx(64 - 4 * 3.14159265 + 1, rel=1e-3)
    assert {"part.box.left", "part.cylinder.side", "block.block.face6"} <= set(domain.names)
    for before, after, said in (
        (
            "read_shape: part.csg",
            "read_shape: ../part.csg",
            "3:22: path must be a file in the fold",
        ),
        ("read_shape: part.csg", "read_shape: none.csg", "3:10: .*there is no such file"),
        ("read_shape: part.csg", "read_shape: {path: part.csg, facets_below: 1.5}", "3:"),
        ("split_angle: 30", "split_angle: 200", "4:.*split_angle must be more than 0"),
        ("split_angle: 30", "facets_below: 3", "4:.*no option 'facets_below'"),
    ):
        path.write_text(text.replace(before, after))
        with pytest.raises(cm.DomainFileError, match=said):
            cm.load(path)
    (tmp_path / "part.csg").write_text("cube(size = 1);\nminkowski() { }")
    path.write_text(text)
    with pytest.raises(cm.DomainFileError, match=r"part\.csg:2: minkowski is not supported"):
        cm.load(path)

"""OpenSCAD's exported trees: exact volumes, names in tree order, refusals by name and line."""

import numpy as np
import pytest
from numpy import pi

import csgmesh as cm

ROUND = "$fn = 0, $fa = 12, $fs = 2"


def polygon_area(n, r):
    return 0.5 * n * r * r * np.sin(2 * pi / n)


def moved(x, y, z):
    return f"multmatrix([[1, 0, 0, {x}], [0, 1, 0, {y}], [0, 0, 1, {z}], [0, 0, 0, 1]])"


SOLIDS = {
    "cube": ("cube(size = [10, 10, 10], center = true);", 1000),
    "cube of one number": ("cube(size = 2, center = false);", 8),
    "bored cube": (
        "difference() {\n\tcube(size = [10, 10, 10], center = true);\n\t"
        f"{moved(2, 0, 0)} {{\n\t\tcylinder({ROUND}, h = 20, r1 = 3, r2 = 3, center = true);\n"
        "\t}\n}",
        1000 - 90 * pi,
    ),
    "cone": (f"cylinder({ROUND}, h = 3, r1 = 2, r2 = 0, center = false);", 4 * pi),
    "sphere": (f"sphere({ROUND}, r = 2);", 32 * pi / 3),
    "fine sphere": ("sphere($fn = 100, $fa = 12, $fs = 2, r = 2);", 32 * pi / 3),
    "hexagonal prism": (
        "cylinder($fn = 6, $fa = 12, $fs = 2, h = 5, r1 = 2, r2 = 2, center = true);",
        5 * polygon_area(6, 2),
    ),
    "square pyramid": (
        "cylinder($fn = 4, $fa = 12, $fs = 2, h = 3, r1 = 2, r2 = 0, center = false);", 8
    ),
    "frustum": (
        "cylinder($fn = 4, $fa = 12, $fs = 2, h = 3, r1 = 2, r2 = 1, center = false);", 8 + 4 + 2
    ),
    # A sphere of four facets: two squares of radius sin 45°, at ± cos 45°.
    "coarse sphere": (
        "sphere($fn = 4, $fa = 12, $fs = 2, r = 2);", polygon_area(4, 2**0.5) * 2 * 2**0.5
    ),
    "plate": (
        f"linear_extrude(height = 3, center = true, convexity = 1, scale = [1, 1], {ROUND}) {{"
        f" difference() {{ square(size = [4, 4], center = true); circle({ROUND}, r = 1); }} }}",
        3 * (16 - pi),
    ),
    "frame": (
        "linear_extrude(height = 1, convexity = 1) { polygon(points = [[0, 0], [4, 0], [4, 4],"
        " [0, 4], [1, 1], [3, 1], [3, 3], [1, 3]], paths = [[0, 1, 2, 3], [4, 5, 6, 7]],"
        " convexity = 1); }",
        12,
    ),
    "ring": (
        f"rotate_extrude(angle = 360, convexity = 2, {ROUND}) {{ {moved(3, 0, 0)} {{"
        f" circle({ROUND}, r = 1); }} }}",
        6 * pi**2,
    ),
    "half ring, the other way": (
        f"rotate_extrude(angle = -180, convexity = 2, {ROUND}) {{ {moved(-3, 0, 0)} {{"
        f" circle({ROUND}, r = 1); }} }}",
        3 * pi**2,
    ),
    "rounded plate": (
        "hull() {"
        + "".join(
            f"{moved(x, y, 0)} {{ cylinder({ROUND}, h = 2, r1 = 1, r2 = 1, center = false); }}"
            for x in (0, 4)
            for y in (0, 3)
        )
        + "}",
        2 * (12 + 14 + pi),
    ),
    "polyhedron, clockwise": (
        "polyhedron(points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],"
        " faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], convexity = 1);",
        1 / 6,
    ),
    "groups, colours and modifiers": (
        "group() { color([1, 0, 0, 1]) { render(convexity = 2) { #cube(size = [1, 1, 1]); } }"
        " %cube(size = [9, 9, 9]); *sphere(r = 9); group(); }\n"
        f"{moved(5, 0, 0)} {{ cube(size = [1, 1, 2], center = false); }}",
        3,
    ),
    "mirrored and stretched": (
        "multmatrix([[-2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 3, 1], [0, 0, 0, 1]]) {"
        f" sphere({ROUND}, r = 1); }}",
        8 * pi,
    ),
    "intersection": (
        f"intersection() {{ cube(size = [2, 2, 2], center = false); sphere({ROUND}, r = 1); }}",
        pi / 6,
    ),
}  # fmt: skip


@pytest.fixture
def read(tmp_path):
    def reader(text, **options):
        path = tmp_path / "part.csg"
        path.write_text(text)
        return cm.read_shape(path, **options)

    return reader


@pytest.mark.parametrize("name", SOLIDS)
def test_volumes(read, name):
    text, volume = SOLIDS[name]
    shape = read(text)
    # What is flat is exact; what is round lies within its chords.
    is_round = f"({ROUND}" in text or "$fn = 100" in text
    within = 1e-2 if is_round else 1e-12
    assert cm.evaluate(shape).volumes()[0] == pytest.approx(volume, rel=within)


def test_round_things_are_exact_and_few_facets_are_meant(read):
    text = "cylinder($fn = {}, $fa = 12, $fs = 2, h = 2, r1 = 1, r2 = 1, center = false);"
    assert read(text.format(13)) == cm.Cylinder((0, 0, 0), (0, 0, 2), 1)
    twelve = cm.evaluate(read(text.format(12)))
    assert twelve.volumes()[0] == pytest.approx(2 * polygon_area(12, 1), rel=1e-12)
    assert read(text.format(12), facets_below=11) == cm.Cylinder((0, 0, 0), (0, 0, 2), 1)
    assert read(text.format(5), facets_below=0) == cm.Cylinder((0, 0, 0), (0, 0, 2), 1)
    forty = cm.evaluate(read(text.format(40), facets_below=40))
    assert forty.volumes()[0] == pytest.approx(2 * polygon_area(40, 1), rel=1e-12)


def test_names_are_kinds_in_tree_order(read):
    text = SOLIDS["bored cube"][0]
    bored = ("box.left", "box.right", "box.bottom", "box.top", "box.front", "box.back")
    assert cm.evaluate(read(text)).names == (*bored, "cylinder.side")
    named = cm.evaluate(read(text, name="part"))
    assert named.names[-1] == "part.cylinder.side"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("\n\nminkowski(convexity = 0) { cube(size = [1, 1, 1]); }", ":3: minkowski is not supp"),
        ('group() {\n text(text = "a", size = 10);\n}', ":2: text is not supported"),
        ('import(file = "a.stl", layer = "");', ":1: import is not supported"),
        ("offset(r = 1) { square(size = [1, 1]); }", ":1: offset is not supported"),
        ("projection(cut = false) { cube(size = 1); }", "projection is not supported"),
        ("linear_extrude(height = 5, twist = 90) {\nsquare(size = 1);\n}", ":1: .*twist .*got 90"),
        ("linear_extrude(height = 5, scale = [1, 2]) { square(size = 1); }", r"scale .*2\.0"),
        ("linear_extrude(height = 5) { cube(size = 1); }", "must lie in the plane"),
        ("rotate_extrude($fn = 8) { square(size = 1); }", r"\$fn is 8"),
        ("rotate_extrude() { square(size = [2, 2], center = true); }", "one side of x = 0"),
        ("difference() { cube(size = 1); square(size = 1); }", "same dimension"),
        ("multmatrix([[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) { cube(size = 1); }",
         "must be invertible"),
        ("multmatrix([[1, 0], [0, 1]]) { cube(size = 1); }", "4 rows of 4 numbers"),
        ("cube(size = [1, 1]);", "size must be 3 numbers"),
        ("cube(size = inf);", "must be finite"),
        ("cube(size = 1e999);", "must be finite"),
        ("cubes(size = 1);", ":1: cubes is not known; did you mean 'cube'"),
        ("group() {\ncube(size = 1);\n", "group of line 1 is not closed"),
        ("cube(size = 1)", "expected ';'"),
        ("cube(size = [1, 2", "expected"),
        ("}", "closing brace"),
        ("polyhedron(points = [[0, 0, 0]], faces = [[0, 1, 2]]);", "whole, from 0 to 0"),
        ("cube(size = " + "[" * 50, "at most 8 deep"),
        ("\x00\x01", "unexpected"),
        ("sphere(r = -1);", "makes nothing"),
        ("", "makes nothing"),
    ],
)  # fmt: skip
def test_refusals_name_the_line(read, text, said):
    with pytest.raises(cm.FileFormatError, match=said):
        read(text)


def test_deep_trees(read):
    text = "group() {" * 3000 + "cube(size = 1);" + "}" * 3000
    assert read(text) == cm.Box((0, 0, 0), (1, 1, 1))
    with pytest.raises(cm.FileFormatError, match="at most 5,000 deep"):
        read("group() {" * 6000)


def test_empty_operands_follow_openscad(read):
    # Nothing less something is nothing; something less nothing is itself.
    with pytest.raises(cm.FileFormatError, match="makes nothing"):
        read("difference() { group(); cube(size = 1); }")
    assert read("difference() { cube(size = 1); group(); }") == cm.Box((0, 0, 0), (1, 1, 1))
    with pytest.raises(cm.FileFormatError, match="makes nothing"):
        read("intersection() { cube(size = 1); group(); }")


def test_options_are_checked(read, tmp_path):
    with pytest.raises(cm.InputError, match="no option 'facets_bellow'; did you mean"):
        read("cube(size = 1);", facets_bellow=3)
    with pytest.raises(cm.InputError, match="facets_below must be a whole number"):
        read("cube(size = 1);", facets_below=-1)
    with pytest.raises(cm.FileFormatError, match="no such file"):
        cm.read_shape(tmp_path / "nothing.csg")
    with pytest.raises(cm.FileFormatError, match=r"shapes are read from \.stl"):
        cm.read_shape(tmp_path / "part.step")

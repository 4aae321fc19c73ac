"""Every mistake is answered with its line, its column and what is wrong."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from csgmesh.domainfile import Limits, load
from csgmesh.errors import DomainFileError, InputError

HEAD = "csgmesh: 1\n"
PLATE = HEAD + "domain: {box: {lo: [0, 0], hi: [1, 1]}}\n"


def shapes(*lines: str, domain: str = "a") -> str:
    """A file whose shapes begin in line 3."""
    return f"{HEAD}shapes:\n" + "".join(f"  {line}\n" for line in lines) + f"domain: {domain}\n"


BAD = {
    # YAML itself
    "unclosed list": (HEAD + "domain: [1, 2\n", 3, 1, "expected ',' or ']'"),
    "tab": (HEAD + "\tdomain: 1\n", 2, 1, "cannot start any token"),
    "colon in value": (HEAD + "domain: a: b\n", 2, 10, "mapping values are not allowed"),
    "control character": (HEAD + "domain: a\x00\n", 2, 10, "U+0000"),
    "two documents": (PLATE + "---\na: 1\n", 3, 1, "one YAML document"),
    "repeated key": (PLATE + "domain: a\n", 3, 1, "'domain' stands twice; first in line 2"),
    "tag": (HEAD + "domain: !!python/name:os.system x\n", 2, 9, "tags are not allowed"),
    "tag of a mapping": (HEAD + "domain: !!python/object:a.B {}\n", 2, 9, "tags are not allowed"),
    "merge key": (HEAD + "domain: {<<: {box: 1}}\n", 2, 10, "merge keys"),
    "unknown alias": (HEAD + "domain: *plate\n", 2, 9, "no anchor before it"),
    "alias in itself": (HEAD + "domain: &a {union: [*a]}\n", 2, 21, "inside its own value"),
    "list as key": (HEAD + "? [a]\n: b\n", 2, 3, "a key must be a word"),
    "infinity": (HEAD + "domain: {box: {lo: [0, .inf]}}\n", 2, 24, "must be finite"),
    "overflowing number": (HEAD + "domain: {box: {lo: [0, 1e999]}}\n", 2, 24, "must be finite"),
    "endless number": (HEAD + f"domain: {'9' * 1000}\n", 2, 9, "400 digits"),
    # the file
    "empty": ("", 1, 1, "not nothing"),
    "a list": ("- 1\n", 1, 1, "not a list"),
    "no version": ("domain: a\n", 1, 1, "key 'csgmesh' is missing"),
    "other version": ("csgmesh: 2\ndomain: a\n", 1, 10, "version 1, not 2"),
    "no domain": (HEAD, 1, 1, "key 'domain' is missing"),
    "domain and regions": (PLATE + "regions: {}\n", 3, 1, "not both"),
    "unknown key": (PLATE + "meshes: {}\n", 3, 1, "unknown key 'meshes'; did you mean 'mesh'"),
    # parameters
    "parameter unknown": (
        HEAD + "parameters: {r: 1, s: $(2*q)}\ndomain: a\n", 2, 27, "unknown name 'q'",
    ),
    "parameters in a circle": (
        HEAD + "parameters: {a: $b, b: $(c + 1), c: $a}\ndomain: a\n", 2, 37,
        "in a circle: a → b → c → a",
    ),
    "parameter taken": (HEAD + "parameters:\n  x: 1\ndomain: a\n", 3, 3, "'x' is taken"),
    "parameter no name": (HEAD + "parameters:\n  a-b: 1\ndomain: a\n", 3, 3, "letters, digits"),
    "parameter a word": (HEAD + "parameters: {r: wide}\ndomain: a\n", 2, 17, "not 'wide'"),
    "parameters a list": (HEAD + "parameters: [1]\ndomain: a\n", 2, 13, "not a list"),
    "division by zero": (
        HEAD + "parameters: {r: 0, s: $(1 / r)}\ndomain: a\n", 2, 27, "division by zero",
    ),
    # shapes
    "unknown shape": (shapes("a: {bx: {}}"), 3, 7, "unknown key 'bx'; did you mean 'box'"),
    "no shape": (shapes("a: {translate: [1, 0]}"), 3, 6, "a key that says what it is"),
    "two shapes": (
        shapes("a: {disk: {center: [0, 0], radius: 1}, box: {lo: [0, 0], hi: [1, 1]}}"), 3, 42,
        "disk and box, not both",
    ),
    "shape a number": (shapes("a: 3"), 3, 6, "expected a mapping with keys such as"),
    "shape nothing": (shapes("a:"), 3, 3, "not nothing"),
    "unknown argument": (
        shapes("a:", "  disk: {center: [0, 0], radios: 1}"), 4, 28,
        "unknown key 'radios'; did you mean 'radius'?",
    ),
    "missing argument": (shapes("a:", "  disk: {center: [0, 0]}"), 4, 5, "'radius' is missing"),
    "argument a word": (
        shapes("a: {disk: {center: [0, 0], radius: wide}}"), 3, 38,
        "expected a number, not 'wide'",
    ),
    "argument in a list": (
        shapes("a: {disk: {center: [0, wide], radius: 1}}"), 3, 26, "expected a number, not 'wide'",
    ),
    "point a number": (shapes("a: {disk: {center: 0, radius: 1}}"), 3, 22, "expected a list"),
    "negative radius": (
        shapes("a: {disk: {center: [0, 0], radius: -1}}"), 3, 38, "radius must be positive",
    ),
    "three coordinates": (
        shapes("a: {disk: {center: [0, 0, 0], radius: 1}}"), 3, 22, "center must have 2",
    ),
    "inverted box": (
        shapes("a: {box: {lo: [1, 1], hi: [0, 0]}}"), 3, 17, "lo must be below hi",
    ),
    "zero scale": (
        shapes("a: {disk: {center: [0, 0], radius: 1}, scale: 0}"), 3, 42, "no factor may be zero",
    ),
    "mirror half": (
        shapes("a: {disk: {center: [0, 0], radius: 1}, mirror: {point: [0, 0]}}"), 3, 42,
        "'normal' is missing",
    ),
    "name a number": (
        shapes("a: {disk: {center: [0, 0], radius: 1, name: 3}}"), 3, 47, "quote it",
    ),
    "glob in a name": (
        shapes("a*: {disk: {center: [0, 0], radius: 1}}"), 3, 3, "a name must not contain",
    ),
    "unknown reference": (
        shapes("plate: {box: {lo: [0, 0], hi: [1, 1]}}", domain="{difference: [plate, hole]}"),
        4, 30, "no shape is called 'hole'; there are 'plate'",
    ),
    "misspelt reference": (
        shapes("plate: {box: {lo: [0, 0], hi: [1, 1]}}", domain="plaet"), 4, 9,
        "did you mean 'plate'?",
    ),
    "shapes in a circle": (
        shapes("a: {union: [b]}", "b: {complement: {shape: c}}", "c: a"), 5, 6,
        "in a circle: a → b → c → a",
    ),
    "shape of itself": (shapes("a: {union: [a]}"), 3, 15, "in a circle: a → a"),
    "union of one": (shapes("a: {union: b}", "b: a"), 3, 14, "expected a list, not 'b'"),
    "empty union": (shapes("a: {union: []}"), 3, 7, "at least one shape"),
    "complement of text": (shapes("a: {complement: 3}"), 3, 19, "expected a mapping"),
    "unknown fill": (
        shapes("a:", "  outline:", "    contours: [[[0, 0], [1, 0], [0, 1]]]", "    fill: odd"),
        6, 13, "fill must be",
    ),
    "transformed regions": (
        HEAD + "domain: {regions: {a: {disk: {center: [0, 0], radius: 1}}}, rotate: 3}\n", 2, 61,
        "regions takes no transformations",
    ),
    # expressions
    "unclosed expression": (
        shapes("a: {disk: {center: [0, 0], radius: $(1 + 2}}"), 3, 45, "expected ')'",
    ),
    "unquoted comma": (
        shapes("a: {disk: {center: [$(max(1, 2)), 0], radius: 1}}"), 3, 30,
        "quote an expression with a comma",
    ),
    "power": (shapes("a: {disk: {center: [0, 0], radius: $(2^2)}}"), 3, 41, "written **"),
    "in quotes": (
        shapes("a: {disk: {center: [0, 0], radius: '$(2*q)'}}"), 3, 43, "unknown name 'q'",
    ),
    "coordinate in a shape": (
        shapes("a: {disk: {center: [0, 0], radius: $x}}"), 3, 38, "coordinates stand in sizes only",
    ),
    # mesh
    "unknown mesher": (PLATE + "mesh: {delaunay: {}}\n", 3, 8, "unknown key 'delaunay'"),
    "two meshers": (
        PLATE + "mesh: {delaunay_refinement: {}, constrained_delaunay: {}}\n", 3, 33,
        "one mesher, not",
    ),
    "unknown option": (
        PLATE + "mesh: {delaunay_refinement: {min_angel: 20}}\n", 3, 30,
        "unknown key 'min_angel'; did you mean 'min_angle'?",
    ),
    "option out of range": (
        PLATE + "mesh: {delaunay_refinement: {min_angle: 50}}\n", 3, 41, "min_angle must",
    ),
    "option a flag": (
        PLATE + "mesh: {delaunay_refinement: {min_angle: true}}\n", 3, 41,
        "expected a number, not true",
    ),
    "size left out": (PLATE + "mesh:\n  size:\n", 4, 3, "'size' has no value"),
    "mesh left out": (PLATE + "mesh:\n", 3, 1, "'mesh' has no value"),
    "expectation left out": (PLATE + "expect: {area: }\n", 3, 10, "'area' has no value"),
    "negative size": (PLATE + "mesh: {size: {default: -1}}\n", 3, 24, "must be positive, not -1"),
    "zero constant size": (PLATE + 'mesh: {size: "1 - 1"}\n', 3, 14, "must be positive, not 0"),
    "size of z": (
        PLATE + 'mesh: {size: {default: "0.1 + z"}}\n', 3, 31, "as far as the domain has them",
    ),
    "size of a coordinate in capitals": (
        PLATE + 'mesh: {size: "0.1 + X"}\n', 3, 21, "'0.1 + X'; did you mean 'x'?",
    ),
    "size unparsable": (PLATE + "mesh: {size: {default: 2 + }}\n", 3, 27, "expected a number"),
    "negative deviation": (PLATE + "mesh: {deviation: 0}\n", 3, 19, "positive number"),
    # output and expect
    "output elsewhere": (PLATE + "output: [a.msh, ../../b.msh]\n", 3, 17, "in the folder of"),
    "output absolute": (PLATE + "output: [/etc/passwd]\n", 3, 10, "in the folder of"),
    "output of no format": (PLATE + "output: [a.mhs]\n", 3, 10, "did you mean '.msh'"),
    "output a word": (PLATE + "output: a.msh\n", 3, 9, "expected a list, not 'a.msh'"),
    "expected a word": (PLATE + "expect: {area: large}\n", 3, 16, "a comparison such as"),
    "expected a triple": (PLATE + "expect: {cells: [1, 2, 3]}\n", 3, 17, "[lowest, highest]"),
    "expected backwards": (PLATE + "expect: {cells: [3, 1]}\n", 3, 17, "not [3, 1]"),
    "expected unknown": (PLATE + "expect: {aera: 1}\n", 3, 10, "did you mean 'area'"),
    "expected of a boundary": (
        PLATE + "expect: {boundary: {box: {lenght: 4}}}\n", 3, 27, "did you mean 'length'?",
    ),
    "comparison unparsable": (PLATE + 'expect: {cells: ">= many"}\n', 3, 21, "unknown name 'many'"),
}  # fmt: skip


def error_of(tmp_path: Path, text: str, limits: Limits | None = None) -> DomainFileError:
    """The error of loading a text as a file."""
    path = tmp_path / "bad.yaml"
    path.write_bytes(text.encode())
    with pytest.raises(DomainFileError) as caught:
        load(path, limits=limits)
    return caught.value


@pytest.mark.parametrize("case", BAD, ids=lambda name: name.replace(" ", "_"))
def test_place_and_message(case: str, tmp_path: Path) -> None:
    text, line, column, fragment = BAD[case]
    error = error_of(tmp_path, text)
    assert fragment in str(error)
    assert (error.line, error.column) == (line, column)
    assert str(error).startswith(f"{tmp_path / 'bad.yaml'}:{line}:{column}: ")


def test_all_mistakes_are_reported_in_the_order_of_the_file(tmp_path: Path) -> None:
    text = shapes(
        "a: {disk: {center: [0, 0], radius: wide}}",
        "b: {disk: {center: [0, 0], radius: wide}}",
        "c: {bx: {}}",
    )
    lines = str(error_of(tmp_path, text)).splitlines()
    assert [re.search(r":(\d+):\d+: ", line).group(1) for line in lines] == ["3", "4", "5"]


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(DomainFileError, match="cannot be read: No such file"):
        load(tmp_path / "none.yaml")


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_bytes(b"csgmesh: 1\ndomain: \xff\xfe")
    with pytest.raises(DomainFileError, match=r":2:9: .*UTF-8"):
        load(path)


def test_an_unknown_override(tmp_path: Path) -> None:
    path = tmp_path / "plate.yaml"
    path.write_text(PLATE + "parameters: {radius: 1}\n")
    with pytest.raises(InputError, match="no parameter 'radios'; did you mean 'radius'"):
        load(path, parameters={"radios": 1})
    with pytest.raises(InputError, match="value of parameter 'radius': unknown name 'q'"):
        load(path, parameters={"radius": "2*q"})


# -- what strangers may ask for -------------------------------------------------------------------


def laughs(levels: int) -> str:
    """A short text whose aliases expand to 9**levels values."""
    lines = ["a0: &a0 [" + ", ".join("1" * 9) + "]"]
    lines += [f"a{i}: &a{i} [" + ", ".join([f"*a{i - 1}"] * 9) + "]" for i in range(1, levels)]
    return "\n".join(lines)


HOSTILE = {
    "billion laughs": (laughs(30), "limit values"),
    "deep lists": ("[" * 300_000, "limit nesting"),
    "deep mappings": ("{a: " * 100_000, "limit nesting"),
    "deep block": ("\n".join(" " * i + "a:" for i in range(1000)), "limit nesting"),
    "deep by aliases": (
        "a0: &a0 [1]\n" + "\n".join(f"a{i}: &a{i} [*a{i - 1}]" for i in range(1, 200)),
        "limit nesting",
    ),
    "long file": ("# " + "x" * 3_000_000, "limit file_size"),
    "long expression": (
        PLATE + "parameters: {r: $(" + "+".join("1" * 5000) + ")}\n", "at most 1000 characters",
    ),
    "deep expression": (PLATE + "parameters: {r: $" + "(" * 400 + "}\n", "at most 50 levels"),
    "deep signs": (PLATE + "parameters: {r: $(" + "-" * 400 + "1)}\n", "at most 50 levels"),
    "towering power": (PLATE + "parameters: {r: $(9**9**9**9)}\n", "overflow"),
    "doubling shapes": (
        shapes(
            "a0: {disk: {center: [0, 0], radius: 1}}",
            *(f"a{i}: {{union: [a{i - 1}, a{i - 1}]}}" for i in range(1, 40)),
            domain="a39",
        ),
        "limit leaves",
    ),
    "long chain of shapes": (
        shapes(
            "a0: {disk: {center: [0, 0], radius: 1}}",
            *(f"a{i}: {{shape: a{i - 1}}}" for i in range(1, 3000)),
            domain="a2999",
        ),
        "limit nesting",
    ),
    "long name": (
        shapes("a" * 500 + ": {disk: {center: [0, 0], radius: 1}}"), "200 characters",
    ),
    "endless polygon": (
        shapes("a: {regular_polygon: {center: [0, 0], radius: 1, n: 100000000000}}"),
        "limit values",
    ),
    "endless chords": (
        HEAD + "domain: {disk: {center: [0, 0], radius: 1}}\nmesh: {deviation: 1e-18}\n",
        "limit cells",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", HOSTILE, ids=lambda name: name.replace(" ", "_"))
def test_a_hostile_file_ends_in_an_error(case: str, tmp_path: Path) -> None:
    text, fragment = HOSTILE[case]
    assert fragment in str(error_of(tmp_path, text))


def test_limits_can_be_raised(tmp_path: Path) -> None:
    path = tmp_path / "deep.yaml"
    text = "{complement: " * 60 + "{disk: {center: [0, 0], radius: 1}}" + "}" * 60
    path.write_text(HEAD + f"domain: {text}\n")
    with pytest.raises(DomainFileError, match="limit nesting"):
        load(path)
    assert load(path, limits=Limits(nesting=90)).shape.n_leaves == 1


def test_limits_that_do_not_exist() -> None:
    with pytest.raises(InputError, match="no option 'cels'; did you mean 'cells'"):
        Limits().raised(cels=3)
    with pytest.raises(InputError, match="positive whole number"):
        Limits(cells=0)

"""What a domain file means."""

from __future__ import annotations

import json
import math
import textwrap
from pathlib import Path

import numpy as np
import pytest

import csgmesh as cm
from csgmesh.domainfile import DomainFile, Limits, json_schema, load

EXAMPLE = """\
csgmesh: 1
parameters: {r: 0.5}
shapes:
  plate: {box: {lo: [0, 0], hi: [4, 2]}}
  hole: {disk: {center: [2, 1], radius: $r}, translate: [0, $(r / 10)]}
domain: {difference: [plate, hole]}          # or  regions: {rock: …, core: …}
mesh:
  delaunay_refinement: {min_angle: 30}
  size: {default: 0.2, hole: 0.03, "plate.*": "0.1 + 0.02*x"}
output: [plate.msh, plate.png]
expect:                                      # a geometry regression test
  area: 7.2146
  min_angle: ">= 30"
  cells: [500, 3000]
  boundary: {hole: {length: 3.14159}}
"""


def loaded(folder: Path, text: str, **options: object) -> DomainFile:
    """Load a text as a file."""
    path = folder / "domain.yaml"
    path.write_text(textwrap.dedent(text), encoding="utf-8")
    return load(path, **options)


def shape(folder: Path, text: str) -> object:
    """The shape of a file with this domain."""
    return loaded(folder, f"csgmesh: 1\ndomain: {text}\n").shape


def test_the_example_of_the_documentation(tmp_path: Path) -> None:
    file = loaded(tmp_path, EXAMPLE)
    plate = cm.Box((0, 0), (4, 2), name="plate")
    hole = cm.Disk((2, 1), 0.5, name="hole").translate((0, 0.05))
    assert file.shape == plate - hole
    assert file.mesher == cm.DelaunayRefinement(min_angle=30)
    assert file.size["default"] == 0.2
    assert file.size["plate.*"](np.array([[0.0, 0.0], [4.0, 2.0]])).tolist() == [0.1, 0.18]
    assert file.output == (tmp_path / "plate.msh", tmp_path / "plate.png")
    assert file.parameters == {"r": 0.5}
    mesh = file.generate()
    assert file.mismatches(mesh) == []
    assert mesh.names == ("plate.left", "plate.right", "plate.bottom", "plate.top", "hole")
    assert cm.check(mesh, file.shape).ok


def test_parameters_are_replaced_and_may_stand_in_any_order(tmp_path: Path) -> None:
    text = """\
    csgmesh: 1
    parameters: {area: $(pi*r**2), r: $(d/2), d: 2}
    domain: {disk: {center: [0, 0], radius: $r}}
    expect: {area: $area}
    """
    assert loaded(tmp_path, text).parameters == {"area": math.pi, "r": 1.0, "d": 2.0}
    replaced = loaded(tmp_path, text, parameters={"d": 4, "area": "10 + r"})
    assert replaced.parameters == {"area": 12.0, "r": 2.0, "d": 4.0}
    assert replaced.shape == cm.Disk((0, 0), 2)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{half_space: {point: [0, 0], normal: [1, 0]}}", cm.HalfSpace((0, 0), (1, 0))),
        ("{ellipse: {center: [0, 0], semi_axes: [2, 1], angle: 30}}",
         cm.Ellipse((0, 0), (2, 1), 30)),
        ("{triangle: {a: [0, 0], b: [1, 0], c: [0, 1]}}", cm.Triangle((0, 0), (1, 0), (0, 1))),
        ("{regular_polygon: {center: [0, 0], radius: 1, n: 6}}", cm.RegularPolygon((0, 0), 1, 6)),
        ("{polygon: {points: [[0, 0], [9, 0], [0, 9]], holes: [[[1, 1], [2, 1], [1, 2]]]}}",
         cm.Polygon([(0, 0), (9, 0), (0, 9)], [[(1, 1), (2, 1), (1, 2)]])),
        ("{polygon: [[0, 0], [9, 0], [0, 9]]}", cm.Polygon([(0, 0), (9, 0), (0, 9)])),
        ("{outline: {contours: [[[0, 0], [2, 0], [arc, [1, 1], [0, 0]]]], fill: evenodd}}",
         cm.Outline([[(0, 0), (2, 0), ("arc", (1, 1), (0, 0))]], fill="evenodd")),
        ("{disk: {center: [0, 0], radius: 1, name: rim}}", cm.Disk((0, 0), 1, name="rim")),
        ("{complement: {disk: {center: [0, 0], radius: 1}}}", ~cm.Disk((0, 0), 1)),
        ("{disk: {center: [0, 0], radius: 1}, complement: true}", ~cm.Disk((0, 0), 1)),
        ("{disk: {center: [0, 0], radius: 1}, complement: false}", cm.Disk((0, 0), 1)),
        ("{disk: {center: [0, 0], radius: 1}, scale: [2, 1], rotate: 90}",
         cm.Disk((0, 0), 1).scale((2, 1)).rotate(90)),
        ("{disk: {center: [0, 0], radius: 1}, rotate: 90, scale: [2, 1]}",
         cm.Disk((0, 0), 1).rotate(90).scale((2, 1))),
        ("{translate: [1, 0], disk: {center: [0, 0], radius: 1}, "
         "rotate: {degrees: 90, center: [1, 1]}}",
         cm.Disk((0, 0), 1).translate((1, 0)).rotate(90, center=(1, 1))),
        ("{disk: {center: [1, 0], radius: 1}, mirror: {point: [0, 0], normal: [1, 0]}}",
         cm.Disk((1, 0), 1).mirror((0, 0), (1, 0))),
        ("{disk: {center: [1, 0], radius: 1}, scale: {s: 2, center: [1, 0]}, named: hole}",
         cm.Disk((1, 0), 1).scale(2, center=(1, 0)).named("hole")),
        ("{shape: {disk: {center: [0, 0], radius: 1}, translate: [1, 0]}, translate: [0, 1]}",
         cm.Disk((0, 0), 1).translate((1, 1))),
    ],
)  # fmt: skip
def test_shapes_and_transformations(text: str, expected: object, tmp_path: Path) -> None:
    assert shape(tmp_path, text) == expected


@pytest.mark.parametrize(
    "operation", ["union", "intersection", "difference", "symmetric_difference"]
)
def test_booleans(operation: str, tmp_path: Path) -> None:
    a, b, c = (cm.Disk((x, 0), 1) for x in range(3))
    disks = ", ".join(f"{{disk: {{center: [{x}, 0], radius: 1}}}}" for x in range(3))
    wanted = {"union": a | b | c, "intersection": a & b & c, "difference": a - b - c,
              "symmetric_difference": a ^ b ^ c}  # fmt: skip
    assert shape(tmp_path, f"{{{operation}: [{disks}]}}") == wanted[operation]


def test_names_of_shapes_are_their_names_in_the_tree(tmp_path: Path) -> None:
    file = loaded(
        tmp_path,
        """\
        csgmesh: 1
        shapes:
          bracket: {difference: [plate, {shape: hole, translate: [1, 0], named: left}, hole]}
          plate: {box: {lo: [0, 0], hi: [4, 2]}, rotate: 90}
          hole: &hole {disk: {center: [0, 0], radius: 0.1}, complement: true, complement: true}
        domain: bracket
        """.replace(", complement: true, complement: true", ""),
    )
    plate = cm.Box((0, 0), (4, 2), name="plate").rotate(90)
    hole = cm.Disk((0, 0), 0.1, name="hole")
    moved = hole.translate((1, 0)).named("left")
    assert file.shape == (plate - moved - hole).named("bracket")


def test_regions_stand_alone_or_in_the_domain(tmp_path: Path) -> None:
    rock, core = cm.Box((0, 0), (4, 2)), cm.Disk((2, 1), 0.5, name="core")
    head = "csgmesh: 1\nshapes: {core: {disk: {center: [2, 1], radius: 0.5}}}\n"
    regions = "regions: {rock: {box: {lo: [0, 0], hi: [4, 2]}}, middle: core}"
    for text in (f"{head}{regions}\n", f"{head}domain: {{{regions}}}\n"):
        assert loaded(tmp_path, text).shape == cm.Regions({"rock": rock, "middle": core})


def test_embedded_paths_and_points(tmp_path: Path) -> None:
    text = """\
    embed:
        shape: {box: {lo: [0, 0], hi: [4, 2]}}
        items:
          - embedded_path: {points: [[1, 1], [2, 1]], name: crack}
          - embedded_points: [[3, 1]]
    """
    crack = cm.EmbeddedPath([(1, 1), (2, 1)], name="crack")
    wanted = cm.Embed(cm.Box((0, 0), (4, 2)), [crack, cm.EmbeddedPoints([(3, 1)])])
    assert shape(tmp_path, "\n  " + text) == wanted


def test_every_primitive_and_mesher_has_its_key() -> None:
    schema = json_schema()["$defs"]
    primitives = {
        value.kind
        for value in vars(cm.csg).values()
        if isinstance(value, type) and issubclass(value, cm.Primitive) and value is not cm.Primitive
    }
    assert primitives <= set(schema["Shape"]["properties"])
    assert {"delaunay_refinement", "constrained_delaunay"} <= set(schema["Mesh"]["properties"])


def test_what_a_file_leaves_out(tmp_path: Path) -> None:
    file = loaded(tmp_path, "csgmesh: 1\ndomain: {disk: {center: [0, 0], radius: 1}}\n")
    left_out = (file.mesher, file.size, file.deviation, file.snap, file.expect)
    assert left_out == (None,) * 5
    assert file.output == ()
    assert file.generate().n_cells > 10


def test_options_of_the_evaluation_arrive(tmp_path: Path) -> None:
    text = """\
    csgmesh: 1
    domain: {disk: {center: [0, 0], radius: 1}}
    mesh: {constrained_delaunay: , deviation: 0.1, snap: 1e-6}
    """
    mesh = loaded(tmp_path, text).generate()
    assert mesh.n_facets < 20
    assert mesh.domain.snap == 1e-6


def test_yaml_is_that_of_version_1_2(tmp_path: Path) -> None:
    text = """\
    csgmesh: 1
    shapes:
      on: {disk: {center: [0, 0], radius: 1.}}
      no: {disk: {center: [+0, -0.0], radius: .5e1}}
    domain: {union: [on, no]}
    """
    assert loaded(tmp_path, text).shape.contains([[0, 4]]).tolist() == [True]


def test_sizes_are_errors_at_their_place(tmp_path: Path) -> None:
    head = "csgmesh: 1\ndomain: {box: {lo: [0, 0], hi: [2, 1]}}\n"
    file = loaded(tmp_path, head + "mesh: {size: {default: 1, box.lift: 2}}\n")
    with pytest.raises(cm.DomainFileError, match=r":3:27: no boundary .*did you mean 'box.left'"):
        file.generate()
    file = loaded(tmp_path, head + 'mesh: {size: {default: 1, box.left: "y - 0.5"}}\n')
    with pytest.raises(cm.DomainFileError, match=r":3:27: size 'y - 0.5' must be positive"):
        file.generate()


def test_errors_of_the_evaluation_have_a_place(tmp_path: Path) -> None:
    text = """\
    csgmesh: 1
    shapes:
      star: {polygon: [[0, 0], [1, 1], [1, 0], [0, 1]]}
      part: {union: [star, {disk: {center: [5, 5], radius: 1}}]}
    domain: part
    """
    with pytest.raises(cm.DomainFileError, match=r":3:3: polygon .* crosses or overlaps itself"):
        loaded(tmp_path, text).generate()
    text = """\
    csgmesh: 1
    domain: {difference: [&d {disk: {center: [0, 0], radius: 1}}, *d]}
    """
    with pytest.raises(cm.EmptyDomainError, match=r":2:1: the domain is empty"):
        loaded(tmp_path, text).generate()


def test_the_limit_on_cells_holds(tmp_path: Path) -> None:
    head = "csgmesh: 1\ndomain: {box: {lo: [0, 0], hi: [1, 1]}}\n"
    greedy = head + "mesh: {size: 0.01, delaunay_refinement: {max_points: 1000000000}}\n"
    with pytest.raises(cm.BudgetError, match=r"may ask for 100 cells \(limit cells\)"):
        loaded(tmp_path, greedy, limits=Limits(cells=100)).generate()
    text = head + "mesh: {size: 0.1}\n"
    n_cells = loaded(tmp_path, text).generate().n_cells
    assert loaded(tmp_path, text, limits=Limits(cells=2 * n_cells)).generate().n_cells == n_cells


def test_expectations_fail_at_their_place(tmp_path: Path) -> None:
    file = loaded(tmp_path, EXAMPLE.replace("7.2146", "7.3").replace("length: 3.1", "length: 3.2"))
    found = [
        (m.path, place.rpartition("domain.yaml:")[2])
        for m, place in file.mismatches(file.generate())
    ]
    assert found == [(("area",), "12:9"), (("boundary", "hole", "length"), "15:29")]


# -- the JSON Schema ------------------------------------------------------------------------------


def test_the_json_schema_is_closed_and_complete() -> None:
    schema = json_schema()
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["additionalProperties"] is False
    text = json.dumps(schema)
    names = {part.split('"')[0] for part in text.split("#/$defs/")[1:]}
    assert names <= set(schema["$defs"])
    for name, definition in schema["$defs"].items():
        mapping = definition if "properties" in definition else definition["anyOf"][0]
        assert mapping["additionalProperties"] is False, name


def test_the_json_schema_agrees_with_the_loader() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    from csgmesh.domainfile.document import parse_document

    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    assert list(validator.iter_errors(parse_document(EXAMPLE, "", Limits()).data)) == []
    for old, new in (
        ("box", "bx"), ("lo:", "low:"), ("min_angle: 30", "min_angle: wide"), ("csgmesh: 1", ""),
        ("size:", "sizes:"), ("[500, 3000]", "[500]"), ("[plate.msh, plate.png]", "plate.msh"),
        ("difference: [", "translate: ["), ('">= 30"', "true"),
    ):  # fmt: skip
        data = parse_document(EXAMPLE.replace(old, new), "", Limits()).data
        assert list(validator.iter_errors(data)), (old, new)

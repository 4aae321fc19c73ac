"""Names: given in the tree, numbered in tree order, unchanged by what is appended."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from random_trees import trees

import csgmesh as cm
from csgmesh.csg.program import compile_shape


def names(shape: cm.Shape | cm.Regions | cm.Embed) -> list[str]:
    return [name for leaf in compile_shape(shape).leaves for name in leaf.names]


A, B, C = (cm.Disk((3 * k, 0), 1) for k in range(3))


def test_parts_and_kinds() -> None:
    plate = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
    assert names(plate) == ["plate.left", "plate.right", "plate.bottom", "plate.top", "hole"]
    assert names(A | B | C) == ["disk", "disk.2", "disk.3"]
    boxes = cm.Box((0, 0), (1, 1)) | cm.Box((2, 0), (3, 1))
    assert names(boxes)[3:5] == ["box.top", "box.2.left"]
    assert names(cm.HalfSpace((0, 0), (1, 0)) & cm.RegularPolygon((0, 0), 1, 5)) == [
        "half_space",
        "regular_polygon",
    ]


def test_compounds_prefix_and_nest() -> None:
    bracket = (cm.Box((0, 0), (1, 1), name="plate") - A).named("bracket")
    assert names(bracket)[0] == "bracket.plate.left"
    assert names(bracket)[-1] == "bracket.disk"
    assert names(bracket.named("machine"))[-1] == "machine.bracket.disk"
    assert names((bracket | B).named("machine"))[-2:] == ["machine.bracket.disk", "machine.disk"]
    assert names(bracket | B | C)[-3:] == ["bracket.disk", "disk", "disk.2"]


def test_naming_a_leaf_reaches_through_maps_and_complements() -> None:
    assert names(A.named("hole")) == ["hole"]
    assert names((~A.translate((1, 0)).rotate(20)).named("hole").scale(2)) == ["hole"]
    assert names(A.named("a").named("b")) == ["b.a"]
    assert A.translate((1, 0)).named("x") == A.named("x").translate((1, 0))


def test_given_names_are_kept_and_shared() -> None:
    assert names(A.named("a") | B.named("a")) == ["a", "a"]
    assert names(A.named("disk") | B) == ["disk", "disk.2"]
    assert names(A | B.named("disk.2") | C) == ["disk", "disk.2", "disk.3"]


def test_the_same_leaf_at_the_same_place_is_one() -> None:
    box = cm.Box((-5, -5), (9, 5), name="box")
    program = compile_shape(cm.Regions({"rock": box - A - B, "core": A, "rest": B}))
    assert [leaf.names[-1] for leaf in program.leaves] == ["box.top", "disk", "disk.2"]
    assert program.regions[1] == ("core", (("leaf", 1),))
    assert names(A | A.translate((0, 5))) == ["disk", "disk.2"]
    copy = pickle.loads(pickle.dumps((A - B) | (B - A)))
    assert names(copy) == names((A - B) | (B - A)) == ["disk", "disk.2"]


@given(trees, trees)
def test_appending_changes_no_name(a: cm.Shape, b: cm.Shape) -> None:
    before = names(a)
    for longer in (a | b, a & b, a - b, a ^ b, cm.Regions({"first": a, "second": b})):
        assert names(longer)[: len(before)] == before


def test_labels_for_messages() -> None:
    (leaf,) = compile_shape(cm.HalfSpace((0, 0), (1, 0), name="cut")).leaves
    assert leaf.label == "half space 'cut'"


def test_later_regions_cover_earlier_ones() -> None:
    ground = cm.Regions(
        {"rock": cm.Box((-2, -2), (2, 2)), "core": A, "slot": cm.Box((0, 0), (5, 1))}
    )
    points = [(-1.5, -1.5), (-0.5, 0), (0.5, 0.5), (4, 0.5), (9, 9)]
    assert compile_shape(ground).region(np.array(points)).tolist() == [0, 1, 2, 2, -1]
    assert ground.contains(points).tolist() == [True, True, True, True, False]
    assert ground.bounds()[1].tolist() == [5, 2]


def test_regions_and_embeds_are_values() -> None:
    crack = cm.EmbeddedPath([(0, 0), (0.5, 0)], name="crack")
    probes = cm.EmbeddedPoints([(0.1, 0.2)])
    regions = cm.Regions({"rock": A | B, "core": B})
    embed = cm.Embed(regions, [crack, probes, cm.EmbeddedPoints([(0.3, 0.2)])])
    for value in (regions, embed, cm.Embed(A, [crack]), crack):
        copy = pickle.loads(pickle.dumps(value))
        assert copy == value
        assert hash(copy) == hash(value)
        assert eval(repr(value), {name: getattr(cm, name) for name in cm.__all__}) == value
    for value in (regions, embed, cm.Embed(A, [crack])):
        assert type(value).from_dict(value.to_dict()) == value
        with pytest.raises(cm.ShapeError, match="from_dict"):
            type(value).from_dict({"nodes": []})
    program = compile_shape(embed)
    assert [name for name, _ in program.paths] == ["crack"]
    assert [name for name, _ in program.probes] == ["points", "points.2"]
    assert crack != cm.EmbeddedPath([(0, 0), (0.5, 0)])
    with pytest.raises(AttributeError):
        embed.items = ()
    with pytest.raises(AttributeError):
        crack.name = "x"

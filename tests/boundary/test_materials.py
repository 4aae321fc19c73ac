"""Several materials in space: volumes, interfaces that conform, and their names."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

PI = np.pi
BOX = cm.Box((0, 0, 0), (2, 2, 2), name="box")
BORED = cm.Cylinder((0, 0, 0), (0, 0, 2), 1, name="pipe") - cm.Cylinder(
    (0, 0, -1), (0, 0, 3), 0.5, name="bore"
)
LOWER = cm.HalfSpace((0, 0, 0), (0, 0, 1), name="cut")

#: Regions, exact volumes, names of the interfaces.
MATERIALS = {
    "a ball in a box": (
        {"box": BOX, "ball": cm.Ball((1, 1, 1), 0.5)},
        (8 - PI / 6, PI / 6),
        {("ball",)},
    ),
    "a ball through a face": (
        {"box": BOX, "ball": cm.Ball((1, 1, 2), 0.5)},
        (8 - PI / 12, PI / 6),
        {("ball",)},
    ),
    "a ball on a face, inside": (
        {"box": BOX, "ball": cm.Ball((1, 1, 1), 1)},
        (8 - 4 / 3 * PI, 4 / 3 * PI),
        {("ball",)},
    ),
    "boxes that share a face": (
        {"a": BOX, "b": cm.Box((2, 0, 0), (4, 2, 2), name="next")},
        (8, 8),
        {("box.right", "next.left")},
    ),
    "boxes that share part of a face": (
        {"a": BOX, "b": cm.Box((2, 1, 0.5), (4, 3, 3), name="next")},
        (8, 10),
        {("box.right", "next.left")},
    ),
    "boxes that share an edge": (
        {"a": BOX, "b": cm.Box((2, 2, 0), (4, 4, 2))},
        (8, 8),
        set(),
    ),
    "boxes that overlap": (
        {"a": BOX, "b": cm.Box((1, 1, 0), (3, 3, 2), name="next")},
        (6, 8),
        {("next.left",), ("next.front",)},
    ),
    "a core in a longer bore": (
        {"pipe": BORED, "core": cm.Cylinder((0, 0, 0.5), (0, 0, 1.5), 0.5, name="core")},
        (1.5 * PI, PI / 4),
        {("bore.side", "core.side")},
    ),
    "a core the other way round": (
        {"pipe": BORED, "core": cm.Cylinder((0, 0, 1.5), (0, 0, 0.5), 0.5, name="core").rotate(33)},
        (1.5 * PI, PI / 4),
        {("bore.side", "core.side")},
    ),
    "halves of a ball": (
        {"low": cm.Ball((0, 0, 0), 1) & LOWER, "high": cm.Ball((0, 0, 0), 1) - LOWER},
        (2 / 3 * PI, 2 / 3 * PI),
        {("cut",)},
    ),
    "three that meet in a curve": (
        {"a": BOX, "b": cm.Box((1, -1, -1), (3, 3, 3), name="b"), "c": cm.Ball((1, 1, 1), 0.5)},
        (4 - PI / 12, 32 - PI / 12, PI / 6),
        {("b.left",), ("ball",)},
    ),
}


def assert_each_region_is_closed(plc: cm.Plc) -> None:
    for k in range(len(plc.region_names)):
        behind, ahead = (plc.facet_region[:, side] == k for side in (0, 1))
        own = np.concatenate([plc.facets[behind], plc.facets[ahead][:, ::-1]])
        edges = own[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        forward = np.where(edges[:, 0] < edges[:, 1], 1, -1)
        _, key = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
        assert not np.bincount(key.ravel(), weights=forward).any()


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("move", ["as it is", "turned", "far"])
def test_regions_are_closed_conform_and_fill_their_volumes(name: str, move: str) -> None:
    entries, volumes, interfaces = MATERIALS[name]
    if move == "turned":
        entries = {k: s.rotate(33, axis=(1, 2, 3)) for k, s in entries.items()}
    elif move == "far":
        entries = {k: s.translate((1e5, -1e5, 1e5)) for k, s in entries.items()}
    plc = cm.evaluate(cm.Regions(entries))
    assert plc.region_names == tuple(entries)
    assert_each_region_is_closed(plc)
    assert len(np.unique(np.sort(plc.facets, axis=1), axis=0)) == plc.n_facets
    corners = plc.points[plc.facets].reshape(-1, 3)
    off = plc.surfaces.distance(np.repeat(plc.facet_surface, 3), corners)
    assert off.max() < 1e-12 * plc.diagonal + 1e-15 * np.abs(plc.points).max() * 4
    slack = 2 * plc.deviation * plc.facet_areas().sum() + 1e-9
    np.testing.assert_allclose(plc.volumes(), volumes, atol=slack)
    inner = (plc.facet_region >= 0).all(axis=1)
    assert {plc.boundary_names[m] for m in plc.facet_marker[inner]} == interfaces
    # Facets face away from their first region.
    assert (plc.facet_region[:, 0] >= 0).all()
    assert (plc.facet_region[inner, 0] < plc.facet_region[inner, 1]).all()


def test_the_oracle_knows_regions() -> None:
    shape = cm.Regions({"box": BOX, "ball": cm.Ball((1, 1, 2), 0.5)})
    points = [(0.1, 0.1, 0.1), (1, 1, 1.9), (1, 1, 2.4), (1, 1, 2.6)]
    assert cm.evaluate(shape).oracle.region(np.array(points)).tolist() == [0, 1, 1, -1]
    assert shape.contains(points).tolist() == [True, True, True, False]


def test_regions_from_a_domain_file(tmp_path) -> None:
    path = tmp_path / "part.yaml"
    path.write_text(
        "csgmesh: 1\n"
        "shapes:\n"
        "  matrix: {box: {lo: [0, 0, 0], hi: [2, 2, 2]}}\n"
        "  grain: {ball: {center: [1, 1, 1], radius: 0.5}}\n"
        "regions: {rock: matrix, ore: grain}\n"
    )
    plc = cm.evaluate(cm.load(path).shape)
    assert plc.region_names == ("rock", "ore")
    assert plc.volumes().sum() == pytest.approx(8.0)


def test_coinciding_faces_are_divided_where_names_change() -> None:
    first = cm.Box((0, 0, 0), (2, 2, 2), name="first")
    plc = cm.evaluate(first | cm.Cylinder((2, 2, 0), (2, 2, 2), 1, name="second"), deviation=1e-3)
    names = plc.boundary_names
    area = {entry: plc.facet_areas()[plc.facet_marker == k].sum() for k, entry in enumerate(names)}
    assert area["first.top",] == pytest.approx(4 - PI / 4, abs=4e-3)
    assert area["first.top", "second.top"] == pytest.approx(PI / 4, abs=4e-3)
    assert area["second.top",] == pytest.approx(3 / 4 * PI, abs=8e-3)


def test_one_cylinder_on_another_is_one_surface_with_three_stretches() -> None:
    lower = cm.Cylinder((0, 0, 0), (0, 0, 2), 1, name="lower")
    plc = cm.evaluate(lower | cm.Cylinder((0, 0, 4), (0, 0, 1), 1, name="upper"), deviation=1e-3)
    side = [m for m, entry in enumerate(plc.boundary_names) if entry[0].endswith("side")]
    area = {plc.boundary_names[m]: plc.facet_areas()[plc.facet_marker == m].sum() for m in side}
    assert area == {
        ("lower.side",): pytest.approx(2 * PI, abs=1e-2),
        ("lower.side", "upper.side"): pytest.approx(2 * PI, abs=1e-2),
        ("upper.side",): pytest.approx(4 * PI, abs=2e-2),
    }
    assert len(np.unique(plc.facet_surface[np.isin(plc.facet_marker, side)])) == 1

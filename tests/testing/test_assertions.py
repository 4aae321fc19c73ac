"""The assertions pass what is right and name what is wrong."""

from __future__ import annotations

import math

import pytest

import csgmesh as cm
from csgmesh.testing import assert_area, assert_matches, assert_names, assert_valid

PLATE = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
AREA = 8 - math.pi / 4


@pytest.fixture(scope="module")
def plate() -> cm.Mesh:
    """A coarse plate with a hole."""
    return cm.generate(PLATE, size=0.3)


@pytest.fixture(scope="module")
def ground() -> cm.Mesh:
    """A disk of one material in a box of another, far from the origin."""
    rock = cm.Box((0, 0), (4, 2), name="rock").translate((1e5, 1e5))
    core = cm.Disk((2, 1), 0.5, name="rim").translate((1e5, 1e5))
    return cm.generate(cm.Regions({"rock": rock, "core": core}), size=0.3)


def moved(mesh: cm.Mesh) -> cm.Mesh:
    """The mesh with its first inner point out of place."""
    points = mesh.points.copy()
    inner = set(range(mesh.n_points)) - set(mesh.facets["line"].ravel().tolist())
    points[min(inner)] += 3.0
    return cm.Mesh(points, mesh.cells, facets=mesh.facets, facet_marker=mesh.facet_marker,
                   boundary_names=mesh.boundary_names, facet_region=mesh.facet_region)  # fmt: skip


def test_valid(plate: cm.Mesh) -> None:
    assert_valid(plate)
    assert_valid(plate, PLATE)
    with pytest.raises(AssertionError, match="the mesh is not valid\n  orientation"):
        assert_valid(moved(plate))
    with pytest.raises(AssertionError):
        assert_valid(plate, PLATE - cm.Disk((1, 1), 0.1))


def test_area_is_that_of_the_exact_curves(plate: cm.Mesh) -> None:
    assert_area(plate, AREA)
    assert_area(plate, round(AREA, 4))
    with pytest.raises(
        AssertionError, match=r"area: 7.2146\d+ \(7.2\d+ over the chords\), expected 7"
    ):
        assert_area(plate, 7.0)


def test_area_within_a_tolerance_is_that_of_the_cells(plate: cm.Mesh) -> None:
    assert_area(plate, AREA, tolerance=0.05)
    with pytest.raises(AssertionError, match="within 1e-06"):
        assert_area(plate, AREA, tolerance=1e-6)


def test_area_of_regions(ground: cm.Mesh) -> None:
    assert_area(ground, 8)
    assert_area(ground, math.pi / 4, region="core")
    assert_area(ground, AREA, region="rock")
    assert_area(ground, "< 0.8", region="core")
    with pytest.raises(AssertionError, match=r"area of 'core': 0\.78"):
        assert_area(ground, AREA, region="core")
    with pytest.raises(cm.NameLookupError, match="did you mean 'core'"):
        assert_area(ground, 1, region="kore")


def test_area_of_a_mesh_without_curves_needs_a_tolerance(plate: cm.Mesh) -> None:
    bare = cm.Mesh(plate.points, plate.cells)
    with pytest.raises(AssertionError, match="has no exact curves, give a tolerance"):
        assert_area(bare, AREA)
    assert_area(bare, AREA, tolerance=0.05)
    assert_area(cm.generate(cm.Box((0, 0), (1, 3)), size=1), 3)


def test_names(plate: cm.Mesh) -> None:
    assert_names(plate, ["plate", "hole"])
    assert_names(plate, ["plate.*", "hole"])
    with pytest.raises(AssertionError, match=r"names: unexpected 'hole'"):
        assert_names(plate, ["plate"])
    with pytest.raises(AssertionError, match=r"'hale'; did you mean 'hole'"):
        assert_names(plate, ["plate", "hole", "hale"])


def test_matches(plate: cm.Mesh, ground: cm.Mesh) -> None:
    assert_matches(plate, {})
    assert_matches(
        plate,
        {
            "area": AREA,
            "min_angle": ">= 25",
            "max_angle": 130,
            "cells": [50, 2000],
            "points": "> 20",
            "boundary": {"hole": {"length": math.pi, "facets": ">= 8"}, "plate.*": {"length": 12}},
            "regions": {"domain": {"area": AREA}},
            "names": ["plate", "hole"],
        },
    )
    assert_matches(
        ground,
        {"boundary": {"rim": {"length": math.pi}}, "regions": {"core": {"cells": ">= 6"}}},
    )


def test_all_mismatches_are_listed(plate: cm.Mesh) -> None:
    expect = {
        "cells": 1,
        "min_angle": 59,
        "max_angle": "< 61",
        "boundary": {"hole": {"length": 3, "tolerance": 1e-3}, "gap": {"length": 1}},
        "regions": {"domain": {"cells": "< 3"}},
    }
    with pytest.raises(AssertionError) as caught:
        assert_matches(plate, expect)
    heads = [line.strip().split(":")[0] for line in str(caught.value).splitlines()]
    assert heads == [
        "the mesh does not match", "min_angle", "max_angle", "cells", "boundary.hole.length",
        "no boundary matches 'gap'; there are 'plate.left', 'plate.right', 'plate.bottom', "
        "'plate.top', 'hole'",
        "regions.domain.cells",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("expect", "message"),
    [
        ({"aera": 1}, "unknown key 'aera'; did you mean 'area'"),
        ({"boundary": {"hole": 3}}, "expect boundary.hole: expected a mapping"),
        ({"cells": "many"}, "expect cells: expected a number, a comparison"),
    ],
)
def test_expectations_that_are_none(plate: cm.Mesh, expect: dict, message: str) -> None:
    with pytest.raises(cm.InputError) as caught:
        assert_matches(plate, expect)
    assert message in str(caught.value)


def test_a_missing_arc_is_noticed(plate: cm.Mesh) -> None:
    facets = plate.boundary("hole")["line"][1:]
    kept = [
        i for i in range(plate.n_facets) if i in facets or i not in plate.boundary("hole")["line"]
    ]
    part = cm.Mesh(
        plate.points, plate.cells, curves=plate.curves, boundary_names=plate.boundary_names,
        **{
            name: {"line": getattr(plate, name)["line"][kept]}
            for name in ("facets", "facet_marker", "facet_region", "facet_curve", "facet_interval")
        },
    )  # fmt: skip
    with pytest.raises(AssertionError, match=r"boundary\.hole\.length"):
        assert_matches(part, {"boundary": {"hole": {"length": math.pi}}})


def test_solids_have_volumes_and_areas() -> None:
    pipe = cm.Extrude(cm.Disk((0, 0), 1, name="outer") - cm.Disk((0, 0), 0.5, name="bore"), 2)
    mesh = cm.generate(pipe, cm.Sweep(), size=0.25)
    side = "extrude.side.bore"
    exact = {"volume": 1.5 * math.pi, "boundary": {side: {"area": 2 * math.pi}}, "min_dihedral": 30}
    assert_matches(mesh, exact)
    assert_matches(mesh, {"regions": {mesh.region_names[0]: {"volume": 1.5 * math.pi}}})
    for wrong, said in (
        ({"volume": 1.45 * math.pi}, "volume: 4.6"),
        ({"boundary": {side: {"area": 1.98 * math.pi}}}, f"boundary.{side}.area: 6.2"),
        ({"min_dihedral": ">= 75"}, "min_dihedral: "),
        ({"min_angle": 20}, "min_angle: a mesh of space has none"),
        ({"area": 3.0}, "plane mesh"),
    ):
        with pytest.raises((AssertionError, cm.InputError), match=said):
            assert_matches(mesh, wrong)

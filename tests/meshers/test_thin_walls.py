"""Thin walls and gaps make cells finer where they are, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

BOX = cm.Box((0, 0, 0), (2, 2, 2), name="box")

#: Solids with a wall or gap, and its thickness.
WALLS = {
    "plate": (cm.Box((0, 0, 0), (1, 1, 0.01)), 0.01),
    "shell": (cm.Ball((0, 0, 0), 1) - cm.Ball((0, 0, 0), 0.97), 0.03),
    "pocket": (BOX - cm.Box((0.5, 0.5, 0.02), (1.5, 1.5, 3)), 0.02),
    "ball near six faces": (BOX - cm.Ball((1, 1, 1), 0.99), 0.01),
    "coating": (
        cm.Regions({"core": BOX, "coat": cm.Box((0, 0, 2), (2, 2, 2.03))}),
        0.03,
    ),
}


def smallest_angle(mesh: cm.Mesh) -> float:
    return float(cm.quality(mesh).min_dihedral.min())


@pytest.mark.parametrize("name", WALLS)
def test_thin_walls_have_no_flat_cells(name: str) -> None:
    solid, thickness = WALLS[name]
    mesh = cm.generate(solid)
    assert cm.check(mesh, solid).ok
    assert smallest_angle(mesh) >= 12
    found = mesh.info["walls"]
    # Facets of a curved surface are off it by the deviation.
    assert abs(found["thinnest"] - thickness) <= 2 * cm.evaluate(solid).deviation + 1e-12
    assert found["flat_area"] == 0
    if name in ("plate", "pocket"):
        assert smallest_angle(cm.generate(solid, cm.Octree(walls=0))) < 12


def test_solids_without_thin_walls_keep_their_meshes() -> None:
    solid = BOX - cm.Cone((1, 1, -1), (1, 1, 1.5), 0.6) | cm.Torus((3, 1, 1), (0, 0, 1), 1.2, 0.3)
    meshes = [cm.generate(solid, cm.Octree(walls=walls), size=0.3) for walls in (0, 1)]
    assert meshes[0].points.tobytes() == meshes[1].points.tobytes()
    assert "walls" not in meshes[1].info


@pytest.mark.parametrize(
    "solid",
    [
        BOX - cm.Ball((1, 1, 0.5 + 1e-8), 0.5),
        BOX - cm.Ball((1, 1, 0.5), 0.5),
    ],
    ids=["gap", "touching"],
)
def test_what_no_size_can_fill_stays_as_it_is(solid: cm.Shape) -> None:
    mesh, plain = cm.generate(solid), cm.generate(solid, cm.Octree(walls=0))
    assert cm.check(mesh, solid).ok
    assert mesh.n_cells == plain.n_cells
    assert mesh.info["walls"]["smallest_size"] is None
    assert mesh.info["walls"]["flat_area"] > 0


def test_walls_do_not_take_all_points() -> None:
    plate = cm.Box((0, 0, 0), (1, 1, 0.01))
    mesh = cm.generate(plate, cm.Octree(max_points=100_000))
    assert mesh.n_points <= 3000
    assert 0.03 < mesh.info["walls"]["smallest_size"] < 0.08
    assert mesh.info["walls"]["flat_area"] > 1.9


def test_surfaces_on_both_sides_of_a_wall_are_fine() -> None:
    solid = BOX - cm.Box((0.5, 0.5, 0.02), (1.5, 1.5, 3), name="pocket")

    def longest(mesh: cm.Mesh, name: str) -> float:
        corners = mesh.points[mesh.facets["triangle"][mesh.boundary(name)["triangle"]]]
        return float(np.sqrt(((corners - corners[:, [1, 2, 0]]) ** 2).sum(axis=2)).max())

    mesh = cm.generate(solid, cm.SurfaceRefinement())
    assert cm.check(mesh, solid).ok
    assert longest(mesh, "pocket.bottom") < 0.11 < longest(mesh, "box.left")
    two = cm.generate(solid, cm.SurfaceRefinement(walls=2))
    assert longest(two, "pocket.bottom") < 0.055
    without = cm.generate(solid, cm.SurfaceRefinement(walls=0))
    assert longest(without, "pocket.bottom") > 0.2


@pytest.mark.parametrize("walls", [-1, 1.5, True, "one"])
def test_cells_across_are_whole_numbers(walls: object) -> None:
    for mesher in (cm.Octree, cm.SurfaceRefinement):
        with pytest.raises(cm.InputError, match="walls must be a whole number, at least 0; got"):
            mesher(walls=walls)

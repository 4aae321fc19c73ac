"""The worst cells of space, and what they are there for."""

import pytest

import csgmesh as cm
from csgmesh.meshers.worst import describe


def test_cells_that_fill_a_sharp_edge_are_told() -> None:
    wedge = cm.Mesh(
        [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 0, 1], [4, 0, 1], [4, 1, 1]],
        {"wedge": [[0, 1, 2, 3, 4, 5]]},
    )
    boundary = {"triangle": [[0, 2, 1], [3, 4, 5]], "quad": [[0, 1, 4, 3], [0, 3, 5, 2]]}
    mesh = cm.Mesh(wedge.points, wedge.cells, facets=boundary)
    (worst,) = cm.worst_cells(mesh)
    assert worst["reason"] == "sharp edge"
    assert worst["angle"] == pytest.approx(14.036243)
    assert describe(worst) == "14° at (2.66667, 0.333333, 0.5) (sharp edge)"
    # Without the facet above there is no edge to fill, only a cell from side to side.
    del boundary["quad"][1]
    assert cm.worst_cells(cm.Mesh(wedge.points, wedge.cells, facets=boundary))[0]["reason"] == (
        "thin wall"
    )


def test_the_worst_come_first_and_are_those_of_quality() -> None:
    mesh = cm.generate(cm.Ball((0, 0, 0), 1), cm.Octree(), 0.5)
    worst = cm.worst_cells(mesh, 10**7)
    angles = [cell["angle"] for cell in worst]
    assert len(worst) == mesh.n_cells
    assert angles == sorted(cm.quality(mesh).min_dihedral)
    assert [cell["place"] for cell in cm.worst_cells(mesh, 2)] == [c["place"] for c in worst[:2]]


def test_surfaces_have_no_cells_to_list() -> None:
    surface = cm.generate(cm.Box((0, 0, 0), (1, 1, 1)), cm.SurfaceRefinement(), 0.5)
    with pytest.raises(cm.InputError, match="cells that fill space"):
        cm.worst_cells(surface)

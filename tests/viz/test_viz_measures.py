"""Cells of space coloured by a measure: the picture shows the numbers of `quality`."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection

import csgmesh as cm
from csgmesh.viz.figure import SCALES

CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
#: A sheared cube, and a tetrahedron apart from it.
MESH = cm.Mesh(
    np.array([*CUBE, [3, 0, 0], [4, 0, 0], [3, 1, 0], [3, 0, 1]], float)
    + np.array([[0.0, 0, 0]] * 4 + [[0.5, 0, 0]] * 4 + [[0, 0, 0]] * 4),
    {"hexahedron": [[0, 1, 2, 3, 4, 5, 6, 7]], "tetra": [[8, 9, 10, 11]]},
)


def painted(color: str) -> np.ndarray:
    """The colours of all polygons, without their light."""
    (shown,) = [
        c
        for c in cm.draw(MESH, color=color, view=(-60, 25)).axes[0].collections
        if isinstance(c, PolyCollection)
    ]
    rgb = shown.get_facecolor()[:, :3]
    return np.unique((rgb / rgb.max(axis=1, keepdims=True)).round(6), axis=0)


@pytest.mark.parametrize("color", ["min_dihedral", "scaled_jacobian"])
def test_cells_have_the_colour_of_their_measure(color: str) -> None:
    values = getattr(cm.quality(MESH), color)
    rgb = np.where(np.isnan(values)[:, None], 1.0, SCALES[color].to_rgba(values)[:, :3])
    expected = np.unique((rgb / rgb.max(axis=1, keepdims=True)).round(6), axis=0)
    np.testing.assert_allclose(painted(color), expected, atol=1e-5)
    label = cm.draw(MESH, color=color).axes[1].get_ylabel()
    assert label.startswith(color.replace("min_dihedral", "smallest dihedral").split("_")[0])


def test_a_surface_has_no_such_measure() -> None:
    surface = cm.generate(cm.Box((0, 0, 0), (1, 1, 1)), cm.SurfaceRefinement(), 0.5)
    with pytest.raises(cm.InputError, match="color='min_dihedral' needs cells that fill space"):
        cm.draw(surface, color="min_dihedral")
    with pytest.raises(cm.InputError, match="color='scaled_jacobian' belongs to space"):
        cm.draw(cm.generate(cm.Box((0, 0), (1, 1)), size=1), color="scaled_jacobian")

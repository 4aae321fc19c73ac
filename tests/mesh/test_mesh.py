"""Mesh: what enters is cast, checked and frozen; names find entities."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from csgmesh.errors import InputError, NameLookupError
from csgmesh.mesh import Mesh

POINTS = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]]
QUAD_AND_TRIANGLES = {"triangle": [[0, 1, 2], [0, 2, 3]], "quad": [[1, 4, 5, 2]]}


def two_materials() -> Mesh:
    return Mesh(
        POINTS,
        QUAD_AND_TRIANGLES,
        {"triangle": [0, 0], "quad": [1]},
        ("rock", "core"),
        {"line": [[3, 0], [0, 1], [1, 4], [4, 5], [5, 2], [2, 3], [1, 2]]},
        {"line": [0, 1, 1, 2, 3, 3, 4]},
        [("a.left",), ("a.bottom",), ("b.right",), ("a.top", "b.top"), ("seam",), ("probe",)],
        {"line": [[0, -1], [0, -1], [1, -1], [1, -1], [1, -1], [0, -1], [0, 1]]},
        point_marker=[-1, -1, -1, 5, -1, -1],
    )


def test_arrays_are_cast_and_frozen():
    given = np.array(POINTS, dtype=np.float32)
    mesh = Mesh(given, {"triangle": np.array([[0, 1, 2]], dtype=np.int32)})
    assert mesh.points.dtype == np.float64 and mesh.cells["triangle"].dtype == np.int64
    with pytest.raises(ValueError):
        mesh.points[0, 0] = 5
    with pytest.raises(ValueError):
        mesh.cells["triangle"][0, 0] = 5
    with pytest.raises(TypeError):
        mesh.cells["quad"] = np.zeros((0, 4))
    assert given.flags.writeable


def test_later_changes_of_the_given_array_do_not_reach_the_mesh():
    points = np.array(POINTS, float)
    mesh = Mesh(points, QUAD_AND_TRIANGLES)
    points[0, 0] = 99
    assert mesh.points[0, 0] == 0


def test_frozen_arrays_are_shared_not_copied():
    mesh = two_materials()
    assert Mesh(mesh.points, mesh.cells).points is mesh.points


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"points": [0.0, 1.0]}, r"points must have shape \(n, 2\) or \(n, 3\); got \(2,\)"),
        ({"points": [["a", "b"]]}, "points must hold numbers"),
        ({"cells": {"tri": [[0, 1, 2]]}}, "kinds triangle, quad.*got 'tri'"),
        ({"cells": {"tetra": [[0, 1, 2, 3]]}}, "got 'tetra'"),
        ({"cells": {"triangle": [[0, 1]]}}, r"shape \(n, 3\); got \(1, 2\)"),
        ({"cells": {"triangle": [[0.0, 1.0, 2.0]]}}, "must hold integers; got float64"),
        ({"cells": [[0, 1, 2]]}, "cells must map kinds to arrays; got list"),
        ({"cell_region": {"triangle": [0, 0, 0]}}, r"shape \(2,\); got \(3,\)"),
        ({"cell_region": {"wedge": [0]}}, "got 'wedge'"),
        ({"facets": {"triangle": [[0, 1, 2]]}}, "facets must be of kinds line"),
        ({"facet_marker": {"line": [0]}}, "got 'line'"),
        ({"boundary_names": ["left"]}, r"such as \('left',\)"),
        ({"point_marker": [0]}, r"shape \(6,\)"),
    ],
)
def test_wrong_arguments_are_told(change, words):
    with pytest.raises(InputError, match=words):
        Mesh(**{"points": POINTS, "cells": QUAD_AND_TRIANGLES, **change})


def test_lookups():
    mesh = two_materials()
    assert mesh.names == ("a.left", "a.bottom", "b.right", "a.top", "b.top", "seam", "probe")
    assert mesh.boundary("a.top")["line"].tolist() == [4, 5]
    assert mesh.boundary("a")["line"].tolist() == [0, 1, 2, 4, 5]
    assert mesh.boundary("*.top")["line"].tolist() == [4, 5]
    assert mesh.boundary_points("seam").tolist() == [1, 2]
    assert mesh.boundary_points("probe").tolist() == [3]
    assert mesh.boundary("probe")["line"].tolist() == []
    assert {k: v.tolist() for k, v in mesh.region("core").items()} == {"triangle": [], "quad": [0]}
    assert mesh.interface("core", "rock")["line"].tolist() == [6]
    assert mesh.interface("*", "*")["line"].tolist() == [6]
    with pytest.raises(NameLookupError, match=r"'a.botom'; did you mean 'a.bottom'"):
        mesh.boundary("a.botom")
    with pytest.raises(NameLookupError, match="no region matches 'rok'; did you mean 'rock'"):
        mesh.region("rok")


def test_pickling_and_equality():
    mesh = two_materials()
    again = pickle.loads(pickle.dumps(mesh))
    assert again.equals(mesh) and not again.points.flags.writeable
    moved = mesh.points.copy()
    moved[0, 0] = np.nextafter(0.0, 1.0)
    assert not mesh.equals(Mesh(moved, mesh.cells))
    assert not mesh.equals(Mesh(mesh.points, mesh.cells))


def test_repr_is_one_line():
    assert repr(two_materials()) == (
        "<Mesh 2D: 6 points, 2 triangles, 1 quad, 7 facets, regions: rock, core, "
        "boundaries: a.left, a.bottom, b.right, a.top, b.top, seam, probe>"
    )


@pytest.mark.parametrize("missing", [3, -1])
def test_cells_and_facets_name_points_that_are_there(missing: int) -> None:
    corners = [[0, 0], [1, 0], [0, 1]]
    with pytest.raises(InputError, match=rf"points 0 to 2; row 1 is \(0, 1, {missing}\)"):
        Mesh(corners, {"triangle": [[0, 1, 2], [0, 1, missing]]})
    with pytest.raises(InputError, match=rf"facets\['line'\].*row 0 is \(0, {missing}\)"):
        Mesh(corners, {"triangle": [[0, 1, 2]]}, facets={"line": [[0, missing]]})

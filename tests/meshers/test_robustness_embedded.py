"""Embedded paths and points wherever they lie: named, conforming, of the right length."""

from __future__ import annotations

import numpy as np
import pytest

import csgmesh as cm

PLATE = cm.Box((0, 0), (4, 2))
HALVES = cm.Regions({"west": cm.Box((0, 0), (2, 2)), "east": cm.Box((2, 0), (4, 2))})
PLATE_WITH_HOLE = PLATE - cm.Disk((2, 1), 0.5)

#: What it is embedded in, the paths, and their lengths inside the domain.
PATHS = {
    "inside": (PLATE, {"a": [(1, 1), (2, 1)]}, {"a": 1}),
    "from the boundary": (PLATE, {"a": [(0, 1), (2, 1)]}, {"a": 2}),
    "from a corner": (PLATE, {"a": [(0, 0), (1, 1)]}, {"a": 2**0.5}),
    "right through": (PLATE, {"a": [(0, 1), (4, 1)]}, {"a": 4}),
    "from beyond": (PLATE, {"a": [(-1, 1), (2, 1)]}, {"a": 2}),
    "touching the boundary": (PLATE, {"a": [(1, 1), (2, 0), (3, 1)]}, {"a": 8**0.5}),
    "along the boundary": (PLATE, {"a": [(1, 0), (3, 0)]}, {"a": 2}),
    "beside the boundary": (PLATE, {"a": [(1, 1e-4), (1.01, 1e-4)]}, {"a": 0.01}),
    "crossing": (PLATE, {"a": [(1, 1), (3, 1)], "b": [(2, 0.5), (2, 1.5)]}, {"a": 2, "b": 1}),
    "crossing itself": (
        PLATE,
        {"a": [(1, 0.5), (3, 1.5), (3, 0.5), (1, 1.5)]},
        {"a": 1 + 2 * 5**0.5},
    ),
    "overlapping": (PLATE, {"a": [(1, 1), (3, 1)], "b": [(2, 1), (3.5, 1)]}, {"a": 2, "b": 1.5}),
    "twice": (PLATE, {"a": [(1, 1), (3, 1)], "b": [(3, 1), (1, 1)]}, {"a": 2, "b": 2}),
    "closed": (PLATE, {"a": [(1, 0.5), (2, 0.5), (2, 1.5), (1, 1.5), (1, 0.5)]}, {"a": 4}),
    "small angle": (PLATE, {"a": [(1, 1), (3, 1)], "b": [(1, 1), (3, 1.01)]}, {"a": 2}),
    "across regions": (HALVES, {"a": [(1, 1), (3, 1)]}, {"a": 2}),
    "on an interface": (HALVES, {"a": [(2, 0.5), (2, 1.5)]}, {"a": 1}),
    "over a hole": (PLATE_WITH_HOLE, {"a": [(0.5, 1), (3.5, 1)]}, {"a": 2}),
    "tangent to a hole": (PLATE_WITH_HOLE, {"a": [(0.5, 0.5), (3.5, 0.5)]}, {"a": 3}),
}


@pytest.mark.parametrize("size", [None, 0.3])
@pytest.mark.parametrize("name", PATHS)
def test_paths_are_edges_of_the_right_length(name: str, size: float | None) -> None:
    around, paths, lengths = PATHS[name]
    shape = cm.Embed(around, [cm.EmbeddedPath(points, name=key) for key, points in paths.items()])
    mesh = cm.generate(shape, cm.DelaunayRefinement(max_points=50_000), size=size)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, str(certificate)
    for key, length in lengths.items():
        ends = mesh.points[mesh.facets["line"][mesh.boundary(key)["line"]]]
        assert np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum() == pytest.approx(length, rel=1e-9)
    assert set(paths) <= set(mesh.names)


@pytest.mark.parametrize(
    ("around", "points"),
    [
        (PLATE, [(1, 1), (2, 1.5)]),
        (PLATE, [(0, 0)]),
        (PLATE, [(4, 2), (4, 0), (1, 0)]),
        (cm.Polygon([(0, 0), (1, 0), (1, 1)]), [(1, 0), (1, 1), (1, 0.5)]),
        (cm.Disk((0, 0), 1), [(1, 0), (0, 0)]),
        (HALVES, [(2, 0), (2, 1), (2, 2)]),
        (PLATE, [(1, 1), (1, 1 + 1e-6)]),
    ],
)
def test_points_are_vertices_wherever_they_lie(
    around: cm.Shape, points: list[tuple[float, float]]
) -> None:
    shape = cm.Embed(around, [cm.EmbeddedPoints(points, name="probe")])
    mesh = cm.generate(shape)
    certificate = cm.check(mesh, shape)
    assert certificate.ok, str(certificate)
    found = {tuple(p) for p in mesh.points[mesh.boundary_points("probe")].tolist()}
    assert found == {(float(x), float(y)) for x, y in points}


def test_what_lies_outside_is_refused_with_its_name_and_place() -> None:
    with pytest.raises(cm.ShapeError, match=r"point \(9, 9\) of 'probe' lies outside"):
        cm.evaluate(cm.Embed(PLATE, [cm.EmbeddedPoints([(1, 1), (9, 9)], name="probe")]))
    with pytest.raises(cm.ShapeError, match=r"path 'crack' from \(9, 9\) lies outside"):
        cm.evaluate(cm.Embed(PLATE, [cm.EmbeddedPath([(9, 9), (10, 9)], name="crack")]))

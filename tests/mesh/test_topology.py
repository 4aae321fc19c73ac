"""Edges, components and holes, from connectivity alone."""

from __future__ import annotations

import numpy as np
import pytest

from csgmesh.mesh import KINDS
from csgmesh.mesh.topology import closure_counts, components, edges_of


def grid(n: int, without: tuple[tuple[int, int], ...] = ()) -> dict[str, np.ndarray]:
    """An n by n grid of quads without some of them."""
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    quads = [
        [number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]]
        for i in range(n)
        for j in range(n)
        if (i, j) not in without
    ]
    return {"quad": np.array(quads)}


def test_edges_of_two_triangles_and_a_quad():
    cells = {"triangle": np.array([[0, 1, 2], [0, 2, 3]]), "quad": np.array([[1, 4, 5, 2]])}
    edges = edges_of(cells, 6)
    assert edges.points.tolist() == [
        *([0, 1], [0, 2], [0, 3], [1, 2]),
        *([1, 4], [2, 3], [2, 5], [4, 5]),
    ]
    assert edges.count.tolist() == [1, 2, 1, 2, 1, 1, 1, 1]
    inner = edges.find(np.array([[2, 1], [2, 0], [3, 1]]))
    assert inner.tolist() == [3, 1, -1]
    assert edges.left[[1, 3]].tolist() == [1, 0] and edges.right[[1, 3]].tolist() == [0, 2]


@pytest.mark.parametrize(
    ("without", "parts", "pieces", "holes"),
    [
        ((), 1, 1, 0),
        (((2, 2),), 1, 1, 1),
        (((1, 1), (2, 2)), 1, 1, 2),  # two holes that touch at a vertex
        (((0, 0),), 1, 1, 0),
        (((0, 2), (1, 2), (2, 2), (3, 2), (4, 2)), 2, 2, 0),
        (((0, 1), (1, 0)), 2, 1, 0),  # a corner cell that hangs on by a vertex
        (((1, 2), (2, 1), (2, 3), (3, 2)), 2, 1, 4),  # so does the middle of four holes
    ],
)
def test_components_and_holes(without, parts, pieces, holes):
    edges = edges_of(grid(5, without), 36)
    count, component = components(edges)
    closed, euler = closure_counts(edges, component, np.zeros(edges.n_cells, np.int64), 1)
    assert (count, closed[0], closed[0] - euler[0]) == (parts, pieces, holes)


@pytest.mark.parametrize("n_groups", [3, 50])
def test_counts_by_group(n_groups):
    edges = edges_of(grid(5), 36)
    group = np.zeros(25, np.int64)
    group[[6, 12]] = 1  # two that share a vertex
    same = np.r_[group, -1][edges.left] == np.r_[group, -1][edges.right]
    count, component = components(edges, same)
    closed, euler = closure_counts(edges, component, group, n_groups)
    assert count == 3
    assert closed[:3].tolist() == [1, 1, 0] and euler[:3].tolist() == [-1, 1, 0]


def test_no_cells():
    edges = edges_of({}, 4)
    assert len(edges.points) == 0 and len(edges.boundary()) == 0
    assert edges.find(np.array([[0, 1]])).tolist() == [-1]


def test_facets_of_solid_kinds_enclose_the_cell():
    for kind in KINDS.values():
        if kind.dim != 3:
            continue
        directed = [
            (a, b)
            for facet, name in zip(kind.facets, kind.facet_kinds, strict=True)
            for a, b in _loop(facet[: KINDS[name].n_corners])
        ]
        # Each edge is run through once in each direction: the facets close and turn alike.
        assert len(set(directed)) == len(directed)
        assert {(b, a) for a, b in directed} == set(directed)
        assert {tuple(sorted(e)) for e in kind.edges} == {tuple(sorted(e)) for e in directed}


def _loop(corners):
    return [(corners[i], corners[(i + 1) % len(corners)]) for i in range(len(corners))]

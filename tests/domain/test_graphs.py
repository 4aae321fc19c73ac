"""Small graphs are done in plain Python and large ones by scipy, with the same results."""

from __future__ import annotations

import numpy as np
import pytest

from csgmesh import graphs, spatial


@pytest.fixture(params=range(20))
def graph(request: pytest.FixtureRequest) -> tuple[int, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(request.param)
    n = int(rng.integers(1, 60))
    m = int(rng.integers(0, 2 * n))
    return n, *rng.integers(0, n, (2, m))


def test_components_do_not_depend_on_the_route(graph, monkeypatch) -> None:
    count, label = graphs.components(*graph)
    monkeypatch.setattr(graphs, "SMALL", -1)
    other_count, other = graphs.components(*graph)
    assert count == other_count and np.array_equal(label, other)
    assert (label[graph[1]] == label[graph[2]]).all() and label.max() == count - 1


def test_a_spanning_tree_reaches_all_and_subtrees_are_intervals(graph, monkeypatch) -> None:
    n, a, b = graph
    for small in (graphs.SMALL, -1):
        monkeypatch.setattr(graphs, "SMALL", small)
        parent, order = graphs.spanning_tree(n, a, b)
        _, label = graphs.components(n, a, b)
        assert sorted(order.tolist()) == np.flatnonzero(label == label[0]).tolist()
        edges = set(zip(a.tolist(), b.tolist(), strict=True))
        size = np.ones(n, int)
        for v in order[:0:-1].tolist():
            assert (v, parent[v]) in edges or (parent[v], v) in edges
            size[parent[v]] += size[v]
        position = {v: k for k, v in enumerate(order.tolist())}
        for v in order[1:].tolist():
            first = position[parent[v]]
            assert first < position[v] < first + size[parent[v]]


@pytest.mark.parametrize("dim", [2, 3, 4])
@pytest.mark.parametrize("distance", [0.0, 0.01, 0.3])
def test_near_pairs_do_not_depend_on_the_route(dim: int, distance: float, monkeypatch) -> None:
    points = np.random.default_rng(5).random((300, dim)).round(4 // dim) + 1e6
    few = spatial.near_pairs(points, distance)
    monkeypatch.setattr(spatial, "FEW", -1)
    assert np.array_equal(few, spatial.near_pairs(points, distance))
    assert len(few)

"""No size grows faster than the gradation, and none is lowered that need not be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import Delaunay

from csgmesh.errors import SizeError
from csgmesh.size import limit_gradation
from csgmesh.size.gradation import steepest


@given(seed=st.integers(0, 10**6), n=st.integers(4, 60), growth=st.sampled_from([0.1, 0.3, 2.0]))
def test_the_result_is_the_largest_with_the_bound(seed, n, growth):
    rng = np.random.default_rng(seed)
    points = rng.random((n, 2))
    cells = Delaunay(points).simplices
    edges = np.concatenate([cells[:, :2], cells[:, 1:], cells[:, ::2]])
    wanted = 10 ** rng.uniform(-4, 1, n)
    found = limit_gradation(points, edges, wanted, growth)
    assert steepest(points, edges, found) <= growth * (1 + 1e-12)
    unique = np.unique(np.sort(edges, axis=1), axis=0)
    length = growth * np.hypot(*(points[unique[:, 0]] - points[unique[:, 1]]).T)
    graph = coo_matrix((length, tuple(unique.T)), shape=(n, n)).tocsr()
    away = dijkstra(graph, directed=False)
    np.testing.assert_allclose(found, (wanted + away).min(axis=1), rtol=1e-12)


def test_what_is_infinite_is_filled_in():
    points = np.array([[0.0, 0.0], [3.0, 4.0], [9.0, 9.0]])
    found = limit_gradation(points, np.array([[1, 0]]), np.array([1.0, np.inf, np.inf]), 0.2)
    assert found.tolist() == [1.0, 2.0, np.inf]


def test_bad_values_are_refused():
    line = np.array([[0.0, 0.0], [1.0, 0.0]])
    with pytest.raises(SizeError, match="gradation must be positive"):
        limit_gradation(line, np.array([[0, 1]]), np.ones(2), 0)
    with pytest.raises(SizeError, match="sizes must be positive; got -1"):
        limit_gradation(line, np.array([[0, 1]]), -np.ones(2), 1)

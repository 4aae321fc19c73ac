"""Components and spanning trees of graphs: the only door to scipy's graph algorithms.

Small graphs, of which a small domain has a dozen, are done in plain Python: importing scipy alone
takes a quarter of a second.
"""

from __future__ import annotations

import numpy as np

#: Graphs of no more edges than this, and of no more vertices than four times as many, are small.
SMALL = 4096


def components(n: int, a: np.ndarray, b: np.ndarray) -> tuple[int, np.ndarray]:
    """Number of components of a graph of `n` vertices and edges (a, b), and each vertex's.

    Components are numbered in the order of their lowest vertices.

    Examples
    --------
    >>> components(4, np.array([3]), np.array([1]))
    (3, array([0, 1, 2, 1]))
    """
    if _is_small(n, a):
        return _few_components(n, a.tolist(), b.tolist())
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(a), np.int8), (a, b)), shape=(n, n))
    count, label = connected_components(graph, directed=False)
    lowest = np.full(count, n)
    np.minimum.at(lowest, label, np.arange(n))
    rank = np.empty(count, np.int64)
    rank[np.argsort(lowest)] = np.arange(count)
    return int(count), rank[label]


def spanning_tree(n: int, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A tree of shortest paths from vertex 0 to all it is connected with, and a preorder of it.

    Returns
    -------
    parent : (n,) int64
        -1 or less of vertex 0 and of what it is not connected with.
    order : (k,) int64
        The vertices of the tree, each before its subtree, which follows without a gap.

    Examples
    --------
    >>> parent, order = spanning_tree(4, np.array([0, 2, 0]), np.array([2, 3, 1]))
    >>> parent[1:], order
    (array([0, 0, 2]), array([0, 1, 2, 3]))
    """
    if _is_small(n, a):
        return _small_tree(n, a.tolist(), b.tolist())
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order, depth_first_order

    graph = coo_array((np.ones(len(a), np.int8), (a, b)), shape=(n, n))
    _, parent = breadth_first_order(graph.tocsr(), 0, directed=False)
    parent = parent.astype(np.int64)
    children = np.flatnonzero(parent >= 0)
    tree = coo_array((np.ones(len(children), np.int8), (parent[children], children)), shape=(n, n))
    order, _ = depth_first_order(tree.tocsr(), 0, directed=True)
    return parent, order.astype(np.int64)


def _is_small(n: int, a: np.ndarray) -> bool:
    return len(a) <= SMALL and n <= 4 * SMALL


def _few_components(n: int, a: list[int], b: list[int]) -> tuple[int, np.ndarray]:
    """Union by lowest vertex, paths halved on the way."""
    root = list(range(n))
    for i, j in zip(a, b, strict=True):
        while root[i] != i:
            root[i] = i = root[root[i]]
        while root[j] != j:
            root[j] = j = root[root[j]]
        if i < j:
            root[j] = i
        else:
            root[i] = j
    label, count = [0] * n, 0
    for i, above in enumerate(root):
        if above == i:
            label[i] = count
            count += 1
        else:
            label[i] = label[above]
    return count, np.array(label, np.int64)


def _small_tree(n: int, a: list[int], b: list[int]) -> tuple[np.ndarray, np.ndarray]:
    neighbours: list[list[int]] = [[] for _ in range(n)]
    for i, j in zip(a, b, strict=True):
        neighbours[i].append(j)
        neighbours[j].append(i)
    parent = [-1] * n
    children: list[list[int]] = [[] for _ in range(n)]
    reached, queue = [False] * n, [0]
    reached[0] = True
    for i in queue:
        for j in sorted(neighbours[i]):
            if not reached[j]:
                reached[j], parent[j] = True, i
                children[i].append(j)
                queue.append(j)
    order, stack = [], [0]
    while stack:
        i = stack.pop()
        order.append(i)
        stack.extend(reversed(children[i]))
    return np.array(parent, np.int64), np.array(order, np.int64)

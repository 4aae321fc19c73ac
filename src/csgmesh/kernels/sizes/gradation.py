"""Limit the growth of values along the edges of any graph, exactly."""

from __future__ import annotations

from collections import namedtuple
from math import sqrt

from numba import njit

from ..pointers import ENTRY, HELPER, pointer

#: Vertices by value, the lowest on top; place: where each vertex is, -1 before it was and -2 after.
Heap = namedtuple("Heap", "vertex place value")


@njit(**HELPER)
def sink(heap, n, i, v):
    """Let vertex v sink from place i of a heap of n."""
    while True:
        child = 2 * i + 1
        if child >= n:
            break
        if child + 1 < n and heap.value[heap.vertex[child + 1]] < heap.value[heap.vertex[child]]:
            child += 1
        if heap.value[heap.vertex[child]] >= heap.value[v]:
            break
        heap.vertex[i] = heap.vertex[child]
        heap.place[heap.vertex[i]] = i
        i = child
    heap.vertex[i] = v
    heap.place[v] = i


@njit(**HELPER)
def rise(heap, i, v):
    """Let vertex v rise from place i."""
    while i > 0:
        parent = (i - 1) // 2
        if heap.value[heap.vertex[parent]] <= heap.value[v]:
            break
        heap.vertex[i] = heap.vertex[parent]
        heap.place[heap.vertex[i]] = i
        i = parent
    heap.vertex[i] = v
    heap.place[v] = i


@njit(**ENTRY)
def limit_growth(points, firsts, neighbours, values, growth, vertices, places, state, most):
    """Lower values until none exceeds a neighbour's by more than growth times their distance.

    The lowest value is final, as in Dijkstra's algorithm; it may lower its neighbours', and so on.
    points: (n, 2) flat; the neighbours of v are neighbours[firsts[v]] to neighbours[firsts[v + 1]].
    vertices, places: scratch of n entries, the heap in vertices being made here when state is
    (n, 0). After `most` vertices it returns, to be called again until state[0], what is left, is 0.
    """
    xy = pointer(points)
    first = pointer(firsts)
    next_to = pointer(neighbours)
    heap = Heap(pointer(vertices), pointer(places), pointer(values))
    n = state[0]
    if state[1] == 0:
        for i in range(n):
            heap.vertex[i] = i
            heap.place[i] = i
        for i in range(n // 2 - 1, -1, -1):
            sink(heap, n, i, heap.vertex[i])
        state[1] = 1
    for _ in range(min(n, most)):
        v = heap.vertex[0]
        heap.place[v] = -1
        n -= 1
        if n > 0:
            sink(heap, n, 0, heap.vertex[n])
        for j in range(first[v], first[v + 1]):
            u = next_to[j]
            if heap.place[u] >= 0:
                dx = xy[2 * u] - xy[2 * v]
                dy = xy[2 * u + 1] - xy[2 * v + 1]
                limit = heap.value[v] + growth * sqrt(dx * dx + dy * dy)
                if limit < heap.value[u]:
                    heap.value[u] = limit
                    rise(heap, heap.place[u], u)
    state[0] = n

"""Faces of a planar map given by its rotation system.

An edge k has two half-edges, 2k from its tail to its head and 2k + 1 back. Around each vertex the
half-edges that leave it stand in counterclockwise order; everything here follows from that order
alone and never looks at a coordinate::

        \\   h        next(h) is the first half-edge clockwise from
         \\ /         twin(h) around the head of h, so that walking
    next(h) o          along next keeps one face on the left
             \\
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.graphs import components, spanning_tree


@dataclass(frozen=True, eq=False)
class PlanarMap:
    """Cycles, components and faces of a planar map.

    Attributes
    ----------
    tail : (2m,) int64
        Vertex that each half-edge leaves.
    next : (2m,) int64
        Next half-edge along the face on the left.
    cycle : (2m,) int64
        Cycle of `next` on which each half-edge lies.
    component : (2m,) int64
        Connected component of each half-edge.
    n_cycles, n_components : int
    n_vertices : int
        Vertices with an edge.
    """

    tail: np.ndarray
    next: np.ndarray
    cycle: np.ndarray
    component: np.ndarray
    n_cycles: int
    n_components: int
    n_vertices: int

    @staticmethod
    def from_rotation(tail: np.ndarray, counterclockwise: np.ndarray) -> PlanarMap:
        """Build the map.

        Parameters
        ----------
        tail : (2m,) int64
            Vertex that each half-edge leaves; half-edges 2k and 2k + 1 are twins.
        counterclockwise : (2m,) int64
            All half-edges, grouped by tail vertex, counterclockwise within a group.
        """
        n = len(tail)
        at = tail[counterclockwise]
        first = np.flatnonzero(np.r_[True, at[1:] != at[:-1]]) if n else np.zeros(0, np.int64)
        last = np.r_[first[1:] - 1, n - 1] if n else first
        clockwise = np.empty(n, np.int64)
        clockwise[counterclockwise[1:]] = counterclockwise[:-1]
        clockwise[counterclockwise[first]] = counterclockwise[last]
        twin = np.arange(n) ^ 1
        follow = clockwise[twin]
        n_cycles, cycle = components(n, np.arange(n), follow)
        used, compact = np.unique(tail, return_inverse=True)
        n_components, label = components(len(used), compact[0::2], compact[1::2])
        return PlanarMap(tail, follow, cycle, label[compact], n_cycles, n_components, len(used))

    def is_planar(self) -> bool:
        """Whether Euler's formula holds, so that the rotation system can be drawn in the plane."""
        return self.n_vertices - len(self.tail) // 2 + self.n_cycles == 2 * self.n_components

    def outer_cycles(self, terms: np.ndarray) -> np.ndarray:
        """The cycle of each component that has everything else of it on its left.

        Parameters
        ----------
        terms : (2m,) float64
            Green's area term of each half-edge.
        """
        areas = np.bincount(self.cycle, terms, self.n_cycles)
        owner = np.empty(self.n_cycles, np.int64)
        owner[self.cycle] = self.component
        order = np.lexsort((areas, owner))
        return order[np.searchsorted(owner[order], np.arange(self.n_components))]

    def faces(self, outer: np.ndarray, inside: np.ndarray) -> np.ndarray:
        """Face on the left of each half-edge, (2m,); face 0 is the unbounded one.

        Parameters
        ----------
        outer : (n_components,) int64
            `outer_cycles`.
        inside : (n_components,) int64
            A half-edge of another component with the same face on its left as the outer cycle of
            this component, or -1 where that face is the unbounded one.
        """
        unbounded = self.n_cycles
        target = np.where(inside >= 0, self.cycle[inside], unbounded)
        _, label = components(self.n_cycles + 1, outer, target)
        # Number the faces by first appearance behind the unbounded one: no library order enters.
        sequence = np.r_[label[unbounded], label[self.cycle]]
        _, first, back = np.unique(sequence, return_index=True, return_inverse=True)
        rank = np.empty(len(first), np.int64)
        rank[np.argsort(first, kind="stable")] = np.arange(len(first))
        return rank[back][1:]


def subtree_order(n_faces: int, left: np.ndarray, right: np.ndarray) -> Dual:
    """Spanning tree of the dual graph from face 0, with a preorder of its faces.

    Parameters
    ----------
    n_faces : int
    left, right : (m,) int64
        Faces on both sides of each edge.
    """
    m = len(left)
    pair = np.minimum(left, right) * n_faces + np.maximum(left, right)
    _, first = np.unique(pair, return_index=True)
    first = first[left[first] != right[first]]
    parent, order = spanning_tree(n_faces, left[first], right[first])
    children = np.flatnonzero(parent >= 0)
    # The edge to the parent: the one of lowest number between the two faces.
    key = np.minimum(children, parent[children]) * n_faces + np.maximum(children, parent[children])
    chosen = first[np.searchsorted(pair[first], key, sorter=None)] if m else children
    position = np.empty(n_faces, np.int64)
    position[order] = np.arange(n_faces)
    size = [1] * n_faces
    up = parent.tolist()
    for face in order[:0:-1].tolist():
        size[up[face]] += size[face]
    return Dual(position, np.array(size, np.int64), children, chosen)


@dataclass(frozen=True, eq=False)
class Dual:
    """Preorder of a spanning tree of the faces: what holds below a face is an interval of it.

    Attributes
    ----------
    position : (n_faces,) int64
        Place of each face in the preorder.
    size : (n_faces,) int64
        Number of faces in the subtree of each face, itself included.
    child : (n_faces - 1,) int64
        Every face but the root.
    edge : (n_faces - 1,) int64
        Edge between each child and its parent.
    """

    position: np.ndarray
    size: np.ndarray
    child: np.ndarray
    edge: np.ndarray

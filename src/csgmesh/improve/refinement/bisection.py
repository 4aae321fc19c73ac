"""Halve edges of tetrahedra, longest first, and what conformity asks for.

Source: A. Plaza, G. F. Carey, "Local refinement of simplicial grids based on the skeleton", Applied
Numerical Mathematics 32 (2000). Whenever an edge is halved, the longest edge of each face at it is
halved, too. Each face is cut at its longest edge first, then from there to its other halved edges,
which does not depend on the cell that looks at it: so the parts of all cells fit together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from csgmesh.improve.exact_surfaces import ExactSurfaces
from csgmesh.improve.refinement.solids import around_bad_children
from csgmesh.improve.solid_edges import SolidEdges
from csgmesh.mesh import KINDS, Mesh

#: Edges of each face of a tetrahedron, in the order of `Kind`.
_FACES = np.array(
    [
        [k for k, edge in enumerate(KINDS["tetra"].edges) if set(edge) <= set(face)]
        for face in KINDS["tetra"].facets
    ]
)


@dataclass(frozen=True, eq=False)
class _Halved:
    """The edges that are halved, sorted by their ends.

    Attributes
    ----------
    keys : (h,) int64
        Lower end times `n_points` plus higher end.
    rank : (h,) int64
        Greater for longer edges; no two have the same.
    middle : (h,) int64
        The vertex in the middle.
    """

    n_points: int
    keys: np.ndarray
    rank: np.ndarray
    middle: np.ndarray

    def of(self, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rank and middle vertex of pairs of points (..., 2), -1 where no edge is halved."""
        low, high = pairs.min(axis=-1), pairs.max(axis=-1)
        key = np.where(high < self.n_points, low * self.n_points + high, -1)
        at = np.minimum(np.searchsorted(self.keys, key), len(self.keys) - 1)
        known = self.keys[at] == key
        return np.where(known, self.rank[at], -1), np.where(known, self.middle[at], -1)


def bisect_solid(mesh: Mesh, marked: np.ndarray) -> Mesh:
    """Halve all edges of marked tetrahedra, and others as conformity asks; see `csgmesh.refine`."""
    edges = SolidEdges.of(mesh.cells, mesh.facets, mesh.n_points)
    length = ((mesh.points[edges.ends[:, 0]] - mesh.points[edges.ends[:, 1]]) ** 2).sum(axis=1)
    rank = np.empty(edges.n_edges, np.int64)
    # Of edges as long as each other the one with the lower number comes first.
    rank[np.lexsort((-np.arange(edges.n_edges), length))] = np.arange(edges.n_edges)
    number = np.flatnonzero(_spread(edges, rank, marked))
    if not len(number):
        return replace(mesh, cell_parent={"tetra": np.arange(mesh.n_cells)})
    halved = _Halved(
        mesh.n_points,
        edges.ends[number, 0] * mesh.n_points + edges.ends[number, 1],
        rank[number],
        mesh.n_points + np.arange(len(number)),
    )
    order = np.argsort(halved.keys)
    halved = _Halved(mesh.n_points, halved.keys[order], halved.rank[order], halved.middle[order])
    tetra, parent = _divided(mesh.cells["tetra"], halved)
    points, n_on_chords = _placed(mesh, edges, number, tetra)
    return Mesh(
        points,
        {"tetra": tetra},
        {"tetra": mesh.cell_region["tetra"][parent]},
        mesh.region_names,
        cell_parent={"tetra": parent},
        boundary_names=mesh.boundary_names,
        point_marker=np.r_[mesh.point_marker, np.full(len(number), -1)],
        domain=mesh.domain,
        info={**mesh.info, "refinement": "longest edge", "points_on_chords": n_on_chords},
        **_facets(mesh, halved),
    )


def _spread(edges: SolidEdges, rank: np.ndarray, marked: np.ndarray) -> np.ndarray:
    """Which edges are halved: those of marked cells, and the longest of each face with one."""
    of_cell = edges.cell_edges["tetra"]
    faces = of_cell[:, _FACES].reshape(-1, 3)
    longest = np.take_along_axis(faces, rank[faces].argmax(axis=1)[:, None], axis=1)[:, 0]
    order = np.argsort(faces.ravel(), kind="stable")
    begin = np.searchsorted(faces.ravel()[order], np.arange(edges.n_edges + 1))
    halved = np.zeros(edges.n_edges, bool)
    fresh = np.unique(of_cell[marked])
    while len(fresh):
        halved[fresh] = True
        count = begin[fresh + 1] - begin[fresh]
        within = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
        around = order[np.repeat(begin[fresh], count) + within] // 3
        fresh = np.unique(longest[around])
        fresh = fresh[~halved[fresh]]
    return halved


def _divided(rows: np.ndarray, halved: _Halved) -> tuple[np.ndarray, np.ndarray]:
    """Simplices cut at their longest halved edges until none is left, and the parent of each.

    Children stand where their parent stood, in the order of its corners.
    """
    pairs = np.array([(a, b) for a in range(rows.shape[1]) for b in range(a + 1, rows.shape[1])])
    parent = np.arange(len(rows))
    done_rows, done_parent, done_path = [rows[:0]], [parent[:0]], [parent[:0]]
    path, step = np.zeros(len(rows), np.int64), 0
    while len(rows):
        rank, middle = halved.of(rows[:, pairs])
        best = rank.argmax(axis=1)
        each = np.arange(len(rows))
        whole = rank[each, best] < 0
        done_rows.append(rows[whole])
        done_parent.append(parent[whole])
        done_path.append(path[whole])
        cut = np.flatnonzero(~whole)
        ends, vertex = pairs[best[cut]], middle[cut, best[cut]]
        first, second = rows[cut].copy(), rows[cut].copy()
        first[np.arange(len(cut)), ends[:, 1]] = vertex
        second[np.arange(len(cut)), ends[:, 0]] = vertex
        step += 1
        rows = np.concatenate([first, second])
        parent = np.concatenate([parent[cut]] * 2)
        # Earlier cuts weigh more; a simplex is cut six times in a row at the most.
        path = np.concatenate([path[cut], path[cut] + (1 << (8 - step))])
    parent = np.concatenate(done_parent)
    order = np.lexsort((np.concatenate(done_path), parent))
    return np.concatenate(done_rows)[order], parent[order]


def _facets(mesh: Mesh, halved: _Halved) -> dict[str, Any]:
    if "triangle" not in mesh.facets:
        return {}
    rows, source = _divided(mesh.facets["triangle"], halved)
    return {
        "facets": {"triangle": rows},
        "facet_marker": {"triangle": mesh.facet_marker["triangle"][source]},
        "facet_region": {"triangle": mesh.facet_region["triangle"][source]},
    }


def _placed(
    mesh: Mesh, edges: SolidEdges, number: np.ndarray, tetra: np.ndarray
) -> tuple[np.ndarray, int]:
    """Points of the divided mesh, and how many new ones had to stay on their chords."""
    ends = edges.ends[number]
    middle = 0.5 * (mesh.points[ends[:, 0]] + mesh.points[ends[:, 1]])
    straight = np.empty((edges.n_edges, 3))
    straight[number] = middle
    is_halved = np.zeros(edges.n_edges, bool)
    is_halved[number] = True
    exact, moved = ExactSurfaces.of(mesh).of_edges(edges.facet_edges, straight, is_halved)
    place, moved = exact[number], moved[number]
    held = np.zeros(len(number), bool)
    while True:
        points = np.concatenate([mesh.points, np.where(held[:, None], middle, place)])
        bent = np.concatenate([np.zeros(mesh.n_points, bool), moved & ~held])
        back = around_bad_children(points, {"tetra": tetra}, bent)
        if not len(back):
            return points, int(held.sum())
        held[back - mesh.n_points] = True

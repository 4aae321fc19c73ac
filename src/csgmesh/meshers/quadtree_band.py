"""The strip between a tree's inside and the domain's boundary."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.quadtree_sampling import Samples
from csgmesh.meshers.subdivision import Subdivision
from csgmesh.meshers.workspace import CROSSING, ON_SEGMENT, Progress, Workspace
from csgmesh.tree import LinearTree
from csgmesh.tree.growth import MIXED, RegionOf

#: Leaves nearer to a boundary than this share of their size belong to the strip.
NEAR = 0.55
#: Vertices of the strip nearer to a boundary than this share of their leaf's size are dropped.
DROPPED = 0.55
#: Kinds of leaves, as the kernels know them.
BAND, CORE = 1, 2
#: Status of a vertex that only leaves of the strip use.
OF_BAND = 1
SLICE = 400_000


class Crossed(Exception):
    """Edges of the boundary that are in each other's way: rows of `Samples`."""

    def __init__(self, edges: list[int]) -> None:
        self.edges = edges


@dataclass(frozen=True, eq=False)
class Grid:
    """A tree's leaves sorted into inside, strip and outside, and its vertices by code.

    Attributes
    ----------
    tree : LinearTree
    kind : (n,) uint8
    region : (n,) int32
    corner : (n, 4) int64
        Codes of the corners of leaves that count.
    status : (4 n,) uint8
        What uses the vertex of each code.
    """

    tree: LinearTree
    kind: np.ndarray
    region: np.ndarray
    corner: np.ndarray
    status: np.ndarray


def sorted_grid(
    tree: LinearTree, region: np.ndarray, samples: Samples, region_of: RegionOf
) -> Grid:
    """Sort a tree's leaves by where they lie to the boundary, and drop vertices too near to it."""
    ends = samples.points[samples.ends].reshape(-1)
    loose = np.setdiff1d(np.arange(len(samples.kept)), samples.ends)
    if len(loose):
        ends = np.concatenate([ends, np.repeat(samples.points[loose], 2, axis=0).reshape(-1)])
    pieces, leaves = near_pairs(tree, ends)
    is_near = np.zeros(tree.n_leaves, bool)
    is_near[leaves] = True
    region = region.copy()
    unsure = np.flatnonzero((region == MIXED) & ~is_near)
    if len(unsure):
        lo, size = tree[unsure].boxes()
        region[unsure] = region_of(lo + 0.5 * size)
    kind = np.where(is_near, BAND, np.where(region >= 0, CORE, 0)).astype(np.uint8)
    n = tree.n_leaves
    corner, status = np.empty(4 * n, np.int64), np.zeros(4 * n, np.uint8)
    for begin in range(0, n, SLICE):
        kernels.mark_vertices(
            tree.key, tree.level, kind, begin, min(begin + SLICE, n), corner, status
        )
    kernels.drop_near(tree.key, tree.level, tree.unit, ends, pieces, leaves, DROPPED, status)
    return Grid(tree, kind, region, corner, status)


def near_pairs(tree: LinearTree, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of straight pieces (4 m,) and leaves near them."""
    room = 8 * len(ends) + 64
    counts = np.zeros(2, np.int64)
    piece, leaf = np.empty(room, np.int64), np.empty(room, np.int64)
    stack = np.empty(3 * 4 * 31, np.int64)
    while kernels.pair_pieces(
        tree.key, tree.level, tree.unit, ends, counts, NEAR, stack, piece, leaf
    ):
        piece = np.concatenate([piece, np.empty_like(piece)])
        leaf = np.concatenate([leaf, np.empty_like(leaf)])
    return piece[: counts[1]], leaf[: counts[1]]


@dataclass(frozen=True, eq=False)
class Strip:
    """Triangles between boundary and core.

    Attributes
    ----------
    cells : (m, 3) int64
        Vertices: those of the samples come first, then those of the grid in the order of `codes`.
    regions : (m,) int64
    points : (n, 2) float64
    codes : (k,) int64
        Codes of the grid's vertices.
    """

    cells: np.ndarray
    regions: np.ndarray
    points: np.ndarray
    codes: np.ndarray


def triangulated_strip(
    domain: Pslg,
    grid: Grid,
    samples: Samples,
    progress: Progress | None,
) -> Strip:
    """Triangulate the strip: all its vertices are given, none is inserted.

    Raises
    ------
    Crossed
        If edges of the boundary meet.
    """
    band = np.flatnonzero(grid.kind == BAND)
    edges, leaf = np.empty((8 * len(band), 2), np.int64), np.empty(8 * len(band), np.int64)
    n_edges = kernels.core_edges(
        grid.tree.key, grid.tree.level, grid.kind, band, edges.reshape(-1), leaf
    )
    edges, leaf = edges[:n_edges], leaf[:n_edges]
    slots = 4 * band[:, None] + np.arange(3)
    mine = np.concatenate([slots.ravel(), grid.corner.reshape(-1, 4)[band].ravel(), edges.ravel()])
    mine = np.unique(mine[mine >= 0])
    codes = mine[grid.status[mine] > 0]
    n = len(samples.points)
    number = n + np.searchsorted(codes, edges)
    points = np.concatenate([samples.points, places(grid.tree, codes)])
    ends = np.concatenate([samples.ends, number])
    m = len(ends)
    sides = np.concatenate(
        [
            domain.segment_region[samples.segment],
            np.column_stack([np.full(n_edges, -1), grid.region[leaf]]),
        ]
    )
    marker = np.concatenate([domain.segment_marker[samples.segment], np.zeros(n_edges, np.int64)])
    strip = Pslg.build(
        points=points,
        segments=ends,
        segment_marker=marker,
        segment_region=sides,
        boundary_names=domain.boundary_names,
        region_names=domain.region_names,
    )
    whole = np.tile([0.0, 1.0], (m, 1))
    work = Workspace(strip, Subdivision(points, ends, np.arange(m), whole, whole), progress)
    work.triangulate()
    status, k, met = work.recover()
    if status in (CROSSING, ON_SEGMENT):
        found = {int(work.pieces.segment[k])}
        if status == CROSSING:
            found.add(int(work.pieces.segment[met]))
        raise Crossed(sorted(f for f in found if f < len(samples.ends)))
    work.flood()
    return Strip(*_cells(work), points, codes)


def places(tree: LinearTree, codes: np.ndarray) -> np.ndarray:
    """Coordinates of a tree's vertices by code."""
    lo, size = tree[codes >> 2].boxes()
    slot = codes & 3
    return lo + 0.5 * size * np.column_stack([slot >= 2, slot % 2 == 1])


def _cells(work: Workspace) -> tuple[np.ndarray, np.ndarray]:
    used = np.zeros(work.n_points, np.uint8)
    n = kernels.mark_used(work.origin, work.twin, work.n_triangles, used)
    cells, regions = np.empty((n, 3), np.int64), np.empty(n, np.int64)
    kernels.extract(
        work.origin,
        work.twin,
        work.n_triangles,
        work.order.astype(np.int32),
        cells.reshape(-1),
        regions,
    )
    return cells, regions

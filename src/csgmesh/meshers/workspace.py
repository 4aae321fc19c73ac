"""The shell around the kernels: arrays that grow, interruptions, errors with a place."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh import kernels
from csgmesh.domain.input_angles import SharpCorners
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import MeshingError
from csgmesh.meshers.subdivision import Subdivision

Progress = Callable[[str, int, int], None]

DONE, ROOM, SLICE, BUDGET, DUPLICATE, CROSSING, ON_SEGMENT, COLLINEAR, STUCK, LEAK = range(10)

#: Triangles that a cavity may hold before its buffers have to grow; most hold fewer than ten.
CAVITY = 512
BOTH_APEXES = -2
NO_TRIANGLE = 2**62
#: Points of a domain: their numbers share a 64-bit key with their place on a curve.
MOST_POINTS = 2**28


def grown(array: np.ndarray, size: int) -> np.ndarray:
    """The same flat array, longer: resized in place, which moves pages instead of copying.

    Resizing fills the new part with zeros, so an array that grows by far is copied after all.
    """
    if size > 2 * len(array):
        longer = np.empty(size, array.dtype)
        longer[: len(array)] = array
        return longer
    if array.base is not None:
        array = array.copy()
    array.resize(size, refcheck=False)
    return array


class Workspace:
    """Constrained Delaunay triangulation of a domain, in the kernels' arrays.

    Vertices are numbered in the order of their insertion; `rank` maps the numbers of the
    subdivision's points to them.
    """

    def __init__(self, domain: Pslg, pieces: Subdivision, progress: Progress | None) -> None:
        self.domain = domain
        self.pieces = pieces
        self.progress = progress
        n = len(pieces.points)
        if n > MOST_POINTS:
            raise MeshingError(f"a domain may have {MOST_POINTS} points; it has {n}")
        self.order, self.rank, self.points = kernels.insertion_order(pieces.points)
        self.n_points = n
        self.n_triangles = 0
        #: Triangles from this one on are known to be good.
        self.regular_from = NO_TRIANGLE
        half_edges = 4 * (2 * n + 8)
        self.origin = np.empty(half_edges, np.int32)
        self.twin = np.empty(half_edges, np.int32)
        self.sub = np.empty(half_edges, np.int32)
        self.work = np.empty((5, CAVITY), np.int32)
        self.ends = self.rank.take(pieces.ends).reshape(-1)
        self.recovered = 0
        self.segment, self.interval = pieces.segment, pieces.interval

    @property
    def has_lattice(self) -> bool:
        """Whether blocks of ready triangles are part of the triangulation."""
        return self.regular_from < NO_TRIANGLE

    def report(self, stage: str, done: int, total: int) -> None:
        """Tell whoever listens how far things are."""
        if self.progress is not None:
            self.progress(stage, done, total)

    def place(self, vertex: int) -> str:
        """Coordinates of a vertex, for messages."""
        x, y = self.points[2 * vertex : 2 * vertex + 2]
        return f"({x:.12g}, {y:.12g})"

    def segment_text(self, k: int) -> str:
        """A subsegment with its name and place, for messages."""
        a, b = self.ends[2 * k : 2 * k + 2]
        s = int(self.pieces.segment[k])
        names = self.domain.boundary_names[self.domain.segment_marker[s]]
        return f"{' = '.join(names)} from {self.place(a)} to {self.place(b)}"

    def widen(self) -> None:
        """Double the buffers of a cavity, keeping what they hold."""
        wide = np.empty((5, 2 * self.work.shape[1]), np.int32)
        wide[:, : self.work.shape[1]] = self.work
        self.work = wide

    def release(self) -> None:
        """Let go of the triangulation; points and subsegments stay."""
        self.origin = self.twin = self.sub = np.empty(0, np.int32)

    def triangulate(self) -> None:
        """Delaunay triangulation of the points."""
        counts = np.zeros(8, np.int64)
        while True:
            status = kernels.insert_points(
                self.points, self.origin, self.twin, self.sub, self.work, counts, self.n_points
            )
            self.report("triangulate", int(counts[0]), self.n_points)
            if status == ROOM:
                self.widen()
            elif status != SLICE:
                break
        self.n_triangles = int(counts[1])
        if status == DUPLICATE:
            i, j = self.order[counts[5]], self.order[counts[0]]
            raise MeshingError(
                f"points of a domain must differ; points {min(i, j)} and {max(i, j)} "
                f"are both {self.place(int(counts[0]))}"
            )
        if status == COLLINEAR:
            raise MeshingError(
                f"a domain needs three points that are not collinear; it has {self.n_points} points"
            )

    def recover(self) -> tuple[int, int, int]:
        """Make all subsegments edges. Returns a status and what stood in the way of which."""
        vertex_edge = np.empty(self.n_points, np.int32)
        counts = np.array([self.recovered, 1, 0, 0, -1, 0], np.int64)
        while True:
            status = kernels.recover_segments(
                self.points,
                self.origin,
                self.twin,
                self.sub,
                self.work,
                vertex_edge,
                self.ends,
                counts,
                self.n_triangles,
            )
            self.report("recover segments", int(counts[0]), len(self.pieces.ends))
            if status == ROOM:
                self.widen()
            elif status != SLICE:
                return int(status), int(counts[0]), int(counts[4])

    def cut(self, k: int, vertex: int) -> None:
        """Cut straight subsegment k at a vertex that lies on it."""
        a, b, v = (self.points[2 * i : 2 * i + 2] for i in (*self.ends[2 * k : 2 * k + 2], vertex))
        share = float((v - a) @ (b - a) / ((b - a) @ (b - a)))
        self.pieces = self.pieces.cut(k, int(self.order[vertex]), share)
        self.ends = self.rank[self.pieces.ends].reshape(-1)
        self.segment, self.interval = self.pieces.segment, self.pieces.interval
        self.recovered = k

    def set_subsegments(self, ends: np.ndarray, segment: np.ndarray, interval: np.ndarray) -> None:
        """Take over refined subsegments; `ends` counts vertices as the kernels do."""
        self.ends = ends
        self.segment, self.interval = segment, interval

    def flood(self) -> None:
        """Give each triangle its region."""
        counts = np.zeros(1, np.int64)
        sides = self.domain.segment_region[self.pieces.segment].astype(np.int32).reshape(-1)
        queue = np.empty(self.n_triangles, np.int32)
        status = kernels.flood_regions(
            self.origin, self.twin, self.sub, self.ends, sides, counts, queue, self.n_triangles
        )
        if status == LEAK:
            raise MeshingError(
                "each region must be closed; different regions meet beside "
                + self.segment_text(int(counts[0]))
            )

    def sharp(self, corners: SharpCorners) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Apex of each subsegment, two apexes of each vertex, radius of the shells by vertex."""
        apex = np.full(len(self.pieces.ends), -1, np.int32)
        apex_of = np.full(2 * self.n_points, -1, np.int32)
        radius = np.zeros(self.n_points)
        if not len(corners.vertex):
            return apex, apex_of, radius
        radius[self.rank[corners.vertex]] = corners.radius
        seg = self.pieces.segment
        vertex = self.rank[self.domain.segments[seg]]
        first, second = corners.is_sharp_end[seg].T
        apex[first] = vertex[first, 0]
        apex[second] = vertex[second, 1]
        apex[first & second & self.pieces.is_whole] = BOTH_APEXES
        # Seeds between two apexes belong to the nearer one, as if the middle had been split first.
        torn = first & second & ~self.pieces.is_whole
        if torn.any():
            late = torn & (self.pieces.share.mean(axis=1) > 0.5)
            apex[torn & ~late] = vertex[torn & ~late, 0]
            apex[late] = vertex[late, 1]
        return apex, self._apexes_of_vertices(apex), radius

    def _apexes_of_vertices(self, apex: np.ndarray) -> np.ndarray:
        """Up to two apexes on whose segments each vertex lies, (2 n,), -1 where there are fewer."""
        ends = self.ends.reshape(-1, 2)
        both = apex == BOTH_APEXES
        at = apex >= 0
        vertex = np.concatenate([ends[at].ravel(), ends[both, 0], ends[both, 1]])
        owner = np.concatenate([np.repeat(apex[at], 2), ends[both, 1], ends[both, 0]])
        other = vertex != owner
        key = np.sort(vertex[other] * np.int64(self.n_points) + owner[other])
        key = key[np.concatenate([[True], key[1:] != key[:-1]])[: len(key)]]
        vertex, owner = key // self.n_points, key % self.n_points
        slot = np.arange(len(key)) - np.searchsorted(vertex, vertex)
        out = np.full((self.n_points, 2), -1, np.int32)
        kept = slot < 2
        out[vertex[kept], slot[kept]] = owner[kept]
        return out.reshape(-1)

"""A hexagonal lattice inside a domain: where the size is uniform, nothing is better.

The lattice is laid before anything is triangulated. Its points keep such a distance from vertices
and segments that the circumcircle of three neighbours is clear of both; so all its triangles belong
to the constrained Delaunay triangulation, and only what lies between its outline and the boundary
remains to be triangulated. Then the lattice takes the place of the triangles inside its outline.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import MeshingError
from csgmesh.meshers.subdivision import Subdivision
from csgmesh.meshers.workspace import SLICE, Workspace, grown
from csgmesh.tolerance import coordinate_ulp

#: Lattice points nearer than this to a vertex, or to a subsegment, are left out (shares of the
#: size): what lies between lattice and boundary is left to refinement. A circumcircle, of radius
#: 0.58, that came near a subsegment would have a corner within 0.5 of it, or within 0.7 of its
#: end: less will not do.
FROM_VERTEX = 0.7
FROM_SEGMENT = 0.5
#: A subsegment with a diametral circle of this radius is so long that it is split in any case.
SPLIT_ANYWAY = 0.65
#: A lattice is as regular as it must be only if its size is this many units in the last place.
COARSEST_ROUNDING = 1e4
#: Distance of rows, in half steps along them.
ROW_HEIGHT = np.sqrt(3.0)
#: Vertices that refinement may add before arrays have to grow, per vertex around the lattice.
SPARE = 4


@dataclass(frozen=True)
class Frame:
    """A hexagonal lattice: a point of it, the direction of its rows, its edge length."""

    origin: np.ndarray
    along: np.ndarray
    size: float

    @classmethod
    def of(cls, domain: Pslg, size: float) -> Frame:
        """The lattice with a row on the domain's longest segment."""
        a, b = (domain.points[domain.segments[:, k]] for k in (0, 1))
        length = np.hypot(*(b - a).T)
        longest = int(np.argmax(length))
        return cls(a[longest], (b - a)[longest] / length[longest], size)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Places of points, in half steps along and across the rows, (n, 2)."""
        return (points - self.origin) @ self.axes.T / (0.5 * self.size)

    @property
    def axes(self) -> np.ndarray:
        """Directions along and across the rows."""
        return np.array([self.along, (-self.along[1], self.along[0])])

    def shifted(self, row: int, u: int) -> Frame:
        """The same lattice counted from another point."""
        step = 0.5 * self.size * np.array([u, row * ROW_HEIGHT])
        return Frame(self.origin + step @ self.axes, self.along, self.size)


class Blocks:
    """All the points of lattices that fit into a domain, and the triangles between them."""

    def __init__(self, runs: np.ndarray, lines: np.ndarray) -> None:
        self.runs = runs
        self.lines = lines
        self.n = runs.shape[1]
        row, first, last = runs
        length = (last - first) // 2 + 1
        self.offset = np.cumsum(length) - length
        # Runs as numbers that sort them: a run below touches if it ends behind the first point.
        least, most = (int(first.min()), int(last.max())) if self.n else (0, 0)
        width = most - least + 1
        ends = row * width + (last - least)
        begins = row * width + (first - least)
        self.below = np.searchsorted(ends, begins - width)
        self.above = np.searchsorted(ends, begins + width)
        self.vertex = np.empty(int(length.sum()), np.int32)
        self.n_inner, self.n_outer = kernels.number_lattice(
            runs, self.n, self.below, self.above, self.offset, self.vertex
        )

    @classmethod
    def together(cls, found: list[tuple[np.ndarray, np.ndarray]]) -> Blocks | None:
        """Blocks of several lattices, whose rows do not touch; None of no points."""
        found = [(runs, lines) for runs, lines in found if len(lines)]
        if not found:
            return None
        shift, shifted = 0, []
        for runs, _ in found:
            shifted.append(runs + np.array([[shift], [0], [0]]))
            shift += 2 * (int(runs[0, -1]) // 2 + 2)
        lines = np.concatenate([lines for _, lines in found])
        return cls(np.ascontiguousarray(np.concatenate(shifted, axis=1)), lines)

    @property
    def outline(self) -> np.ndarray:
        """Coordinates of the points on the outline, row by row, (n, 2)."""
        at = np.flatnonzero(self.vertex < 0)
        run = np.searchsorted(self.offset, at, side="right") - 1
        u = self.runs[1][run] + 2 * (at - self.offset[run])
        x, y, dx, dy = self.lines[run].T
        return np.column_stack([x + u * dx, y + u * dy])

    def weave_into(self, work: Workspace, first: int) -> None:
        """Put the blocks into a triangulation in which the outline is numbered from `first` on."""
        strips, first_strip, edges, n_triangles = self._strips()
        ring = work.rank[first : first + self.n_outer]
        number = np.where(self.vertex < 0, ring[-1 - self.vertex * (self.vertex < 0)], 0)
        edges[:, :2] = number[edges[:, :2]]
        outside, regions, hole = self._hole(work, edges)
        n_ring = work.n_points
        spare = SPARE * n_ring + 1024
        work.points = grown(work.points, 2 * (n_ring + self.n_inner + spare))
        total = work.n_triangles - len(hole) + n_triangles
        for name in ("origin", "twin", "sub"):
            setattr(work, name, grown(getattr(work, name), 4 * (total + 2 * spare)))
        kernels.place_lattice(
            work.points, self.runs, self.n, self.offset, self.lines.reshape(-1), self.vertex,
            ring, n_ring,
        )  # fmt: skip
        counts = np.array([0, len(hole)], np.int64)
        status = SLICE
        while status == SLICE:
            status = kernels.weave(
                work.origin, work.twin, work.n_triangles,
                self.runs, self.n, self.offset, self.vertex,
                strips.reshape(-1), len(strips), first_strip, edges.reshape(-1), len(edges),
                outside, regions, hole, counts,
            )  # fmt: skip
            work.report("fill", int(counts[0]), len(strips))
        work.regular_from = work.n_triangles
        work.n_points, work.n_triangles = n_ring + self.n_inner, total

    def _strips(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
        strips = np.empty((2 * self.n + 1, 6), np.int64)
        first_strip = np.empty(self.n + 1, np.int64)
        edges = np.empty((3 * self.n_outer + 1, 3), np.int64)
        n_strips, n_triangles, n_edges = kernels.list_strips(
            self.runs, self.n, self.below, self.above, self.offset,
            strips.reshape(-1), first_strip, edges.reshape(-1),
        )  # fmt: skip
        return strips[:n_strips], first_strip, edges[:n_edges], n_triangles

    def _hole(self, work: Workspace, edges: np.ndarray) -> tuple[np.ndarray, ...]:
        outside = np.empty(len(edges), np.int32)
        regions = np.empty(len(edges), np.int32)
        hole = np.empty(work.n_triangles, np.int32)
        found = np.zeros(2, np.int64)
        missing = kernels.find_hole(
            work.origin, work.twin, work.n_triangles, edges.reshape(-1), len(edges),
            np.empty(work.n_points, np.int32), outside, regions, hole, found,
        )  # fmt: skip
        if missing:
            at = work.place(int(edges[found[1], 0]))
            raise MeshingError(f"the lattice does not fit into the triangulation at {at}")
        return outside, regions, hole[: found[0]]


def lay_lattice(domain: Pslg, cut: Subdivision, size: float) -> Blocks | None:
    """The points of a lattice of edge length `size` that fit into a domain cut into pieces."""
    if not is_coarse_enough(domain, size):
        return None
    events = Events.over(Frame.of(domain, size), cut.points)
    ends = cut.points[cut.ends]
    keep_from_boundary(events, cut.points, ends)
    left, right = (domain.segment_region[cut.segment] >= 0).T.astype(np.int64)
    events.keep_from_segments(ends, right - left, 0.0)
    return Blocks.together([events.runs()])


def is_coarse_enough(domain: Pslg, size: float) -> bool:
    """Whether a lattice of that size is not spoilt by rounding."""
    return size >= COARSEST_ROUNDING * coordinate_ulp(domain.points)


def keep_from_boundary(events: Events, points: np.ndarray, ends: np.ndarray) -> None:
    """Block what is too near to the points (n, 2) and pieces (k, 2, 2) of a domain's boundary."""
    size = events.frame.size
    events.keep_from_points(points, FROM_VERTEX * size)
    events.keep_from_segments(ends, np.zeros(len(ends), np.int64), FROM_SEGMENT * size)
    # Nor may a subsegment be encroached upon, unless it is going to be split anyway.
    radius = 0.5 * np.hypot(*np.diff(ends, axis=1)[:, 0].T)
    near = (radius > 0.999 * FROM_SEGMENT * size) & (radius < SPLIT_ANYWAY * size)
    events.keep_from_points(ends[near].mean(axis=1), 1.001 * radius[near])


class Events:
    """What happens along the rows of a lattice: blocked stretches, boundaries crossed."""

    def __init__(self, frame: Frame, rows: int, width: int) -> None:
        self.frame, self.rows, self.width = frame, rows, width
        self.numbers = np.concatenate([frame.origin, frame.axes.ravel() / (0.5 * frame.size)])
        self.keys = np.empty(0, np.int64)
        self.n = 0

    @classmethod
    def over(cls, frame: Frame, points: np.ndarray) -> Events:
        """Along the rows that pass the box of some points."""
        (s0, t0), (s1, t1) = extent(frame(points))
        row, u = 2 * int(np.floor(0.5 * t0 / ROW_HEIGHT)), 2 * int(np.floor(0.5 * s0))
        rows = int(np.ceil(t1 / ROW_HEIGHT)) - row + 1
        return cls(frame.shifted(row, u), rows, int(np.ceil(s1)) - u + 2)

    def keep_from_points(self, points: np.ndarray, distance: np.ndarray | float) -> None:
        """Block what is nearer to points than a distance."""
        reach = np.broadcast_to(distance, len(points)) * (2.0 / self.frame.size)
        self._make_room(float((2 * reach / ROW_HEIGHT + 1).sum()))
        self.n = kernels.block_around_points(
            self.numbers, flat(points), flat(reach), self.rows, self.width, self.keys, self.n
        )

    def keep_from_segments(self, ends: np.ndarray, steps: np.ndarray, distance: float) -> None:
        """Block what lies beside segments (n, 2, 2); steps: whether they are entered or left."""
        reach = 2.0 * distance / self.frame.size
        long = 2.0 * np.abs(np.diff(ends, axis=1)).sum() / self.frame.size
        self._make_room(2 * (long / ROW_HEIGHT) + len(ends) * (2 * reach / ROW_HEIGHT + 2))
        self.n = kernels.block_around_segments(
            self.numbers, flat(ends), steps, reach, self.rows, self.width, self.keys, self.n
        )

    def _make_room(self, stretches: float) -> None:
        self.keys = grown(self.keys, self.n + 2 * int(stretches) + 2)

    def runs(self) -> tuple[np.ndarray, np.ndarray]:
        """Runs of points inside that nothing blocks: (row, first u, last u), and their lines."""
        keys = self.keys[: self.n]
        keys.sort()
        runs = np.empty((3, self.n), np.int64)
        n = kernels.find_runs(keys, self.n, runs)
        runs = runs[:, :n]
        along, across = 0.5 * self.frame.size * self.frame.axes
        start = self.frame.origin + runs[0][:, None] * ROW_HEIGHT * across
        return runs, np.column_stack([start, np.broadcast_to(along, (n, 2))])


def extent(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest coordinates; by columns, which is several times as fast."""
    x, y = np.ascontiguousarray(points.T)
    return np.array([x.min(), y.min()]), np.array([x.max(), y.max()])


def flat(points: np.ndarray) -> np.ndarray:
    """A writable flat copy: read-only arrays are another type, compiled for once more."""
    return np.array(points, np.float64).reshape(-1)

"""The shell around the refinement kernel."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.domain.input_angles import SharpCorners
from csgmesh.errors import MeshingError
from csgmesh.meshers.background import Background
from csgmesh.meshers.pairing import mirror_splits
from csgmesh.meshers.workspace import BUDGET, NO_TRIANGLE, ROOM, SLICE, STUCK, Workspace, grown
from csgmesh.tolerance import coordinate_ulp

#: Circumradius allowed and longest subsegment allowed, as shares of the wanted edge length:
#: chosen so that the mean edge length comes out as wanted.
CIRCLE_SHARE = 0.75
SEGMENT_SHARE = 1.3
#: The off-centre's angle is a little larger than asked for, so that rounding cannot spoil it
#: (Shewchuk's choice in Triangle).
OFF_CENTRE = 0.475

# Where sizes come from, as the kernel counts it.
EVEN, INHERITED, GIVEN = range(3)
NOTHING = Background(np.empty(1), np.empty(1, np.int32), np.empty(1, np.int32), np.empty(1), 0)

N_BUCKETS = 1024
#: Queue entries a cavity may need, per cavity slot.
PER_CAVITY = 2


class Refiner:
    """Refines a workspace in place, in slices short enough for Ctrl-C and progress."""

    def __init__(
        self, work: Workspace, corners: SharpCorners, min_angle: float, max_points: int
    ) -> None:
        self.work = work
        self.max_points = max_points
        cosine = np.cos(np.radians(min_angle))
        diagonal = work.domain.diagonal
        tiny = 4.0 * coordinate_ulp(work.domain.points)
        off = OFF_CENTRE * np.sqrt((1.0 + cosine) / (1.0 - cosine)) if min_angle > 0 else 0.0
        self.number = np.array(
            [
                cosine**2,
                off,
                CIRCLE_SHARE**2,
                SEGMENT_SHARE**2,
                0.0,
                1.0 / diagonal**2,
                tiny**2,
                1.0,
            ]
        )
        n_sub = len(work.pieces.ends)
        self.n_sub = n_sub
        self.segment = work.pieces.segment.astype(np.int32)
        self.interval = work.pieces.interval.reshape(-1).copy()
        self.ends = work.ends
        self.apex, self.apex_of, self.radius = work.sharp(corners)
        self.apex_of = grown(self.apex_of, len(work.points))
        domain = work.domain
        self.segment_ends = work.rank[domain.segments].reshape(-1)
        self.segment_curve = domain.segment_curve.astype(np.int32)
        self.curve_kind = domain.curves.kind.copy()
        self.curve_data = domain.curves.data.reshape(-1).copy()
        self.buckets = np.full((2, N_BUCKETS), -1, np.int32)
        self.items = np.empty(3 * 4096, np.int32)
        self.state = np.array([-1, 0, N_BUCKETS - 1, 0, 0], np.int64)
        self.todo = np.empty(3 * 2048, np.int32)
        self.size = np.empty(1)
        self.home = np.empty(1, np.int32)
        self.ground = NOTHING
        self.graded = EVEN
        self.count = np.array(
            [work.n_points, work.n_triangles, n_sub, 0, 0, max_points, 0, 0, -1, work.regular_from],
            np.int64,
        )

    def run(self) -> bool:
        """Refine until nothing is bad: True; or until the budget of points is used up: False."""
        finished = self._run()
        while finished and self.work.domain.periodic and mirror_splits(self):
            finished = self._run()
        return finished

    def ask_for_splits(self, number: np.ndarray) -> None:
        """Let the next run split these subsegments first."""
        work = self.work
        wanted = np.zeros(self.n_sub, bool)
        wanted[number] = True
        origin = work.origin[: 4 * work.n_triangles].reshape(-1, 4)
        sub = work.sub[: 4 * work.n_triangles].reshape(-1, 4)
        triangle, edge = np.nonzero(origin[:, 3:] >> np.arange(3) & 1)
        number = sub[triangle, edge]
        _, first = np.unique(number, return_index=True)
        first = first[wanted[number[first]]]
        triangle, edge = triangle[first], edge[first]
        ends = origin[triangle, edge], origin[triangle, (edge + 1) % 3]
        entries = np.column_stack([4 * triangle + edge, *ends]).astype(np.int32)
        self.todo = grown(self.todo, max(len(self.todo), 3 * len(entries) + 3 * 2048))
        self.todo[: entries.size] = entries.ravel()
        self.count[3] = len(entries)

    def _run(self) -> bool:
        while True:
            status = self._slice()
            work = self.work
            work.report("refine", int(self.count[0]), self.max_points)
            if status == ROOM:
                self._make_room()
            elif status != SLICE:
                break
        work.n_points, work.n_triangles = int(self.count[0]), int(self.count[1])
        self.n_sub = int(self.count[2])
        if status == STUCK:
            raise MeshingError(
                "a curve must not cross another boundary; near "
                + self._text(int(self.count[8]))
                + " another segment lies between the curve and its chord"
            )
        return status != BUDGET

    def go_depth_first(self) -> None:
        """Treat triangles with edges of one length last in, first out: see the queue."""
        self.state[4] = 1

    def set_uniform(self, size: float) -> None:
        """Want the same edge length everywhere."""
        self.number[4] = size**2

    def set_sizes(self) -> None:
        """Let each vertex have a size of its own, new ones as their neighbours."""
        self.graded = INHERITED
        self.ground, self.home = NOTHING, np.empty(1, np.int32)
        self.size = grown(self.size, len(self.work.points) // 2)

    def set_background(self, ground: Background) -> None:
        """Want what a coarser mesh says."""
        n = self.work.n_points
        self.graded, self.ground = GIVEN, ground
        size, home = ground.at(self.work.points[: 2 * n])
        self.size = grown(size, len(self.work.points) // 2)
        self.home = grown(home, len(self.work.points) // 2)

    def set_level(self, level: float) -> None:
        """Let edges be so many times as long as wanted."""
        self.number[2] = (CIRCLE_SHARE * level) ** 2
        self.number[3] = (SEGMENT_SHARE * level) ** 2
        self.number[7] = level

    def look_again(self) -> None:
        """Let the next run test every triangle anew, after sizes have changed."""
        self.count[4], self.count[9] = 0, NO_TRIANGLE

    def segments(self) -> np.ndarray:
        """The domain's segment of each subsegment."""
        segment = self.segment[: self.n_sub].astype(np.int64)
        return np.where(segment < 0, -1 - segment, segment)

    def publish(self) -> None:
        """Hand the subsegments back to the workspace, and let go of what refinement needed."""
        n = self.n_sub
        work = self.work
        work.set_subsegments(
            self.ends[: 2 * n],
            self.segments(),
            self.interval[: 2 * n].reshape(-1, 2),
        )
        self.items = self.todo = self.apex_of = np.empty(0, np.int32)
        self.size = np.empty(0)
        self.home, self.ground = np.empty(0, np.int32), NOTHING

    def _slice(self) -> int:
        work = self.work
        rooms = np.array(
            [
                len(work.points) // 2,
                len(work.origin) // 4,
                len(self.segment),
                len(self.items) // 3,
                len(self.todo) // 3,
                work.work.shape[1],
            ],
            np.int64,
        )
        return int(
            kernels.refine(
                work.points,
                work.origin,
                work.twin,
                work.sub,
                work.work,
                self.ends,
                self.segment,
                self.interval,
                self.apex,
                self.segment_ends,
                self.segment_curve,
                self.curve_kind,
                self.curve_data,
                self.buckets,
                self.items,
                self.state,
                self.apex_of,
                self.radius,
                self.size,
                np.int64(self.graded),
                self.number,
                self.todo,
                self.count,
                rooms,
                self.home,
                self.ground.points,
                self.ground.origin,
                self.ground.twin,
                self.ground.size,
            )
        )

    def _make_room(self) -> None:
        """Enlarge whatever is nearly full; the cavity's buffers if nothing is."""
        work = self.work
        cavity = PER_CAVITY * work.work.shape[1]
        points, triangles, subs, todo = (int(k) for k in self.count[:4])
        full = False
        if 2 * (points + 1) > len(work.points):
            n = 3 * points // 2 + 256
            work.points = grown(work.points, 2 * n)
            self.apex_of = grown(self.apex_of, 2 * n)
            if self.graded:
                self.size = grown(self.size, n)
            if self.graded == GIVEN:
                self.home = grown(self.home, n)
            full = True
        if 4 * (triangles + 2) > len(work.origin):
            n = 4 * (3 * triangles // 2 + 512)
            work.origin, work.twin = grown(work.origin, n), grown(work.twin, n)
            work.sub = grown(work.sub, n)
            full = True
        if subs + 1 > len(self.segment):
            n = 2 * subs + 64
            self.ends, self.interval = grown(self.ends, 2 * n), grown(self.interval, 2 * n)
            self.segment, self.apex = grown(self.segment, n), grown(self.apex, n)
            full = True
        if int(self.state[1]) + max(cavity, 8) > len(self.items) // 3:
            self.items = grown(self.items, 3 * (len(self.items) // 2 + cavity))
            full = True
        if todo + max(cavity, 8) > len(self.todo) // 3:
            self.todo = grown(self.todo, 2 * len(self.todo) + 3 * cavity)
            full = True
        if not full:
            work.widen()

    def _text(self, k: int) -> str:
        segment = int(self.segment[k])
        a, b = (self.work.place(int(v)) for v in self.ends[2 * k : 2 * k + 2])
        domain = self.work.domain
        marker = domain.segment_marker[segment if segment >= 0 else -1 - segment]
        return f"{' = '.join(domain.boundary_names[marker])} from {a} to {b}"

"""Sizes at the vertices of a triangulation under refinement."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError
from csgmesh.meshers.pairing import smaller_of_both
from csgmesh.meshers.refiner import Refiner
from csgmesh.size.resolve import ResolvedSize, evaluate

#: Points per area of an equilateral triangulation of edge length 1.
POINTS_PER_AREA = 2.0 / np.sqrt(3.0)
#: A mesh is given up before it is made when its sizes ask for this many times the budget.
OVER_BUDGET = 1.5
#: Sizes that turn out smaller than expected by more than this share are refined for once more.
SURPRISE = 0.75
#: Size at the ends of a segment of the domain, as a share of its length: a short segment, or a
#: short chord of a sharply curved boundary, is a feature from which sizes grow.
FEATURE_SHARE = 1.5
LAST_ROUNDS = 8
#: How much coarser than wanted the mesh is that first finds out the sizes.
COARSE = 4.0
#: The same where few points are asked for, so that sizes may be found out with more care.
LESS_COARSE, FEW_POINTS = 2.5, 50_000


def feature_sizes(domain: Pslg) -> np.ndarray:
    """Size that the domain's shortest segment at each of its points asks for, (n,)."""
    out = np.full(len(domain.points), np.inf)
    np.minimum.at(out, domain.segments, FEATURE_SHARE * domain.lengths()[:, None])
    return out


class Sizing:
    """Keeps a refiner's sizes: exact at each vertex, growing no faster than the gradation.

    The kernel interpolates sizes at new vertices. A mesh that is to find them out is therefore
    made from coarse to fine, and after each round the exact values are put in place: the
    interpolation never spans more than an edge or two.
    """

    def __init__(
        self, refiner: Refiner, size: ResolvedSize, feature: np.ndarray, gradation: float
    ) -> None:
        self.refiner = refiner
        self.size = size
        self.gradation = gradation
        self.known = 0
        self.expected = np.inf
        domain = refiner.work.domain
        self.largest = domain.diagonal
        self.feature = feature

    def approach(self) -> bool:
        """Refine until edges are about `COARSE` times as long as wanted; False without points."""
        smallest = self.update()
        edge = 0.5 * self.largest
        while edge > COARSE * smallest:
            if not self.round(edge / smallest)[0]:
                return False
            edge *= 0.5
            smallest = self.smallest()
        if not self.settle(COARSE):
            return False
        return self.expected > FEW_POINTS or self.settle(LESS_COARSE)

    def confirm(self) -> bool:
        """Refine where exact sizes are much smaller than those refined for."""
        refiner = self.refiner
        guess = refiner.size[: refiner.work.n_points].copy()
        refiner.set_sizes()
        self._evaluate()
        # The guesses grow no faster than the gradation: nothing can spread from equal ones.
        if not (refiner.size[: len(guess)] < SURPRISE * guess).any():
            return True
        self._spread()
        return self.settle(1.0)

    def settle(self, level: float) -> bool:
        """Refine to edges `level` times as long as wanted until sizes hold no more surprises."""
        for _ in range(LAST_ROUNDS):
            finished, surprised = self.round(level)
            if not finished:
                return False
            if not surprised:
                break
        return True

    def round(self, level: float) -> tuple[bool, bool]:
        """Refine to edges `level` times as long as wanted, then put exact sizes in place.

        Returns whether the budget of points sufficed, and whether sizes turned out much smaller.
        """
        refiner = self.refiner
        self.check_budget()
        refiner.set_level(level)
        refiner.look_again()
        before = self.known
        if not refiner.run():
            return False, False
        guess = refiner.size[before : refiner.work.n_points].copy()
        self.update()
        found = refiner.size[before : refiner.work.n_points]
        return True, bool((found < SURPRISE * guess).any())

    def check_budget(self) -> None:
        """Refuse at once what cannot be done within the budget."""
        work, refiner = self.refiner.work, self.refiner
        self.expected = expected = kernels.expected_points(
            work.points,
            work.origin,
            work.twin,
            work.n_triangles,
            refiner.size,
            self.gradation,
            POINTS_PER_AREA,
        )
        if expected > OVER_BUDGET * refiner.max_points:
            at = int(np.argmin(refiner.size[: work.n_points]))
            raise BudgetError(
                f"the size asks for about {expected:.2g} points, max_points is "
                f"{refiner.max_points}; the smallest size is {refiner.size[at]:.3g} "
                f"at {work.place(at)}"
            )

    def update(self) -> float:
        """Exact sizes at new vertices, then the gradation; returns the smallest size."""
        self._evaluate()
        self._spread()
        return self.smallest()

    def _evaluate(self) -> None:
        """Exact sizes at new vertices, as if none would spread."""
        work, refiner = self.refiner.work, self.refiner
        n = work.n_points
        new = slice(self.known, n)
        points = work.points[2 * self.known : 2 * n].reshape(-1, 2)
        value = np.full(len(points), self.largest)
        size = self.size
        if size.default is not None:
            value = np.minimum(evaluate(size.default, points), self.largest)
        if size.region:
            self._regions(value)
        refiner.size[new] = value
        self.known = n
        self._boundaries()

    def smallest(self) -> float:
        """The smallest size so far."""
        return float(self.refiner.size[: self.known].min())

    def _spread(self) -> None:
        """The gradation, on periodic sides alike."""
        self._limit()
        while smaller_of_both(self.refiner):
            self._limit()

    def _limit(self) -> None:
        work = self.refiner.work
        n = work.n_points
        kernels.limit_gradation(
            work.points,
            work.origin,
            work.twin,
            work.n_triangles,
            self.refiner.size,
            self.gradation,
            np.empty(n, np.int32),
            np.empty(n, np.int32),
            np.zeros(n, np.uint8),
            np.zeros(3, np.int64),
        )

    def _regions(self, value: np.ndarray) -> None:
        """Put the sizes of regions at their new vertices; the smaller one on interfaces."""
        work = self.refiner.work
        corners = work.origin[: 4 * work.n_triangles].reshape(-1, 4)[:, :3]
        region = work.twin[: 4 * work.n_triangles].reshape(-1, 4)[:, 3]
        default = value.copy()
        value[:] = np.inf
        inside = region >= 0
        plain = inside.copy()
        for regions, source in self.size.region:
            member = np.isin(region, regions)
            plain &= ~member
            at = self._new_vertices(corners[member])
            where = work.points.reshape(-1, 2)[at + self.known]
            value[at] = np.minimum(value[at], np.minimum(evaluate(source, where), self.largest))
        at = self._new_vertices(corners[plain])
        value[at] = np.minimum(value[at], default[at])
        value[np.isinf(value)] = self.largest

    def _new_vertices(self, corners: np.ndarray) -> np.ndarray:
        among = np.zeros(self.refiner.work.n_points, bool)
        among[corners] = True
        return np.flatnonzero(among[self.known :])

    def _boundaries(self) -> None:
        """Sizes on named boundaries, and on all boundaries what their shape asks for."""
        refiner = self.refiner
        work = refiner.work
        ends = refiner.ends[: 2 * refiner.n_sub].reshape(-1, 2)
        xy = work.points.reshape(-1, 2)
        at = work.rank[: len(self.feature)]
        refiner.size[at] = np.minimum(refiner.size[at], self.feature)
        marker = work.domain.segment_marker[refiner.segments()]
        for markers, source in self.size.boundary:
            named = np.zeros(work.n_points, bool)
            named[ends[np.isin(marker, markers)]] = True
            named[work.rank[np.flatnonzero(np.isin(work.domain.point_marker, markers))]] = True
            on = np.flatnonzero(named)
            refiner.size[on] = np.minimum(refiner.size[on], evaluate(source, xy[on]))

"""The parts of a domain meshed side by side, with one budget of points for all of them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence

import numpy as np

from csgmesh.domain.input_angles import sharp_corners
from csgmesh.errors import BudgetError
from csgmesh.meshers.components import Part
from csgmesh.meshers.meshing import Meshing
from csgmesh.meshers.side_by_side import SideBySide
from csgmesh.meshers.workspace import Progress
from csgmesh.size.field import Source, UniformSize
from csgmesh.size.resolve import ResolvedSize


class Partwise:
    """One run of the mesher over several parts.

    Which mesh comes out does not depend on the number of threads, not even where the budget runs
    out: then parts are finished in their order as far as it goes.
    """

    def __init__(
        self,
        parts: Sequence[Part],
        size: ResolvedSize | None,
        limits: tuple[float, float, int],
        progress: Progress | None,
    ) -> None:
        self.parts = parts
        self.size = None if size is None else one_at_a_time(size)
        self.min_angle, self.gradation, self.max_points = limits
        self.progress = progress
        self.runs: list[Meshing] = []
        self._lock = threading.Lock()
        self._spent = 0

    def run(self, threads: int) -> bool:
        """Mesh all parts; False when the budget of points ran out."""
        crew = SideBySide([self._job(part) for part in self.parts], self.progress)
        crew.run(threads)
        left = self.max_points
        for i, part in enumerate(self.parts):
            error = crew.errors.get(i)
            if error is not None and not isinstance(error, BudgetError):
                raise error
            run = crew.results.get(i)
            if run is None and error is None:
                run = self._finished(part, self.max_points, self.progress)
            if run is None or run.work.n_points > left:
                run = self._meshing(part, left, self.progress)
                if not _finishes(run, self.size):
                    self.runs.append(run)
                    self._give_up(self.parts[i + 1 :])
                    return False
            self.runs.append(run)
            left -= run.work.n_points
        return True

    def _job(self, part: Part) -> Callable[[Progress], Meshing | None]:
        """A job that meshes a part with the whole budget, for what others take is not settled yet.

        It does nothing once more than the budget is spent: then the parts are taken in their order.
        """

        def job(tell: Progress) -> Meshing | None:
            if self._spent > self.max_points:
                return None
            run = self._finished(part, self.max_points, tell)
            if run is None:
                raise BudgetError("the budget is for all parts together")
            with self._lock:
                self._spent += run.work.n_points
            return run

        return job

    def _finished(self, part: Part, max_points: int, progress: Progress | None) -> Meshing | None:
        """The run that meshes a part, None if the points do not suffice."""
        run = self._meshing(part, max_points, progress)
        return run if _finishes(run, self.size) else None

    def _meshing(self, part: Part, max_points: int, progress: Progress | None) -> Meshing:
        limits = self.min_angle, self.gradation, max_points
        return Meshing(part.domain, sharp_corners(part.domain), limits, progress)

    def _give_up(self, parts: Sequence[Part]) -> None:
        """Triangulate the parts for which no points are left."""
        for part in parts:
            run = self._meshing(part, 0, self.progress)
            run.without_size()
            self.runs.append(run)


def _finishes(run: Meshing, size: ResolvedSize | None) -> bool:
    try:
        return run.run(size)
    except BudgetError:
        return False


def one_at_a_time(size: ResolvedSize) -> ResolvedSize:
    """The same size, whose callables no two threads are ever in: they are the user's."""
    lock = threading.Lock()

    def guarded(source: Source) -> Source:
        if isinstance(source, UniformSize):
            return source

        def value(points: np.ndarray) -> np.ndarray:
            with lock:
                return source(points)

        return value

    return ResolvedSize(
        None if size.default is None else guarded(size.default),
        tuple((markers, guarded(source)) for markers, source in size.boundary),
        tuple((regions, guarded(source)) for regions, source in size.region),
    )

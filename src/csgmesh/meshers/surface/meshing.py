"""From a `Plc` to the mesh of its boundary.

1. Curves get vertices as far apart as sizes ask; facets are split there.
2. Other vertices of the Plc are taken away, as far as sizes allow, and edges are flipped.
3. Faces are refined to the wanted sizes and angles.
4. Vertices inside faces are smoothed on their exact surfaces.

Each step changes a valid triangulation into another one, so that there is always a mesh, whatever
the faces look like: thin ones, closed ones, with hundreds of holes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh import kernels
from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.errors import BudgetError, SizeError
from csgmesh.meshers.surface.complexes import FeatureComplex, feature_complex
from csgmesh.meshers.surface.curvature import curvatures
from csgmesh.meshers.surface.curves import sample_curves
from csgmesh.meshers.surface.workpiece import Workpiece

Size = Callable[[np.ndarray], np.ndarray]
Progress = Callable[[str, int, int], None]

#: Longest edge as a share of the radius of curvature: about eight edges a turn, with fewer the
#: triangles of a tube would no longer look like it.
BEND = 0.8
#: Rounds of taking vertices away, at most.
_ROUNDS = 8
_SMOOTHINGS = 4
#: Passes of flips before vertices are taken away, at most, and flips in proportion to triangles
#: below which no other pass is needed.
_PASSES = 200
_SETTLED = 0.01
#: Triangles or vertices that one call of a kernel treats: less than 0.2 s.
_SLICE = 20_000
#: The kernel may add so many points before sizes are asked for again, at least.
_FEWEST = 5_000


def surface_mesh(
    plc: Plc,
    size: Size,
    *,
    min_angle: float = 25.0,
    max_points: int = 10**7,
    progress: Progress | None = None,
) -> SurfaceMesh:
    """Mesh the boundary of a solid.

    Parameters
    ----------
    plc : Plc
    size : callable
        Wanted edge length at points (n, 3), as (n,), positive.
    min_angle : float
        In degrees; refinement goes on until angles are as large, but for those that sharp corners
        of the faces enforce.
    max_points : int
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    Returns
    -------
    SurfaceMesh

    Raises
    ------
    BudgetError
        If `max_points` do not suffice.
    SizeError
        If sizes are not positive.

    Examples
    --------
    >>> import csgmesh as cm
    >>> plc = cm.evaluate(cm.Ball((0, 0, 0), 1))
    >>> mesh = surface_mesh(plc, lambda points: np.full(len(points), 0.5))
    >>> bool(abs(np.linalg.norm(mesh.points, axis=1) - 1).max() < 1e-12)
    True
    """
    run = _Run(plc, _checked(size), min_angle, max_points, progress)
    run.put_samples()
    run.coarsen()
    run.refine()
    run.smooth()
    if run.has_unwanted():
        run.coarsen()
    # Smoothed stars leave room where there was none.
    before = run.work.n_points
    run.refine()
    if run.work.n_points > before:
        run.smooth(1)
    run.divide_repeated()
    return run.result()


def _checked(size: Size) -> Size:
    def sizes(points: np.ndarray) -> np.ndarray:
        h = np.asarray(size(points), float)
        if h.shape != (len(points),) or not (np.isfinite(h).all() and (h > 0.0).all()):
            raise SizeError("the size must be positive and finite everywhere on the boundary")
        return h

    return sizes


class _Run:
    """One surface on its way."""

    def __init__(
        self,
        plc: Plc,
        size: Size,
        min_angle: float,
        max_points: int,
        progress: Progress | None,
    ) -> None:
        self.plc, self.size, self.max_points, self.progress = plc, size, max_points, progress
        self.parts: FeatureComplex = feature_complex(plc)
        bend = curvatures(plc, self.parts)
        with np.errstate(divide="ignore"):
            self.cap = np.minimum(BEND / bend, plc.diagonal)
        self.work = Workpiece(plc, self.parts, np.minimum(size(plc.points), self.cap), self.cap)
        cosine = np.cos(np.radians(min_angle))
        self.share = 0.5 / np.sin(np.radians(min_angle)) if min_angle > 0 else np.inf
        self.off = 0.475 * np.sqrt((1.0 + cosine) / (1.0 - cosine)) if min_angle > 0 else np.inf

    def put_samples(self) -> None:
        """Split the facets at the curves' new vertices."""
        samples = sample_curves(self.plc, self.parts, self.size, self.cap)
        work = self.work
        n = len(samples.points)
        sheets = np.bincount(-1 - self.parts.twin[self.parts.twin < 0], minlength=1).max()
        work.reserve(n + 2, (n + 2) * int(sheets), n + 2)
        work.a["keep"][samples.kept] = 1
        size = self.size(samples.points) if n else np.zeros(0)
        for start in range(0, n, _SLICE):
            stop = min(start + _SLICE, n)
            kernels.insert_samples(work.arrays, samples.segment, samples.points, size, start, stop)
            self._report("curves", stop, n)
        caps = work.a["cap"]
        sizes = work.a["size"]
        sizes[: work.n_points] = np.minimum(sizes, caps)[: work.n_points]

    def coarsen(self) -> None:
        """Take away vertices that are not wanted, and flip, until nothing changes."""
        work = self.work
        # Across a thin face the samples of its curves are fans at first, which one pass turns
        # only so far.
        for _ in range(_PASSES):
            if self._flip(True) <= _SETTLED * work.n_triangles:
                break
        for _ in range(_ROUNDS):
            taken = 0
            for dim in (1, 2):
                own = sum(
                    kernels.take_vertices(work.arrays, start, stop, dim)
                    for start, stop in _slices(work.n_points)
                )
                if own:
                    self._flip(True)
                taken += own
            if not taken:
                break

    def _flip(self, exact: bool) -> int:
        arrays = self.work.arrays
        return sum(
            kernels.flip_surface(arrays, max(start, 1), stop, exact)
            for start, stop in _slices(self.work.n_triangles)
        )

    def refine(self) -> None:
        """Insert points until sizes and angles are right."""
        work = self.work
        living = work.living()
        work.reserve(_FEWEST, 2 * _FEWEST, _FEWEST)
        # Fronts start from curves.
        on_curve = (work.a["twin"].reshape(-1, 4)[living, :3] < 0).any(axis=1)
        work.enqueue(np.concatenate([living[on_curve], living[~on_curve]]))
        known = work.n_points
        while True:
            limit = min(known + max(_FEWEST, known // 2), self.max_points)
            status = kernels.refine_surface(work.arrays, self.share, self.off, limit)
            known = self._ask_sizes(known)
            self._report("faces", known, self.max_points)
            if status == 1:
                work.reserve(known + _FEWEST, 2 * known + 2 * _FEWEST, known // 2 + _FEWEST)
            elif status == 0 and not work.a["count"][4]:
                return
            elif known >= self.max_points:
                raise BudgetError(
                    f"max_points = {self.max_points} do not suffice for the wanted sizes",
                    self._mesh(),
                )

    def _ask_sizes(self, known: int) -> int:
        """Ask for the sizes of vertices from `known` on, and look again where they shrank."""
        work = self.work
        n = work.n_points
        if n == known:
            return n
        a = work.a
        found = np.minimum(self.size(work.points()[known:n]), a["cap"][known:n])
        shrunk = found < 0.9 * a["size"][known:n]
        a["size"][known:n] = found
        if shrunk.any():
            living = work.living()
            around = np.zeros(n, bool)
            around[known:n] = shrunk
            work.enqueue(living[around[work.corners(living)].any(axis=1)])
        return n

    def smooth(self, times: int = _SMOOTHINGS) -> None:
        """Smooth and flip in turn."""
        work = self.work
        for _ in range(times):
            for start, stop in _slices(work.n_points):
                kernels.smooth_surface(work.arrays, start, stop)
            self._flip(False)

    def has_unwanted(self) -> bool:
        """Whether vertices of curves are left that could not be taken away before."""
        a, n = self.work.a, self.work.n_points
        return bool(((a["dim"][:n] == 1) & (a["keep"][:n] == 0)).any())

    def divide_repeated(self) -> None:
        """Divide all but one of the edges with the same two ends, which thin faces have."""
        work = self.work
        for _ in range(_ROUNDS):
            number, is_segment = work.repeated()
            if not len(number):
                return
            n = len(number)
            work.reserve(n + 2, 64 * (n + 2), n + 2)
            known = work.n_points
            kernels.divide_edges(work.arrays, number, is_segment)
            self._ask_sizes(known)

    def result(self) -> SurfaceMesh:
        """The mesh, without gaps in its numbers."""
        return self._mesh()

    def _mesh(self) -> SurfaceMesh:
        work, parts = self.work, self.parts
        n = work.n_points
        living = work.living()
        triangles = work.corners(living)
        seg = work.a["seg"][: 4 * work.n_segments].reshape(-1, 4).astype(np.int64)
        seg = seg[seg[:, 0] >= 0]
        used = np.flatnonzero(work.a["dim"][:n] >= 0)
        number = np.full(n, -1)
        number[used] = np.arange(len(used))
        return SurfaceMesh(
            work.points()[used].copy(),
            number[triangles],
            work.a["origin"].reshape(-1, 4)[living, 3].astype(np.int64),
            parts.face_surface,
            parts.face_marker,
            parts.face_region,
            number[seg[:, :2]],
            seg[:, 2],
            parts.curve_surfaces,
            work.a["dim"][used].copy(),
            work.a["owner"][used].astype(np.int64),
            self.plc,
        )

    def _report(self, stage: str, done: int, total: int) -> None:
        if self.progress is not None:
            self.progress(stage, done, total)


def _slices(n: int) -> list[tuple[int, int]]:
    return [(start, min(start + _SLICE, n)) for start in range(0, n, _SLICE)]

"""The verb `adapt`: mesh, solve, look at the solution, mesh again."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.adaptivity.marking import doerfler
from csgmesh.boundary import evaluate
from csgmesh.errors import InputError
from csgmesh.improve import refine
from csgmesh.options import check_choice
from csgmesh.pipeline import Mesher, Progress, default_mesher
from csgmesh.size.background import on_mesh
from csgmesh.size.hessian import NORMS, HessianSize, nodal_values
from csgmesh.size.recovery import cell_errors, recovered_hessians, total_error

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg
    from csgmesh.mesh import Mesh

Indicator = Callable[["Mesh", np.ndarray], Any]

#: Cells grow by no more than this factor from one step to the next: what a coarse mesh tells of
#: the solution is not worth following further.
_STRIDE = 4.0
#: Within this share of the budget of cells there is nothing left to gain by another step.
_SPENT = 0.9
#: A mesh made for an error is allowed to be better than that by this share.
_AIM = 0.95


@dataclass(frozen=True)
class AdaptationStep:
    """One mesh of an adaptation.

    Attributes
    ----------
    cells, points : int
        How many the mesh has.
    error : float
        Estimated error of the solution on it.
    time : float
        Seconds that the step took: meshing, solving, estimating.
    """

    cells: int
    points: int
    error: float
    time: float


@dataclass(frozen=True, eq=False, repr=False)
class Adaptation:
    """What `adapt` found; printed, a table with a line a step.

    Attributes
    ----------
    mesh : Mesh
        The last mesh.
    values : (n_points,) float64
        The solution on it.
    steps : tuple of AdaptationStep
    norm : str
        Of the errors.
    reached : bool
        Whether the error, or the budget of cells, was reached within the steps allowed.
    """

    mesh: Mesh
    values: np.ndarray
    steps: tuple[AdaptationStep, ...]
    norm: str
    reached: bool

    def __repr__(self) -> str:
        last = self.steps[-1]
        return (
            f"<Adaptation: {len(self.steps)} steps to {last.cells:,} cells, "
            f"{self.norm} error about {last.error:.3g}>"
        )

    def __str__(self) -> str:
        rows = [f"{'step':>4}{'cells':>12}{'points':>12}{self.norm + ' error':>14}{'seconds':>10}"]
        rows += [
            f"{k:>4}{s.cells:>12,}{s.points:>12,}{s.error:>14.3e}{s.time:>10.2f}"
            for k, s in enumerate(self.steps)
        ]
        return "\n".join(rows)


def adapt(
    shape: Any,
    solve: Callable[..., Any],
    mesher: Mesher | None = None,
    size: Any = None,
    *,
    error: float | None = None,
    cells: int | None = None,
    norm: str = "L2",
    steps: int = 12,
    lo: float | None = None,
    hi: float | None = None,
    gradation: float | None = None,
    indicator: Indicator | None = None,
    share: float = 0.5,
    deviation: float | None = None,
    snap: float | None = None,
    progress: Progress | None = None,
) -> Adaptation:
    """Mesh, solve, and mesh again where the solution bends, until its error is small.

    From each solution the size of the next mesh follows (`HessianSize`), or, with an `indicator`,
    which cells are refined. Names, regions and exact curves are those of the shape throughout.
    Triangles stay as equilateral as the mesher makes them: anisotropy is out of scope.

    Parameters
    ----------
    shape : Shape, Regions, Embed or Pslg
        What to mesh.
    solve : callable
        ``solve(mesh) -> (n_points,)``, the solution at the points of a mesh of triangles. One that
        has a parameter ``start`` is given the last solution interpolated to the new mesh, None in
        the first step.
    mesher : object with ``generate``, optional
        How: `DelaunayRefinement` unless given.
    size : float, mapping, callable or SizeField, optional
        Of the first mesh.
    error : float, optional
        Estimated error at which to end.
    cells : int, optional
        Cells at which to end; without `error` the loop goes on until they are used.
    norm : {"L2", "H1", "max"}
        In which the error is small; ``"H1"`` is the L² norm of the gradient's error.
    steps : int, default 12
        Meshes made at most.
    lo, hi : float, optional
        Bounds of the size.
    gradation : float, optional
        Bound on its growth; default that of the mesher, or 0.3.
    indicator : callable, optional
        ``indicator(mesh, values) -> (n_cells,)``, the error that each cell contributes; their root
        of the sum of squares is the error. Cells are then marked after Dörfler and refined.
    share : float, default 0.5
        Share of the squared error that the marked cells have together.
    deviation, snap : float, optional
        As of `generate`.
    progress : callable, optional
        Called as ``progress(stage, done, total)`` while meshing.

    Returns
    -------
    Adaptation
        ``.mesh``, ``.values``, ``.steps``; printing it shows a table.

    Raises
    ------
    InputError
        If neither an error nor cells are given, or an argument is out of range.
    SizeError
        If `solve` does not return one finite number a point.

    References
    ----------
    .. [1] W. Dörfler, "A convergent adaptive algorithm for Poisson's equation", SIAM J. Numerical
       Analysis 33 (1996).

    Examples
    --------
    >>> import csgmesh as cm
    >>> def peak(mesh):
    ...     return 1 / (0.01 + ((mesh.points - 0.3) ** 2).sum(axis=1))
    >>> found = cm.adapt(cm.Box((0, 0), (1, 1)), peak, size=0.1, cells=2000)
    >>> found.reached, 1800 < found.mesh.n_cells < 2200
    (True, True)
    """
    _check(error, cells, norm, steps, share)
    run = _Run(
        evaluate(shape, deviation=deviation, snap=snap), solve, default_mesher(mesher), progress
    )
    run.bounds = {"norm": norm, "lo": lo, "hi": hi}
    run.bounds["gradation"] = gradation or getattr(run.mesher, "gradation", 0.3)
    run.indicator, run.share = indicator, share
    mesh = run.meshed(size)
    while True:
        errors = run.step(mesh)
        last = run.records[-1]
        spent = cells is not None and last.cells >= _SPENT * cells
        # The best mesh for a budget is made from a solution on about as many cells.
        spent = spent and (indicator is not None or run.is_settled())
        reached = spent if error is None else last.error <= error
        if reached or spent or len(run.records) == steps:
            return Adaptation(run.mesh, run.values, tuple(run.records), norm, reached)
        mesh = run.refined(errors) if indicator is not None else run.remeshed(error, cells)


def _check(error: Any, cells: Any, norm: str, steps: Any, share: Any) -> None:
    check_choice("norm", norm, NORMS, "adapt")
    if error is None and cells is None:
        raise InputError("adapt: give the error wanted, the cells to be used, or both")
    for name, value in (("error", error), ("cells", cells), ("steps", steps)):
        if value is not None and not value > 0:
            raise InputError(f"adapt: {name} must be positive; got {value!r}")
    if not 0 < share <= 1:
        raise InputError(f"adapt: share must be between 0 and 1; got {share!r}")


class _Run:
    """One adaptation: the mesh and solution so far."""

    mesh: Mesh
    values: np.ndarray
    indicator: Indicator | None
    share: float
    bounds: dict[str, Any]

    def __init__(
        self, domain: Pslg, solve: Callable[..., Any], mesher: Mesher, progress: Progress | None
    ) -> None:
        self.domain, self.solve, self.mesher, self.progress = domain, solve, mesher, progress
        self.takes_start = "start" in inspect.signature(solve).parameters
        self.start: Callable[[np.ndarray], np.ndarray] | None = None
        self.records: list[AdaptationStep] = []
        self.since = time.perf_counter()
        # What the last mesh was made for, and how much more its error and its cells came to.
        self.expected: float | None = None
        self.surplus = 1.0
        self.asked: float | None = None
        self.crowding = 1.0

    def meshed(self, size: Any) -> Mesh:
        """The domain meshed with a size."""
        return self.mesher.generate(self.domain, size, self.progress)

    def step(self, mesh: Mesh) -> np.ndarray:
        """Solve on a mesh and estimate the errors of its cells."""
        if self.takes_start:
            start = None if self.start is None else self.start(mesh.points)
            found = self.solve(mesh, start=start)
        else:
            found = self.solve(mesh)
        self.mesh, self.values = mesh, nodal_values(mesh, found, "adapt")
        self.start = on_mesh(mesh, self.values)
        norm = self.bounds["norm"]
        if self.indicator is not None:
            errors = np.asarray(self.indicator(mesh, self.values), float)
            if errors.shape != (mesh.n_cells,) or not (errors >= 0).all():
                raise InputError(
                    "adapt: indicator must return one error a cell, none negative, shape "
                    f"({mesh.n_cells},); got shape {errors.shape}"
                )
        else:
            errors = cell_errors(mesh, recovered_hessians(mesh, self.values), norm)
        total = total_error(errors, norm)
        if self.expected:
            self.surplus = float(np.clip(total / self.expected, 1.0, 4.0))
        if self.asked:
            self.crowding = float(np.clip(mesh.n_cells / self.asked, 0.7, 1.4))
        now = time.perf_counter()
        self.records.append(AdaptationStep(mesh.n_cells, mesh.n_points, total, now - self.since))
        self.since = now
        return errors

    def is_settled(self) -> bool:
        """Whether the step before the last had about as many cells."""
        return len(self.records) > 1 and self.records[-2].cells >= _SPENT * self.records[-1].cells

    def remeshed(self, error: float | None, cells: int | None) -> Mesh:
        """The next mesh: for the error, for the cells, or as far as the last solution carries."""
        most = int(_STRIDE * self.mesh.n_cells)
        if cells is not None:
            most = min(most, cells)
        most = max(1, int(most / self.crowding))
        self.expected, wanted = None, None
        if error is not None:
            aim = _AIM * error / self.surplus
            wanted = HessianSize(self.mesh, self.values, error=aim, **self.bounds)
            self.expected = aim
        if wanted is None or wanted.expected_cells() > most:
            wanted = HessianSize(self.mesh, self.values, cells=most, **self.bounds)
            self.expected = None
        self.asked = wanted.expected_cells()
        return self.meshed(wanted)

    def refined(self, errors: np.ndarray) -> Mesh:
        """The mesh with the cells of the largest errors refined."""
        return refine(self.mesh, doerfler(errors, self.share))

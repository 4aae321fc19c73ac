"""The verb `generate_to_budget`: scale a size until the mesh has the cells wanted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.boundary import evaluate
from csgmesh.errors import BudgetError, InputError
from csgmesh.pipeline import Mesher, Progress, default_mesher
from csgmesh.size import minimum, pointwise
from csgmesh.size.combinations import as_field
from csgmesh.size.hessian import CELLS_PER_AREA

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg
    from csgmesh.mesh import Mesh

#: Cells above which a trial is broken off, as a multiple of those wanted.
_TOO_MANY = 4
_TRIALS = 24
#: The first trial is meant to have this share of the cells wanted: fewer cost less.
_FIRST = 0.25
#: Points in the domain's box at which the size is looked at to choose the first trial.
_LOOKS = 4096
#: No trial changes the size by more than this factor at a time.
_STRIDE = 8.0
#: Counts of cells are whole, so that few of them cannot always be met to a share.
_WHOLE = 2


def generate_to_budget(
    shape: Any,
    mesher: Mesher | None = None,
    size: Any = None,
    *,
    cells: int,
    tolerance: float = 0.05,
    keep: Any = None,
    deviation: float | None = None,
    snap: float | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """Mesh a shape with a given number of cells, by scaling a size.

    The size is multiplied by one factor, which a few meshings find; the ratio of the sizes at any
    two places stays what it is.

    Parameters
    ----------
    shape : Shape, Regions, Embed or Pslg
        What to mesh.
    mesher : object with ``generate``, optional
        How: `DelaunayRefinement` unless given.
    size : float, mapping, callable or SizeField, optional
        Size to be scaled; the same everywhere unless given.
    cells : int
        Cells wanted.
    tolerance : float, default 0.05
        Largest difference allowed, as a share of `cells`; two cells where that is more.
    keep : float, mapping, callable or SizeField, optional
        A size that is not scaled: the mesh is nowhere coarser, whatever the budget.
    deviation, snap : float, optional
        As of `generate`.
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    Returns
    -------
    Mesh

    Raises
    ------
    InputError
        If `cells` is not positive or the tolerance not between 0 and 1.
    BudgetError
        If the features of the shape, the angle bound or `keep` ask for more cells, with the mesh
        that has the fewest; or if no factor was found.

    Examples
    --------
    >>> import csgmesh as cm
    >>> plate = cm.Box((0, 0), (4, 2)) - cm.Disk((2, 1), 0.5, name="hole")
    >>> mesh = cm.generate_to_budget(plate, size={"hole": 1, "default": 4}, cells=2000)
    >>> 1900 <= mesh.n_cells <= 2100
    True
    """
    if isinstance(cells, bool) or not isinstance(cells, (int, np.integer)) or cells < 1:
        raise InputError(f"cells must be a positive whole number; got {cells!r}")
    if not 0 < tolerance < 1:
        raise InputError(f"tolerance must be between 0 and 1; got {tolerance!r}")
    domain = evaluate(shape, deviation=deviation, snap=snap)
    if domain.dim != 2:
        raise InputError("generate_to_budget meshes domains in the plane; this one lies in space")
    search = _Search(domain, default_mesher(mesher), 1.0 if size is None else size, keep, progress)
    return search.run(int(cells), max(tolerance * cells, _WHOLE))


class _Search:
    """Meshes of one domain by the factor of their size."""

    def __init__(
        self, domain: Pslg, mesher: Mesher, size: Any, keep: Any, progress: Progress | None
    ) -> None:
        self.domain, self.mesher, self.progress = domain, mesher, progress
        self.size, self.keep = size, keep

    def run(self, cells: int, allowed: float) -> Mesh:
        """The mesh with about `cells` cells."""
        log = self._first(cells)
        fine: tuple[float, float] | None = None
        coarse: tuple[float, float] | None = None
        for _ in range(_TRIALS):
            mesh, count = self._trial(np.exp(log), cells)
            if mesh is not None and abs(count - cells) <= allowed:
                return mesh
            if count > cells:
                if mesh is not None and self._is_loose(np.exp(log)):
                    raise BudgetError(
                        f"{cells} cells are too few: the features of the shape and what is to be "
                        f"kept need about {count}",
                        mesh,
                    )
                fine = log, np.log(count / cells)
            else:
                coarse = log, np.log(count / cells)
            log = _next(fine, coarse)
        raise BudgetError(
            f"no size was found that gives {cells} cells; the last gave {count}", mesh
        )

    def _trial(self, factor: float, cells: int) -> tuple[Mesh | None, int]:
        """The mesh by a factor, and its cells; none where there would be far too many."""
        size = scaled(self.size, factor)
        if self.keep is not None:
            size = minimum(self.keep, size)
        mesher: Any = self.mesher
        most = max(_TOO_MANY * cells, 1000)
        known = is_dataclass(mesher) and "max_points" in {f.name for f in fields(mesher)}
        if known and most < mesher.max_points and not self._is_loose(factor):
            mesher = replace(mesher, max_points=most)
        try:
            mesh = mesher.generate(self.domain, size, self.progress)
        except BudgetError:
            if mesher is self.mesher:
                raise
            return None, most
        return mesh, mesh.n_cells

    def _is_loose(self, factor: float) -> bool:
        """Whether the scaled size is so large that it asks for nothing any more."""
        return factor * self.smallest >= self.domain.diagonal

    def _first(self, cells: int) -> float:
        """Logarithm of a factor with which to start."""
        domain = self.domain
        lo, hi = domain.bounds()
        side = int(np.sqrt(_LOOKS))
        grid = (np.indices((side, side)).reshape(2, -1).T + 0.5) / side
        points = lo + grid * (hi - lo)
        if domain.oracle is not None:
            points = points[domain.oracle.region(points) >= 0]
        h = pointwise(self.size, domain)
        known = np.concatenate([h(points), h(domain.points)])
        self.smallest = float(known.min())
        inside = known[: len(points)] if len(points) else known
        expected = CELLS_PER_AREA * float(domain.areas().sum()) * float((inside**-2.0).mean())
        return 0.5 * float(np.log(expected / (_FIRST * cells)))


def _next(fine: tuple[float, float] | None, coarse: tuple[float, float] | None) -> float:
    """Where to try next, from logarithms of factors with too many and with too few cells."""
    if fine is not None and coarse is not None:
        (a, over), (b, under) = fine, coarse
        # Between both, where a straight line says; not too near to either, lest it should creep.
        share = np.clip(over / (over - under), 0.1, 0.9)
        return float(a + share * (b - a))
    log, off = (fine or coarse) or (0.0, 0.0)
    # Cells go as the inverse square of the size.
    change = np.clip(0.5 * off, -np.log(_STRIDE), np.log(_STRIDE))
    return float(log + change + np.sign(change) * 0.02)


def scaled(size: Any, factor: float) -> Any:
    """A size times a number, whatever it is.

    Examples
    --------
    >>> scaled({"hole": 0.1, "default": 0.5}, 2.0)
    {'hole': UniformSize(value=0.2), 'default': UniformSize(value=1.0)}
    """
    from csgmesh.size import UniformSize

    if isinstance(size, Mapping):
        return {name: scaled(value, factor) for name, value in size.items()}
    field = as_field(size, "size")
    if isinstance(field, UniformSize):
        return UniformSize(field.value * factor)
    return field * factor

"""A size by the second derivatives of a solution."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import SizeError
from csgmesh.mesh import Mesh
from csgmesh.options import check_choice
from csgmesh.size.background import BackgroundSize, cell_edges
from csgmesh.size.field import SizeField, Source, positive
from csgmesh.size.gradation import limit_gradation
from csgmesh.size.near import GRADATION
from csgmesh.size.recovery import largest_modulus, recovered_hessians

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg

#: Norms in which errors are measured.
NORMS = ("L2", "H1", "max")
#: The size is proportional to this power of the largest modulus of an eigenvalue.
_POWER = {"L2": -1 / 3, "H1": -1 / 2, "max": -1 / 2}
#: The error's square per area is this power of the size times a form in the eigenvalues.
_ORDER = {"L2": 4, "H1": 2}
#: Cells per area of a triangulation of edge length 1.
CELLS_PER_AREA = 4.0 / np.sqrt(3.0)
#: Where the solution is linear any size will do: this share of the largest second derivative, and
#: less, counts as none.
_FLAT = 1e-12
_HALVINGS = 50


@dataclass(frozen=True, eq=False)
class HessianSize(SizeField):
    """The size at which linear elements have the error wanted, or as small as cells allow.

    The interpolation error of a linear element of size h is as h² times the second derivatives.
    For given cells the error is least when each contributes the same share: h is proportional to
    the power -1/3 of the largest modulus λ of the Hessian's eigenvalues for the mean square error
    (in L^p it is -p / (2p + 2)), to the reciprocal square root of λ for that of the gradient and
    for the largest error. Triangles are meant to be equilateral: anisotropy is out of scope.

    Parameters
    ----------
    mesh : Mesh
        Of triangles, on which the solution is known.
    values : array_like (n_points,)
        The solution at its points.
    error : float, optional
        Interpolation error wanted in the whole domain.
    cells : int, optional
        Triangles wanted; either this or `error`.
    norm : {"L2", "H1", "max"}
        Of the error: ``"H1"`` is the L² norm of the gradient's error.
    lo, hi : float, optional
        Bounds of the size. Default: none, and a quarter of the domain's diagonal.
    gradation : float, default 0.3
        Bound on the growth of the size per unit of length.

    Raises
    ------
    SizeError
        If the mesh has other cells than triangles, the values do not fit, or not exactly one of
        `error` and `cells` is given.

    Attributes
    ----------
    sizes : (n_points,) float64
        The size at the points of the mesh, within its bounds and with its gradation.

    References
    ----------
    .. [1] P. J. Frey, F. Alauzet, "Anisotropic mesh adaptation for CFD computations", Computer
       Methods in Applied Mechanics and Engineering 194 (2005).
    .. [2] A. Loseille, F. Alauzet, "Continuous mesh framework", SIAM J. Numerical Analysis 49
       (2011).

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0), (1, 1)), size=0.05)
    >>> bump = np.exp(-100 * ((mesh.points - 0.5) ** 2).sum(axis=1))
    >>> size = cm.HessianSize(mesh, bump, cells=2000)
    >>> adapted = cm.generate(cm.Box((0, 0), (1, 1)), size=size)
    >>> bool(abs(adapted.n_cells - 2000) < 300)
    True
    """

    mesh: Mesh
    values: Any
    error: float | None = None
    cells: int | None = None
    norm: str = "L2"
    lo: float | None = None
    hi: float | None = None
    gradation: float = GRADATION
    sizes: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        values = nodal_values(self.mesh, self.values, "HessianSize")
        object.__setattr__(self, "values", values)
        check_choice("norm", self.norm, NORMS, "HessianSize")
        if (self.error is None) == (self.cells is None):
            raise SizeError("HessianSize: give either the error or the cells wanted, not both")
        for name in ("error", "cells", "lo", "hi", "gradation"):
            if getattr(self, name) is not None:
                positive(getattr(self, name), f"HessianSize: {name}")
        hessians = recovered_hessians(self.mesh, values)
        object.__setattr__(self, "sizes", self._sizes(hessians))

    def bind(self, domain: Pslg) -> Source:
        """The sizes interpolated, which do not depend on the domain."""
        return BackgroundSize(self.mesh, self.sizes).bind(domain)

    def expected_cells(self) -> float:
        """How many triangles the size asks for."""
        return CELLS_PER_AREA * float((_areas(self.mesh) / self.sizes**2).sum())

    def _sizes(self, hessians: np.ndarray) -> np.ndarray:
        points = self.mesh.points
        diagonal = float(np.hypot(*(points.max(axis=0) - points.min(axis=0))))
        largest = largest_modulus(hessians)
        shape = np.maximum(largest, max(_FLAT * float(largest.max()), 1e-300)) ** _POWER[self.norm]
        edges = cell_edges(self.mesh)[0]
        lo, hi = self.lo or 0.0, self.hi or 0.25 * diagonal
        form = _form(hessians, largest, self.norm)
        weight = _areas(self.mesh)

        def sized(scale: float) -> np.ndarray:
            h = np.clip(scale * shape, lo, hi)
            return limit_gradation(points, edges, h, self.gradation)

        def is_too_coarse(h: np.ndarray) -> bool:
            if self.cells is not None:
                return CELLS_PER_AREA * float((weight / h**2).sum()) < self.cells
            if self.norm == "max":
                return float((form * h**2).max()) > float(self.error or 0)
            found = float((weight * form * h ** _ORDER[self.norm]).sum())
            return found > float(self.error or 0) ** 2

        # All cells are as large as can be at the one end, and smaller than any mesh's at the other.
        low, high = np.log(1e-9 * diagonal / shape.max()), np.log(hi / shape.min())
        if not is_too_coarse(sized(np.exp(high))):
            return sized(np.exp(high))
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if is_too_coarse(sized(np.exp(middle))):
                high = middle
            else:
                low = middle
            if high - low < 1e-4:
                break
        return sized(np.exp(low))


def nodal_values(mesh: Any, values: Any, what: str) -> np.ndarray:
    """Values at the points of a mesh of triangles, checked.

    Raises
    ------
    SizeError
        If the mesh is no plane mesh of triangles, or the values are not one real number a point.
    """
    if not isinstance(mesh, Mesh) or list(mesh.cells) != ["triangle"]:
        kinds = ", ".join(mesh.cells) if isinstance(mesh, Mesh) else type(mesh).__name__
        raise SizeError(f"{what} needs a mesh of triangles; got {kinds}")
    try:
        out = np.array(values, float)
    except (TypeError, ValueError):
        raise SizeError(f"{what}: values must be real numbers") from None
    if out.shape != (mesh.n_points,) or not np.isfinite(out).all():
        raise SizeError(
            f"{what}: values must be one finite number a point of the mesh, shape "
            f"({mesh.n_points},); got shape {out.shape}"
        )
    out.flags.writeable = False
    return out


def _areas(mesh: Mesh) -> np.ndarray:
    """A third of the area of its triangles at each vertex, (n_points,)."""
    corners = mesh.cells["triangle"]
    a, b, c = (mesh.points[corners[:, k]] for k in range(3))
    area = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    return np.bincount(corners.ravel(), np.repeat(area / 3, 3), mesh.n_points)


def _form(hessians: np.ndarray, largest: np.ndarray, norm: str) -> np.ndarray:
    """Squared error per area of equilateral triangles of edge length 1, whichever way they lie.

    From integrating (u - Iu)² and |∇(u - Iu)|² of a quadratic u over an equilateral triangle. The
    largest error is taken as if both eigenvalues were the larger one.
    """
    xx, xy, yy = hessians.T
    trace, spread = (xx + yy) ** 2, (xx - yy) ** 2 + 4 * xy**2
    if norm == "L2":
        return trace / 240 + spread / 1920
    if norm == "H1":
        return trace / 48 + spread / 24
    return largest / 6

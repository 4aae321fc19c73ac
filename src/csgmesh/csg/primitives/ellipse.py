"""Ellipses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from csgmesh.csg import checks, matrices
from csgmesh.csg.primitive import Frame, Planar
from csgmesh.domain.curves import ARC, Curves

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


_FOUR_ARCS = np.full(4, ARC, np.int8)
_QUARTERS = np.arange(4)[:, None] * (np.pi / 2) + np.array([0.0, np.pi / 2])
_QUARTERS[:-1, 1] = _QUARTERS[1:, 0]
for _shared in (_FOUR_ARCS, _QUARTERS):
    _shared.flags.writeable = False


def quarter_arcs(center: np.ndarray, u: np.ndarray, v: np.ndarray) -> Curves:
    """The whole ellipse ``center + cos(t) u + sin(t) v`` as four arcs cut at multiples of π/2."""
    data = np.zeros((4, 8))
    data[:, 0:2], data[:, 2:4], data[:, 4:6] = center, u, v
    return Curves(_FOUR_ARCS, data, _QUARTERS)


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Ellipse(Planar):
    """An ellipse.

    Its boundary is a single part.

    Parameters
    ----------
    center : (2,) float
    semi_axes : (2,) float
        Half its lengths along its own first and second axis, positive.
    angle : float
        Degrees from the x axis to its first axis, counterclockwise.
    name : str, optional
        Default ``"ellipse"``.

    Raises
    ------
    ShapeError
        If a semi-axis is not positive and finite.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.Ellipse((0, 0), (2, 1), angle=90).bounds()
    (array([-1., -2.]), array([1., 2.]))
    """

    center: tuple[float, ...]
    semi_axes: tuple[float, ...]
    angle: float = 0.0

    kind: ClassVar[str] = "ellipse"
    convex: ClassVar[bool] = True
    simple: ClassVar[bool] = True

    def __init__(
        self,
        center: ArrayLike,
        semi_axes: ArrayLike,
        angle: float = 0.0,
        *,
        name: str | None = None,
    ) -> None:
        where = self.place(name)
        axes = checks.vector(semi_axes, "semi_axes", where, 2)
        for axis in axes:
            checks.positive(axis, "each of semi_axes", where)
        self._settle(
            name,
            center=checks.vector(center, "center", where, 2),
            semi_axes=axes,
            angle=checks.number(angle, "angle", where),
        )

    def _axes(self) -> tuple[np.ndarray, np.ndarray]:
        c, s = matrices.cos_sin(self.angle)
        a, b = self.semi_axes
        return np.array((a * c, a * s)), np.array((-b * s, b * c))

    def curves(self) -> tuple[Curves, np.ndarray]:
        return quarter_arcs(np.array(self.center), *self._axes()), np.zeros(4, np.int64)

    def unit_frame(self) -> Frame:
        c, s = matrices.cos_sin(self.angle)
        a, b = self.semi_axes
        return Frame("ball", np.array(self.center), np.array([(c / a, s / a), (-s / b, c / b)]))

    def inside(self, points: np.ndarray) -> np.ndarray:
        c, s = matrices.cos_sin(self.angle)
        x, y = points[:, 0] - self.center[0], points[:, 1] - self.center[1]
        along = (c * x + s * y) / self.semi_axes[0]
        across = (c * y - s * x) / self.semi_axes[1]
        return along * along + across * across <= 1.0

    def extent(self, matrix: np.ndarray, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        u, v = self._axes()
        middle = matrix @ self.center + offset
        reach = np.hypot(matrix @ u, matrix @ v)
        return middle - reach, middle + reach

"""Size fields: the wanted edge length as a function of place."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import SizeError
from csgmesh.options import as_real
from csgmesh.tolerance import LARGEST, SMALLEST

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg

#: Wanted edge lengths (n,) at points (n, dim).
Source = Callable[[np.ndarray], np.ndarray]


class SizeField(ABC):
    """The wanted edge length as a function of place, perhaps of the domain.

    A field is a value: it says what is wanted, and `bind` makes it a function of points once the
    domain is known, with its names, regions and curves. Fields combine, with one another, with
    numbers and with callables: ``cm.minimum(a, b)``, ``a * 2``, ``a / 2``, ``a * b``,
    ``a.clamp(lo, hi)``.

    Examples
    --------
    >>> import csgmesh as cm
    >>> wanted = cm.minimum(cm.NearSize("hole", 0.02), 0.2) * 2
    >>> plate = cm.Box((0, 0), (4, 2)) - cm.Disk((2, 1), 0.5, name="hole")
    >>> h = wanted.bind(cm.evaluate(plate))
    >>> h(np.array([[2.5, 1.0], [0.0, 0.0]])).round(6)
    array([0.04, 0.4 ])
    """

    @abstractmethod
    def bind(self, domain: Pslg) -> Source:
        """The field on a domain: wanted edge lengths (n,) as a function of points (n, dim)."""

    def __mul__(self, other: Any) -> SizeField:
        from csgmesh.size.combinations import ProductSize

        return ProductSize(self, other)

    __rmul__ = __mul__

    def __truediv__(self, number: float) -> SizeField:
        from csgmesh.size.combinations import ProductSize

        return ProductSize(self, 1.0 / positive(number, "divisor of a size"))

    def clamp(self, lo: float | None = None, hi: float | None = None) -> SizeField:
        """The field, but nowhere below `lo` and nowhere above `hi`."""
        from csgmesh.size.combinations import ClampedSize

        return ClampedSize(self, lo, hi)


@dataclass(frozen=True)
class UniformSize(SizeField):
    """The same edge length everywhere.

    Parameters
    ----------
    value : float
        Edge length, in the units of the coordinates.

    Raises
    ------
    SizeError
        If it is not a positive finite number.

    Examples
    --------
    >>> UniformSize(0.5)(np.zeros((2, 2)))
    array([0.5, 0.5])
    """

    value: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", positive(self.value, "size"))

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Wanted edge length at each of `points` (n, dim), as (n,)."""
        return np.full(len(points), self.value)

    def bind(self, domain: Pslg) -> Source:
        """Itself: it is the same on every domain."""
        return self


def require_plane(domain: Pslg, field: str) -> None:
    """Refuse to bind a field that knows the plane alone to a domain in space.

    Raises
    ------
    SizeError
        If the domain lies in space.
    """
    if domain.dim != 2:
        raise SizeError(
            f"{field} needs a domain in the plane; in space sizes are a number, a mapping of "
            "names, a callable of points (n, 3), a NearSize, RegionSize, CurvatureSize or "
            "FeatureSize"
        )


def positive(value: object, what: str) -> float:
    """A positive finite number as a float.

    Examples
    --------
    >>> positive(2, "size of 'hole'")
    2.0
    """
    number = as_real(value)
    if number is None:
        raise SizeError(f"{what} must be a number; got {value!r}")
    if not 0 < number < np.inf:
        raise SizeError(f"{what} must be positive and finite; got {value!r}")
    if not SMALLEST <= number <= LARGEST:
        raise SizeError(f"{what} must be between {SMALLEST:g} and {LARGEST:g}; got {value!r}")
    return number

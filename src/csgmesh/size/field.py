"""Size fields: the wanted edge length as a function of place."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from csgmesh.errors import SizeError


class SizeField(ABC):
    """The wanted edge length at points. Subclasses define `__call__`."""

    @abstractmethod
    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Wanted edge length at each of `points` (n, dim), as (n,)."""


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
        return np.full(len(points), self.value)


def positive(value: object, what: str) -> float:
    """A positive finite number as a float.

    Examples
    --------
    >>> positive(2, "size of 'hole'")
    2.0
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
        raise SizeError(f"{what} must be a number; got {value!r}")
    number = float(value)
    if not (np.isfinite(number) and number > 0):
        raise SizeError(f"{what} must be positive and finite; got {value!r}")
    return number

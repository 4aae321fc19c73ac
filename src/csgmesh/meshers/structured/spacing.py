"""How the points of an edge are spaced: shares of its length."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.options import near

#: Points at which a wanted spacing is told.
TABLE = 257

#: A growing map of [0, 1] onto itself, or the number of cells, then the points' shares.
Spacing = Callable[[int], np.ndarray]

KINDS = ("uniform", "geometric", "tanh")


def uniform(n: int) -> np.ndarray:
    """Equal cells: n + 1 shares."""
    return np.linspace(0.0, 1.0, n + 1)


def geometric(ratio: float) -> Spacing:
    """Each cell `ratio` times as long as the one before it.

    Examples
    --------
    >>> geometric(2.0)(3)
    array([0.        , 0.14285714, 0.42857143, 1.        ])
    """

    def shares(n: int) -> np.ndarray:
        ends = np.concatenate([[0.0], np.cumsum(ratio ** np.arange(n))])
        return np.asarray(ends / ends[-1])

    return shares


def tanh(strength: float) -> Spacing:
    """Short cells at both ends, by the hyperbolic tangent (Vinokur, 1983).

    Examples
    --------
    >>> tanh(2.0)(2)
    array([0. , 0.5, 1. ])
    """

    def shares(n: int) -> np.ndarray:
        out = 0.5 + 0.5 * np.tanh(strength * (uniform(n) - 0.5)) / np.tanh(0.5 * strength)
        out[0], out[-1] = 0.0, 1.0
        return np.asarray(out)

    return shares


def by_density(density: np.ndarray) -> Spacing:
    """Cells as long as a size wants, from cells per length at equally spaced shares."""
    steps = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
    steps /= steps[-1]
    table = np.linspace(0.0, 1.0, len(density))

    def shares(n: int) -> np.ndarray:
        return np.interp(uniform(n), steps, table)

    return shares


def given(value: Any, name: str) -> Spacing:
    """The spacing that an option asks for.

    Parameters
    ----------
    value : str or sequence
        ``"uniform"``, ``("geometric", ratio)`` or ``("tanh", strength)``.
    name : str
        Whose spacing it is, for messages.

    Raises
    ------
    InputError
        If it is none of these.

    Examples
    --------
    >>> given("uniform", "inlet")(2)
    array([0. , 0.5, 1. ])
    """
    kind, *rest = [value] if isinstance(value, str) else list(value)
    if kind not in KINDS:
        raise InputError(f"spacing of {name!r} has no kind {kind!r}; {near(str(kind), KINDS)}")
    if kind == "uniform" and not rest:
        return uniform
    number = rest[0] if len(rest) == 1 else None
    if kind == "uniform" or isinstance(number, bool) or not isinstance(number, (int, float)):
        raise InputError(
            f"spacing of {name!r} must be 'uniform', ('geometric', ratio) or ('tanh', strength); "
            f"got {value!r}"
        )
    if not (np.isfinite(number) and number > 0):
        raise InputError(f"spacing of {name!r} needs a positive number; got {value!r}")
    return geometric(float(number)) if kind == "geometric" else tanh(float(number))

"""Sizes made of sizes: minimum, product, bounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.errors import SizeError
from csgmesh.size.field import SizeField, Source, UniformSize, positive

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg


@dataclass(frozen=True)
class CallableSize(SizeField):
    """A function of points as a field.

    Parameters
    ----------
    function : callable
        ``h(points (n, dim)) -> (n,)``.

    Examples
    --------
    >>> import csgmesh as cm
    >>> field = CallableSize(lambda points: 0.1 + points[:, 0])
    >>> field.bind(cm.evaluate(cm.Disk((0, 0), 1)))(np.array([[0.5, 0.0]]))
    array([0.6])
    """

    function: Callable[[np.ndarray], Any]

    def bind(self, domain: Pslg) -> Source:
        """The function, checked to give a positive number a point."""
        from csgmesh.size.resolve import evaluate

        return lambda points: evaluate(self.function, points)


@dataclass(frozen=True, init=False)
class MinimumSize(SizeField):
    """The smallest of several sizes at each point; written ``cm.minimum(a, b, ...)``."""

    sizes: tuple[SizeField, ...]

    def __init__(self, *sizes: Any) -> None:
        if not sizes:
            raise SizeError("minimum needs at least one size; got none")
        object.__setattr__(self, "sizes", tuple(as_field(size, "size") for size in sizes))

    def bind(self, domain: Pslg) -> Source:
        """The minimum of the bound sizes."""
        sources = [size.bind(domain) for size in self.sizes]
        even = [source.value for source in sources if isinstance(source, UniformSize)]
        if len(even) == len(sources):
            return UniformSize(min(even))
        return lambda points: np.minimum.reduce([source(points) for source in sources])


@dataclass(frozen=True)
class ProductSize(SizeField):
    """The product of a size with a number or with another size; written ``a * b``.

    Examples
    --------
    >>> UniformSize(0.5) * 2
    ProductSize(size=UniformSize(value=0.5), factor=UniformSize(value=2.0))
    """

    size: SizeField
    factor: Any

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", as_field(self.size, "size"))
        object.__setattr__(self, "factor", as_field(self.factor, "factor of a size"))

    def bind(self, domain: Pslg) -> Source:
        """The product of both, bound."""
        size, factor = self.size.bind(domain), self.factor.bind(domain)
        if isinstance(size, UniformSize) and isinstance(factor, UniformSize):
            return UniformSize(size.value * factor.value)
        return lambda points: size(points) * factor(points)


@dataclass(frozen=True)
class ClampedSize(SizeField):
    """A size between bounds; written ``a.clamp(lo, hi)``.

    Examples
    --------
    >>> UniformSize(0.5).clamp(hi=0.2)
    ClampedSize(size=UniformSize(value=0.5), lo=None, hi=0.2)
    """

    size: SizeField
    lo: float | None = None
    hi: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", as_field(self.size, "size"))
        for name in ("lo", "hi"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive(getattr(self, name), f"clamp: {name}"))
        if self.lo is not None and self.hi is not None and self.lo > self.hi:
            raise SizeError(f"clamp: lo must not exceed hi; got {self.lo:g} and {self.hi:g}")

    def bind(self, domain: Pslg) -> Source:
        """The bound size between its bounds."""
        size, lo, hi = self.size.bind(domain), self.lo or 0.0, self.hi or np.inf
        if isinstance(size, UniformSize):
            return UniformSize(min(max(size.value, lo), hi))
        return lambda points: np.clip(size(points), lo, hi)


def minimum(*sizes: Any) -> SizeField:
    """The smallest of several sizes at each point.

    Parameters
    ----------
    *sizes : SizeField, float, mapping or callable
        As `generate` takes them.

    Returns
    -------
    SizeField

    Raises
    ------
    SizeError
        If one is no size, or there are none.

    Examples
    --------
    >>> import csgmesh as cm
    >>> wanted = cm.minimum(cm.NearSize("hole", 0.02), {"rock": 0.1}, 0.2)
    """
    return MinimumSize(*sizes)


def as_field(value: Any, what: str) -> SizeField:
    """A number, a mapping of names, a callable or a field, as a field.

    Raises
    ------
    SizeError
        If it is none of these, or a number that is not positive and finite.
    """
    from csgmesh.size.named import NamedSizes

    if isinstance(value, SizeField):
        return value
    if isinstance(value, Mapping):
        return NamedSizes(value)
    if callable(value) and not isinstance(value, type):
        return CallableSize(value)
    if isinstance(value, (str, bytes, type)) or value is None:
        raise SizeError(f"{what} must be a number, a callable or a SizeField; got {value!r}")
    return UniformSize(positive(value, what))

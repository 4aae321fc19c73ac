"""What a `size=` argument means on a domain."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from csgmesh.domain.names import find_names
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError, SizeError
from csgmesh.options import as_real
from csgmesh.size.field import SizeField, Source, UniformSize, positive


@dataclass(frozen=True, eq=False)
class ResolvedSize:
    """Sizes ready to be evaluated at vertices.

    Attributes
    ----------
    default : callable or None
        Where nothing else is said; None: no bound.
    boundary : tuple of (markers, callable)
        On the facets with these markers, and growing away from them.
    region : tuple of (region numbers, callable)
        In these regions, instead of the default.
    """

    default: Source | None
    boundary: tuple[tuple[np.ndarray, Source], ...] = ()
    region: tuple[tuple[np.ndarray, Source], ...] = ()

    @property
    def uniform(self) -> float | None:
        """The one edge length of a uniform size, None of any other."""
        if isinstance(self.default, UniformSize) and not self.boundary and not self.region:
            return self.default.value
        return None

    @property
    def constants(self) -> tuple[float, ...]:
        """Edge lengths that hold over more than a point: those given as numbers."""
        sources = [self.default, *(s for _, s in (*self.boundary, *self.region))]
        return tuple(s.value for s in sources if isinstance(s, UniformSize))


def resolve(size: Any, domain: Pslg) -> ResolvedSize | None:
    """Look up the names in a `size=` argument and check its values.

    Parameters
    ----------
    size : None, float, mapping, callable or SizeField
        Wanted edge length: a number, names of boundaries and regions with numbers or callables and
        ``"default"``, a callable of points (n, dim), or a `SizeField`. A name that a region and a
        boundary share means both: the size holds in the region and on the boundary.
    domain : Pslg
        Whose names the mapping's keys are.

    Returns
    -------
    ResolvedSize or None
        None without a size.

    Raises
    ------
    SizeError
        If a number is not positive and finite, or a value is neither a number nor callable.
    NameLookupError
        If a key matches no boundary and no region.

    Examples
    --------
    >>> square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> resolve({"boundary": 0.1, "default": 0.3}, square).boundary[0][0]
    array([0])
    """
    if size is None:
        return None
    if not isinstance(size, Mapping):
        return ResolvedSize(_source(size, "size", domain))
    default: Source | None = None
    boundary, region = [], []
    for name, value in size.items():
        if not isinstance(name, str):
            raise InputError(f"keys of a size are names of boundaries or regions; got {name!r}")
        source = _source(value, f"size of {name!r}", domain)
        if name == "default":
            default = source
            continue
        markers, regions = meaning(name, domain)
        if len(markers):
            boundary.append((markers, source))
        if len(regions):
            region.append((regions, source))
    return ResolvedSize(default, tuple(boundary), tuple(region))


def evaluate(source: Source, points: np.ndarray) -> np.ndarray:
    """Values of a size at points, checked.

    Raises
    ------
    SizeError
        With the first point at which the value is not positive and finite, or the shape is wrong.
    """
    if not len(points):
        return np.empty(0)
    value = _numbers(source(points.copy()), points)
    if value.shape not in ((len(points),), ()):
        raise SizeError(
            f"a size must return one number per point, shape ({len(points)},); "
            f"got shape {value.shape} for {_first(points)}"
        )
    value = np.broadcast_to(value, len(points)).astype(float)
    wrong = np.flatnonzero(~(np.isfinite(value) & (value > 0)))
    if len(wrong):
        where = ", ".join(f"{c:.6g}" for c in points[wrong[0]])
        raise SizeError(f"a size must be positive and finite; got {value[wrong[0]]:g} at ({where})")
    return value


def _numbers(given: Any, points: np.ndarray) -> np.ndarray:
    """What a callable returned as an array of numbers."""
    try:
        value = np.asarray(given)
    except ValueError:  # lists of different lengths
        value = np.asarray(None)
    if value.dtype.kind == "O" and value.ndim:
        numbers = [as_real(x) for x in value.ravel()]
        if None not in numbers:
            return np.array(numbers, float).reshape(value.shape)
    if value.dtype.kind not in "fiu":
        raise SizeError(
            f"a size must return numbers; got {reprlib.repr(given)} for {_first(points)}"
        )
    return value


def _first(points: np.ndarray) -> str:
    """How many points a callable was given, and the first of them."""
    where = ", ".join(f"{c:.6g}" for c in points[0])
    return f"{len(points)} points, the first of them ({where})"


def pointwise(size: Any, domain: Pslg) -> Source:
    """A `size=` argument as a function of points alone, for meshers without a triangulation.

    Names mean what is said at points in their regions, and on their boundaries, growing away from
    both by 0.3 per unit of length; see `csgmesh.size.limit_gradation` for any other bound.

    Parameters
    ----------
    size : None, float, mapping, callable or SizeField
        Wanted edge length; None stands for the domain's diagonal.
    domain : Pslg

    Returns
    -------
    callable
        ``h(points (n, 2)) -> (n,)``; raises a `SizeError` where it would not be positive.

    Raises
    ------
    SizeError, NameLookupError
        As of `resolve`.

    Examples
    --------
    >>> square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> h = pointwise({"boundary": 0.1, "default": 0.3}, square)
    >>> h(np.array([[0.5, 0.0], [0.5, 0.5]]))
    array([0.1 , 0.25])
    """
    from csgmesh.size.combinations import as_field

    if size is None:
        return UniformSize(domain.diagonal)
    source = as_field(size, "size").bind(domain)
    return lambda points: evaluate(source, points)


def _source(value: Any, what: str, domain: Pslg) -> Source:
    if isinstance(value, SizeField):
        return value.bind(domain)
    if callable(value) and not isinstance(value, type):
        return value
    if isinstance(value, (str, bytes, type)) or value is None:
        raise SizeError(f"{what} must be a number or a callable; got {value!r}")
    return UniformSize(positive(value, what))


def meaning(name: str, domain: Pslg) -> tuple[np.ndarray, np.ndarray]:
    """Markers and regions that a name, prefix or glob means."""
    boundaries = [n for names in domain.boundary_names for n in names]
    wanted = set(find_names(name, [*boundaries, *domain.region_names], what="boundary or region"))
    markers = [k for k, names in enumerate(domain.boundary_names) if wanted.intersection(names)]
    regions = [k for k, n in enumerate(domain.region_names) if n in wanted]
    return np.array(markers, np.int64), np.array(regions, np.int64)

"""From a tree to its exact, named boundary."""

from __future__ import annotations

import math
import reprlib
from numbers import Real
from typing import Any

from csgmesh.domain.plc import Plc
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError, ShapeError

__all__ = ["evaluate"]


def evaluate(shape: Any, deviation: float | None = None, snap: float | None = None) -> Any:
    """Evaluate a shape to its exact, named boundary.

    Parameters
    ----------
    shape : Shape, Regions, Embed, Periodic or Pslg
        A Pslg is returned as it is.
    deviation : float, optional
        Largest distance between a segment and its exact curve, in coordinate units. The default is
        1e-3 of the extent of the leaf that the curve belongs to.
    snap : float, optional
        Distance below which points merge, in coordinate units; at least 4 ulp of the largest
        coordinate. The default is 1e-10 of the domain's diagonal.

    Returns
    -------
    Pslg
        With ``report``: what was merged, where, and between which leaves.

    Raises
    ------
    InputError
        If `deviation` or `snap` is given with a Pslg or Plc, which is discretised already.
    ShapeError
        If a polygon crosses itself, an embedded point lies outside, or an argument is no positive
        number.
    UnboundedDomainError, EmptyDomainError
        If there is nothing finite to mesh.
    EvaluationError
        If boundaries nearly coincide in a way that the snap distance neither joins nor separates,
        or periodic sides are not congruent.

    Notes
    -----
    All pieces are cut at their exact intersections; faces and names follow combinatorially from
    that arrangement, never from distances. Time is O((n + k) log n) for n pieces that meet k times.

    Examples
    --------
    >>> import csgmesh as cm
    >>> half = cm.evaluate(cm.Disk((0, 0), 1) & cm.HalfSpace((0, 0), (0, -1)))
    >>> round(float(half.areas()[0]), 6)
    1.570796
    >>> half.names
    ('disk', 'half_space')
    """
    for name, value in (("deviation", deviation), ("snap", snap)):
        if value is not None and not _is_positive(value):
            raise ShapeError(f"{name} must be a positive, finite number; got {value!r}")
    if isinstance(shape, Pslg | Plc):
        for name, value in (("deviation", deviation), ("snap", snap)):
            if value is not None:
                raise InputError(
                    f"a {type(shape).__name__} is discretised already, so that {name} has no "
                    f"meaning for it; {name}={value!r} given"
                )
        return shape
    from csgmesh.boundary.planar import evaluate_plane
    from csgmesh.csg import Embed, Periodic, Regions, Shape

    if not isinstance(shape, Shape | Regions | Embed | Periodic):
        raise InputError(
            "a shape must be a Shape, Regions, Embed, Periodic or Pslg, such as "
            f"Box((0, 0), (1, 1)); got {reprlib.repr(shape)}"
        )
    if shape.dim == 3:
        from csgmesh.boundary.solid import evaluate_solid

        return evaluate_solid(shape, deviation, snap)
    domain = evaluate_plane(shape, deviation, snap)
    if isinstance(shape, Periodic) and shape.pairs:
        from csgmesh.boundary.periodic import pair_sides

        return pair_sides(domain, shape.pairs)
    return domain


def _is_positive(value: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    return 0 < float(value) < math.inf

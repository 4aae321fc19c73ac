"""Booleans as functions, for many shapes at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from csgmesh.csg.nodes import combined
from csgmesh.csg.shape import Shape
from csgmesh.errors import ShapeError


def union(*shapes: Shape | Iterable[Shape]) -> Shape:
    """The points in at least one of the shapes, given one by one or as one iterable.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.union(cm.Disk((x, 0), 1) for x in range(3)).bounds()
    (array([-1., -1.]), array([3., 1.]))
    """
    return combined("union", _listed(shapes))


def intersection(*shapes: Shape | Iterable[Shape]) -> Shape:
    """The points in all of the shapes, given one by one or as one iterable.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.intersection(cm.Box((0, 0), (2, 2)), cm.Box((1, 0), (3, 1))).bounds()
    (array([1., 0.]), array([2., 1.]))
    """
    return combined("intersection", _listed(shapes))


def difference(a: Shape, *others: Shape) -> Shape:
    """The points of `a` in none of the others.

    Examples
    --------
    >>> import csgmesh as cm
    >>> cm.difference(cm.Box((0, 0), (2, 2)), cm.Disk((0, 0), 1)).contains([(0.5, 0.5), (1, 1)])
    array([False,  True])
    """
    return combined("difference", [a, *_listed(others)])


def symmetric_difference(*shapes: Shape | Iterable[Shape]) -> Shape:
    """The points in an odd number of the shapes, given one by one or as one iterable.

    Examples
    --------
    >>> import csgmesh as cm
    >>> rings = cm.symmetric_difference(cm.Disk((0, 0), r) for r in (1, 2, 3))
    >>> rings.contains([(0.5, 0), (1.5, 0), (2.5, 0)])
    array([ True, False,  True])
    """
    return combined("symmetric_difference", _listed(shapes))


def _listed(shapes: Sequence[Any]) -> list[Any]:
    """The shapes themselves, or those of the one iterable among the arguments."""
    if len(shapes) == 1 and not isinstance(shapes[0], Shape):
        if not isinstance(shapes[0], Iterable):
            raise ShapeError(f"a boolean needs shapes or an iterable of shapes; got {shapes[0]!r}")
        return list(shapes[0])
    return list(shapes)

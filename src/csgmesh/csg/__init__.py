"""The expression tree: what a shape is. Building one computes nothing."""

from __future__ import annotations

from csgmesh.csg.booleans import difference, intersection, symmetric_difference, union
from csgmesh.csg.embed import Embed, EmbeddedPath, EmbeddedPoints
from csgmesh.csg.primitive import Primitive
from csgmesh.csg.primitives import (
    Box,
    Disk,
    Ellipse,
    HalfSpace,
    Outline,
    Polygon,
    RegularPolygon,
    Triangle,
)
from csgmesh.csg.regions import Regions
from csgmesh.csg.shape import Shape

__all__ = [
    "Box",
    "Disk",
    "Ellipse",
    "Embed",
    "EmbeddedPath",
    "EmbeddedPoints",
    "HalfSpace",
    "Outline",
    "Polygon",
    "Primitive",
    "Regions",
    "RegularPolygon",
    "Shape",
    "Triangle",
    "difference",
    "intersection",
    "symmetric_difference",
    "union",
]

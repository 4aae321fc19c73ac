"""The leaves of the tree: one file a primitive, one line here that lists it."""

from __future__ import annotations

from csgmesh.csg.primitives.box import Box
from csgmesh.csg.primitives.disk import Disk
from csgmesh.csg.primitives.ellipse import Ellipse
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.primitives.outline import Outline
from csgmesh.csg.primitives.polygon import Polygon
from csgmesh.csg.primitives.regular_polygon import RegularPolygon
from csgmesh.csg.primitives.triangle import Triangle

__all__ = [
    "Box",
    "Disk",
    "Ellipse",
    "HalfSpace",
    "Outline",
    "Polygon",
    "RegularPolygon",
    "Triangle",
]

"""The expression tree: what a shape is. Building one computes nothing."""

from __future__ import annotations

from csgmesh.csg.booleans import difference, intersection, symmetric_difference, union
from csgmesh.csg.embed import Embed, EmbeddedPath, EmbeddedPoints
from csgmesh.csg.periodic import Periodic
from csgmesh.csg.primitive import Primitive
from csgmesh.csg.primitives import (
    Ball,
    Box,
    Cone,
    Cylinder,
    Disk,
    Ellipse,
    Ellipsoid,
    Extrude,
    FacetedSolid,
    HalfSpace,
    Hull,
    Outline,
    Polygon,
    Polyhedron,
    RegularPolygon,
    Revolve,
    Tetrahedron,
    Torus,
    Triangle,
)
from csgmesh.csg.regions import Regions
from csgmesh.csg.shape import Shape

__all__ = [
    "Ball",
    "Box",
    "Cone",
    "Cylinder",
    "Disk",
    "Ellipse",
    "Ellipsoid",
    "Embed",
    "EmbeddedPath",
    "EmbeddedPoints",
    "Extrude",
    "FacetedSolid",
    "HalfSpace",
    "Hull",
    "Outline",
    "Periodic",
    "Polygon",
    "Polyhedron",
    "Primitive",
    "Regions",
    "RegularPolygon",
    "Revolve",
    "Shape",
    "Tetrahedron",
    "Torus",
    "Triangle",
    "difference",
    "intersection",
    "symmetric_difference",
    "union",
]

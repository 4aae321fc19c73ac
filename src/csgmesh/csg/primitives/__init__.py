"""The leaves of the tree: one file a primitive, one line here that lists it."""

from __future__ import annotations

from csgmesh.csg.primitives.ball import Ball
from csgmesh.csg.primitives.box import Box
from csgmesh.csg.primitives.cone import Cone
from csgmesh.csg.primitives.cylinder import Cylinder
from csgmesh.csg.primitives.disk import Disk
from csgmesh.csg.primitives.ellipse import Ellipse
from csgmesh.csg.primitives.ellipsoid import Ellipsoid
from csgmesh.csg.primitives.extrude import Extrude
from csgmesh.csg.primitives.faceted_solid import FacetedSolid
from csgmesh.csg.primitives.half_space import HalfSpace
from csgmesh.csg.primitives.hull import Hull
from csgmesh.csg.primitives.outline import Outline
from csgmesh.csg.primitives.polygon import Polygon
from csgmesh.csg.primitives.polyhedron import Polyhedron
from csgmesh.csg.primitives.regular_polygon import RegularPolygon
from csgmesh.csg.primitives.revolve import Revolve
from csgmesh.csg.primitives.tetrahedron import Tetrahedron
from csgmesh.csg.primitives.torus import Torus
from csgmesh.csg.primitives.triangle import Triangle

__all__ = [
    "Ball",
    "Box",
    "Cone",
    "Cylinder",
    "Disk",
    "Ellipse",
    "Ellipsoid",
    "Extrude",
    "FacetedSolid",
    "HalfSpace",
    "Hull",
    "Outline",
    "Polygon",
    "Polyhedron",
    "RegularPolygon",
    "Revolve",
    "Tetrahedron",
    "Torus",
    "Triangle",
]

"""OpenSCAD's exported trees (``.csg``) as shapes."""

from csgmesh.io.openscad.files import openscad_shape

__all__ = ["openscad_shape"]

"""From a mesh to a better or a finer one with the same boundary."""

from csgmesh.improve.elevation import elevate
from csgmesh.improve.optimisation import optimise
from csgmesh.improve.refinement import refine
from csgmesh.improve.smoothing import smooth
from csgmesh.improve.tetrahedra import improve_tetrahedra

__all__ = ["elevate", "improve_tetrahedra", "optimise", "refine", "smooth"]

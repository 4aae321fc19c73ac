"""From a mesh to a better or a finer one with the same boundary."""

from csgmesh.improve.elevation import elevate
from csgmesh.improve.optimisation import optimise
from csgmesh.improve.refinement import refine
from csgmesh.improve.smoothing import smooth

__all__ = ["elevate", "optimise", "refine", "smooth"]

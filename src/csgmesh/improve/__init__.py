"""From a mesh to a better one with the same boundary: worst angles raised, or smoothed."""

from csgmesh.improve.optimisation import optimise
from csgmesh.improve.smoothing import smooth

__all__ = ["optimise", "smooth"]

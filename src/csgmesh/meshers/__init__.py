"""How to mesh: one strategy a file, each a frozen object with `generate`."""

from csgmesh.meshers.constrained_delaunay import ConstrainedDelaunay
from csgmesh.meshers.delaunay_refinement import DelaunayRefinement

__all__ = ["ConstrainedDelaunay", "DelaunayRefinement"]

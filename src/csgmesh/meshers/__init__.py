"""How to mesh: one strategy a file, each a frozen object with `generate`."""

from csgmesh.meshers.constrained_delaunay import ConstrainedDelaunay
from csgmesh.meshers.delaunay_refinement import DelaunayRefinement
from csgmesh.meshers.layers import Layers
from csgmesh.meshers.octree.mesher import Octree
from csgmesh.meshers.per_region import PerRegion
from csgmesh.meshers.quad_pairing import QuadPairing
from csgmesh.meshers.quadtree import Quadtree
from csgmesh.meshers.structured import Structured
from csgmesh.meshers.surface.mesher import SurfaceRefinement
from csgmesh.meshers.sweep import Sweep
from csgmesh.meshers.worst import worst_cells

__all__ = [
    "ConstrainedDelaunay",
    "DelaunayRefinement",
    "Layers",
    "Octree",
    "PerRegion",
    "QuadPairing",
    "Quadtree",
    "Structured",
    "SurfaceRefinement",
    "Sweep",
    "worst_cells",
]

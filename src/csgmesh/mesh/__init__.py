"""The result: `Mesh`, cell kinds, topology."""

from csgmesh.mesh.kinds import KINDS, Kind
from csgmesh.mesh.mesh import Mesh

__all__ = ["KINDS", "Kind", "Mesh"]

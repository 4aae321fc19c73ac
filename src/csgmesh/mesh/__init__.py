"""The result: `Mesh`, cell kinds, topology."""

from csgmesh.mesh.kinds import KINDS, Kind
from csgmesh.mesh.mesh import Mesh
from csgmesh.mesh.periodic import PeriodicPair

__all__ = ["KINDS", "Kind", "Mesh", "PeriodicPair"]

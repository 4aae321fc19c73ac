"""A mesher a region: subdomains → meshes, one after the other → one mesh."""

from csgmesh.meshers.per_region.mesher import Mesher, PerRegion

__all__ = ["Mesher", "PerRegion"]

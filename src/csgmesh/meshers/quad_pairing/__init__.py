"""All quads: coarse triangles → pairs → halves → squares."""

from csgmesh.meshers.quad_pairing.mesher import QuadPairing

__all__ = ["QuadPairing"]

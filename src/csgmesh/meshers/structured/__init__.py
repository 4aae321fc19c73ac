"""Structured grids: outline → blocks → counts → points."""

from csgmesh.meshers.structured.mesher import Structured

__all__ = ["Structured"]

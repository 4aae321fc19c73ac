"""From straight cells to curved ones of higher order."""

from csgmesh.improve.elevation.elevating import elevate

__all__ = ["elevate"]

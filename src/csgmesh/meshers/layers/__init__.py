"""Boundary layers: thin cells along walls, around whatever mesher does the rest."""

from csgmesh.meshers.layers.generation import with_layers
from csgmesh.meshers.layers.options import Layers, checked_layers

__all__ = ["Layers", "checked_layers", "with_layers"]

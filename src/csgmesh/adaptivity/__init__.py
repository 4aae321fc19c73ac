"""Meshes made again and again: to a number of cells, to a solution's error."""

from csgmesh.adaptivity.adaptation import Adaptation, adapt
from csgmesh.adaptivity.budget import generate_to_budget

__all__ = ["Adaptation", "adapt", "generate_to_budget"]

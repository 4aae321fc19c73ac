"""From a mesh to a finer one: cells divided by templates, conforming, names inherited."""

from csgmesh.improve.refinement.refining import refine

__all__ = ["refine"]

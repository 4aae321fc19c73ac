"""From a mesh to a finer one: cells divided by templates, conforming, names inherited."""

from csgmesh.improve.refinement.refining import halve_edges, refine

__all__ = ["halve_edges", "refine"]

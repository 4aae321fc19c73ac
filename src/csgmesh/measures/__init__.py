"""Measures of a mesh: `quality` says how good the cells are, `check` whether the mesh is right."""

from csgmesh.measures.certificate import Certificate, Check, Failure, check
from csgmesh.measures.conformity import SizeConformity, size_conformity
from csgmesh.measures.quality import Quality, quality

__all__ = [
    "Certificate",
    "Check",
    "Failure",
    "Quality",
    "SizeConformity",
    "check",
    "quality",
    "size_conformity",
]

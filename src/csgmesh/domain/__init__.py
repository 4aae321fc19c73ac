"""The narrow waist between geometry and meshing: all that a mesher may know of a domain."""

from csgmesh.domain.curves import Curves
from csgmesh.domain.pslg import Oracle, Pslg
from csgmesh.domain.report import Merge, Report

__all__ = ["Curves", "Merge", "Oracle", "Pslg", "Report"]

"""The narrow waist between geometry and meshing: all that a mesher may know of a domain."""

from csgmesh.domain.curves import Curves
from csgmesh.domain.plc import Plc
from csgmesh.domain.pslg import Oracle, Pslg
from csgmesh.domain.report import Merge, Report
from csgmesh.domain.surfaces import Surfaces

__all__ = ["Curves", "Merge", "Oracle", "Plc", "Pslg", "Report", "Surfaces"]

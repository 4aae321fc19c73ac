"""From a mesh of tetrahedra to a better one of the same domain."""

from csgmesh.improve.tetrahedra.improving import improve_tetrahedra

__all__ = ["improve_tetrahedra"]

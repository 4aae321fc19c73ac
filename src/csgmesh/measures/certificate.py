"""The certificate: is the mesh right?"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError
from csgmesh.measures.results import Certificate, Check, Failure
from csgmesh.measures.rules.amounts import check_area, check_samples
from csgmesh.measures.rules.arrays import check_indices, check_points
from csgmesh.measures.rules.bends import check_edge_nodes
from csgmesh.measures.rules.case import Case
from csgmesh.measures.rules.cells import (
    check_angles,
    check_delaunay,
    check_jacobian,
    check_orientation,
)
from csgmesh.measures.rules.complexes import (
    check_conforming,
    check_facets,
    check_overlap,
    check_topology,
)
from csgmesh.measures.rules.curves import (
    check_coverage,
    check_deviation,
    check_intervals,
    check_on_curves,
)
from csgmesh.measures.rules.names import (
    check_embedded_points,
    check_facet_names,
    check_names,
    check_sides,
)
from csgmesh.measures.rules.periodic import check_periodic
from csgmesh.measures.rules.structure import check_blocks
from csgmesh.mesh import Mesh

__all__ = ["Certificate", "Check", "Failure", "check"]

#: Name and function of every rule, in the order of checking. All but the first index with the
#: numbers that the first one checks.
RULES: tuple[tuple[str, Callable[[Case], Check]], ...] = (
    ("indices", check_indices),
    ("points", check_points),
    ("orientation", check_orientation),
    ("Jacobian", check_jacobian),
    ("conforming", check_conforming),
    ("facets", check_facets),
    ("overlap", check_overlap),
    ("components and holes", check_topology),
    ("on curves", check_on_curves),
    ("deviation", check_deviation),
    ("edge nodes", check_edge_nodes),
    ("intervals", check_intervals),
    ("coverage", check_coverage),
    ("names", check_names),
    ("facet names", check_facet_names),
    ("regions", check_sides),
    ("embedded points", check_embedded_points),
    ("periodic sides", check_periodic),
    ("area", check_area),
    ("smallest angle", check_angles),
    ("Delaunay", check_delaunay),
    ("blocks", check_blocks),
    ("samples", check_samples),
)


def check(
    mesh: Mesh,
    reference: Pslg | None = None,
    contains: Callable[[np.ndarray], np.ndarray] | None = None,
    *,
    min_angle: float | None = None,
) -> Certificate:
    """Check a plane mesh against the domain it must mesh.

    With a `reference`, nothing of the mesh is trusted but coordinates and connectivity: curves,
    names and regions are found anew from where its facets lie. Without one, the mesh is checked
    against the domain that it remembers; without that either (a mesh read from a file), what can
    be checked is checked and the certificate says what could not be.

    How cells fit together, sizes of angles and samples are checked by the corners of curved cells;
    their Jacobian, area and boundary nodes as curved as they are.

    Parameters
    ----------
    mesh : Mesh
    reference : Pslg, optional
        The domain, evaluated anew. Its outline may be finer or coarser than that of the mesh, but
        the shells of its input angles, in which cells are excused, are those of its own segments.
    contains : callable, optional
        Region number of each of (n, 2) points, into ``reference.region_names``, -1 outside:
        100,000 random points are compared with it.
    min_angle : float, optional
        Bound on the angles in degrees. Default: ``mesh.info["min_angle"]``, if the mesher set it.

    Returns
    -------
    Certificate
        ``.ok``, ``.failures``, ``.checks``, ``.to_json()``; printable.

    Raises
    ------
    InputError
        If the mesh is not plane.

    Examples
    --------
    >>> from csgmesh.measures import check
    >>> from csgmesh.mesh import Mesh
    >>> mesh = Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], {"triangle": [[0, 1, 2], [0, 2, 3]]})
    >>> certificate = check(mesh)
    >>> certificate.ok, certificate["orientation"].status, certificate["area"].status
    (False, 'passed', 'skipped')
    >>> print(certificate.failures[0])
    facets: 4 edges bound a region without a facet; the first is edge 0 at (0.5, 0)
    """
    if mesh.dim != 2:
        raise InputError(f"check knows plane meshes; this one has dim {mesh.dim}")
    if min_angle is None:
        asked = mesh.info.get("min_angle")
        min_angle = float(asked) if isinstance(asked, (int, float)) else None
    case = Case(mesh, mesh.domain if reference is None else reference, contains, min_angle)
    return Certificate.of(RULES, case)

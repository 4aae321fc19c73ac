"""Triangles on the boundary of a solid, as a mesh of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.mesh import Mesh
from csgmesh.meshers.octree.sizes import SpaceSizes
from csgmesh.meshers.surface.meshing import surface_mesh
from csgmesh.meshers.workspace import Progress
from csgmesh.options import as_real, check_growth, check_real, check_whole

#: Above this, angles are not reached on the way: refinement would not end.
LARGEST_MIN_ANGLE = 30.0

#: Sizes are known in the volume, which one size all over never fills with points.
_UNLIMITED = 10**12
_LEAST_BUDGET = 10**7


@dataclass(frozen=True)
class SurfaceRefinement:
    """Triangles on the exact boundary of a solid and on the interfaces of its regions.

    Feature curves get vertices as far apart as sizes and curvature ask; vertices of the evaluated
    domain that are not wanted are taken away; off-centres of triangles that are too large or have
    small angles are inserted on the exact surfaces; smoothing follows.

    Parameters
    ----------
    min_angle : float, default 25
        Smallest angle of the triangles, from 0 to 30 degrees.
    gradation : float, default 0.3
        Bound on the growth of sizes per unit of length.
    max_points : int, default 10**7
        Bound on the number of points.
    walls : int, default 1
        Edges on both sides of a thin wall or gap are no longer than three times its thickness over
        this number, as for `Octree`; 0 looks at no walls.

    Raises
    ------
    InputError
        If an option is out of range.

    Guarantees
    ----------
    The surface is closed around each region. Vertices lie on the exact surfaces, on both at a
    curve between two of them; corners of the domain are vertices, feature curves chains of edges.
    Regions and names are those of the domain. Each interface is meshed once. The same input gives
    the same bytes.

    Exceptions
    ----------
    Angles are smaller where corners of faces enforce it and in slits of faces that are thinner
    than the deviation of the domain: they are measured (see `csgmesh.quality`), not proved.
    Triangles of different faces may cross where walls are thinner than sizes resolve: those below
    a thousandth of the diagonal, gaps outside the domain, and with ``walls=0`` any.

    Termination
    -----------
    Always: no more than `max_points` points are made; a `BudgetError` carries the surface so far
    as a `SurfaceMesh`.

    References
    ----------
    .. [1] L. P. Chew, "Guaranteed-quality mesh generation for curved surfaces", 9th Symp.
       Computational Geometry (1993).
    .. [2] A. Üngör, "Off-centers: a new type of Steiner points for computing size-optimal
       quality-guaranteed Delaunay triangulations", LATIN (2004).

    Examples
    --------
    >>> import csgmesh as cm
    >>> ball = cm.Ball((0, 0, 0), 1)
    >>> mesh = cm.generate(ball, cm.SurfaceRefinement(), size=0.3)
    >>> list(mesh.cells), mesh.names, cm.check(mesh, ball).ok
    (['triangle'], ('ball',), True)
    """

    min_angle: float = 25.0
    gradation: float = 0.3
    max_points: int = 10**7
    walls: int = 1

    dim = 3

    def __post_init__(self) -> None:
        rule = f"between 0 and {LARGEST_MIN_ANGLE:g} degrees"
        checked = {
            "min_angle": check_real(
                "min_angle", self.min_angle, rule, lambda angle: 0 <= angle <= LARGEST_MIN_ANGLE
            ),
            "gradation": check_growth("gradation", self.gradation),
            "max_points": check_whole("max_points", self.max_points, 4),
            "walls": check_whole("walls", self.walls, 0),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def generate(self, domain: Plc, size: Any = None, progress: Progress | None = None) -> Mesh:
        """Mesh the boundary of a solid.

        Parameters
        ----------
        domain : Plc
        size : None, float, mapping, callable or SizeField
            Wanted edge length; without one curvature and features decide.
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Returns
        -------
        Mesh
            Its ``cells["triangle"]`` are counterclockwise seen from outside the region that
            `cell_region` has; ``facets["triangle"]`` are the same triangles, with names and the
            regions on both sides.

        Raises
        ------
        BudgetError
            If `max_points` do not suffice.
        SizeError, NameLookupError
            If the size is not positive and finite somewhere, or names nothing.
        """
        is_one = as_real(size) is not None
        budget = _UNLIMITED if is_one else max(self.max_points, _LEAST_BUDGET)
        sizes = SpaceSizes.of(domain, size, self.gradation, budget)
        sizes = sizes.fit_for_walls(self.walls, self.max_points, budget)
        surface = surface_mesh(
            domain,
            sizes,
            min_angle=self.min_angle,
            max_points=self.max_points,
            progress=progress,
        )
        info: dict[str, object] = {"method": "SurfaceRefinement", "options": dict(vars(self))}
        if sizes.walls is not None:
            info["walls"] = sizes.walls.info()
        return triangle_mesh(surface, info)


def triangle_mesh(surface: SurfaceMesh, info: dict[str, object]) -> Mesh:
    """The mesh whose cells, and facets, are the triangles of a surface."""
    domain, region = surface.plc, surface.region
    behind = np.where(region[:, 0] >= 0, region[:, 0], region[:, 1])
    return Mesh(
        surface.points,
        {"triangle": surface.triangles},
        {"triangle": behind},
        domain.region_names,
        {"triangle": surface.triangles},
        {"triangle": surface.marker},
        domain.boundary_names,
        {"triangle": region},
        domain=domain,  # type: ignore[arg-type]
        info=info,
    )

"""A surface mesh and a lattice, made finer until tetrahedra fill the surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import SurfaceMesh
from csgmesh.errors import MeshingError
from csgmesh.meshers.octree.lattice import Lattice, lattice
from csgmesh.meshers.octree.sizes import SpaceSizes
from csgmesh.meshers.surface import surface_mesh
from csgmesh.meshers.surface.halving import halve_longest
from csgmesh.meshers.tetrahedra import Tetrahedra, tetrahedralize
from csgmesh.meshers.workspace import Progress
from csgmesh.spatial import nearest_distances

#: Times that sizes are made smaller where triangles of the surface are no faces of tetrahedra.
ROUNDS = 8
#: By so much, each time.
SMALLER = 0.5
#: If so few triangles are missing, edges of theirs are halved, so many times as long as that
#: does not leave so many more; all else stays.
_FEW = 20
_HALVINGS = 6
_SLACK = 3
#: What is missing in so many rounds is missing because exact surfaces cross where the domain's
#: facets do not: the domain is evaluated with finer ones there, so many times.
_LASTING = 3
_DOMAINS = 1
#: Places are the same if nearer than so many sizes.
_SAME = 2.0


def fill(
    domain: Plc,
    sizes_of: Callable[[Plc], SpaceSizes],
    max_points: int,
    progress: Progress | None,
    told: Callable[[int], None],
) -> tuple[SurfaceMesh, Lattice, Tetrahedra, SpaceSizes]:
    """A surface mesh of a domain, the lattice in it, the tetrahedra of both, and the sizes at last.

    Parameters
    ----------
    domain : Plc
    sizes_of : callable
        Sizes of the domain, or of the same with finer facets.
    max_points : int
    progress : callable, optional
    told : callable
        Called with the number of the stage that begins.

    Raises
    ------
    MeshingError
        If some triangles are missing however fine; with the place.
    """
    sizes, past = sizes_of(domain), np.zeros((0, 3))
    lasting = n_domains = 0
    for _ in range(ROUNDS):
        told(0)
        surface = surface_mesh(domain, sizes, max_points=max_points, progress=progress)
        told(1)
        grid = lattice(sizes, surface, max_points)
        told(2)
        filled = tetrahedralize(surface, grid.points, grid.kept)
        places = filled.places
        least = _FEW + 1
        for _ in range(_HALVINGS):
            if not 0 < len(filled.missing) < least:
                break
            least = len(filled.missing) + _SLACK
            surface = halve_longest(replace(surface, triangles=filled.triangles), filled.missing)
            filled = tetrahedralize(surface, grid.points, grid.kept)
        if not len(filled.missing):
            return surface, grid, filled, sizes
        same = nearest_distances(places, past) < _SAME * sizes(places)
        lasting = lasting + 1 if same.any() else 0
        past = places
        if lasting >= _LASTING - 1 and domain.finer is not None and n_domains < _DOMAINS:
            domain = domain.finer(places[same])
            sizes, lasting, n_domains = sizes_of(domain), 0, n_domains + 1
        else:
            sizes = sizes.smaller_at(places, SMALLER, max_points)
    x, y, z = filled.places[0]
    raise MeshingError(
        f"the surface at ({x:.6g}, {y:.6g}, {z:.6g}) cannot be filled with tetrahedra, "
        f"however fine: {len(filled.missing)} triangles are missing after {ROUNDS} rounds"
    )

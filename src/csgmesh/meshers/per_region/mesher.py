"""A mesher a region, conforming where they meet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from csgmesh.domain.names import find_names
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.meshers.constrained_delaunay import ConstrainedDelaunay
from csgmesh.meshers.delaunay_refinement import DelaunayRefinement
from csgmesh.meshers.per_region.assembly import Assembly
from csgmesh.meshers.per_region.subdomain import subdomain
from csgmesh.meshers.structured import Structured
from csgmesh.meshers.workspace import Progress


class Mesher(Protocol):
    """A method: an immutable object of options with one verb."""

    def generate(self, domain: Pslg, size: Any = None, progress: Progress | None = None) -> Mesh:
        """The mesh of a domain."""


@dataclass(frozen=True)
class PerRegion:
    """A mesher for each region; at interfaces the meshes fit together.

    Regions with the same mesher are meshed as one domain. Structured grids come first, then the
    other meshers in the order given, triangulations last: a triangulation takes over the edges that
    lie on its interfaces already.

    Parameters
    ----------
    meshers : mapping of str to mesher
        By names, prefixes or globs of regions.
    default : mesher, optional
        For regions that are not named: `DelaunayRefinement` unless given.

    Raises
    ------
    InputError
        If something is no mesher.

    Guarantees
    ----------
    The mesh conforms. Regions and names are those of the domain, boundary vertices lie on their
    exact curves. Away from interfaces each region is as its mesher promises.

    Exceptions
    ----------
    Beside edges that were there before, triangles may be smaller or thinner than their mesher
    promises: vertices that it put on those edges are taken away again. Two meshers of quads cannot
    meet at an interface, unless they happen to put the same vertices on it: an error says where.

    Termination
    -----------
    When all meshers end.

    Examples
    --------
    >>> import csgmesh as cm
    >>> rock = cm.Box((0, 0), (2, 1), name="box")
    >>> material = cm.Regions({"rock": rock, "core": cm.Disk((1, 0.5), 0.25, name="bond")})
    >>> mesh = cm.generate(material, cm.PerRegion({"core": cm.Structured()}), size=0.1)
    >>> list(mesh.cells), mesh.region_names
    (['quad', 'triangle'], ('rock', 'core'))
    """

    meshers: Mapping[str, Mesher] = field(hash=False)
    default: Mesher | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.meshers, Mapping) or not self.meshers:
            raise InputError(f"meshers must map names of regions to meshers; got {self.meshers!r}")
        for name, mesher in (*self.meshers.items(), ("default", self.default)):
            is_mesher = callable(getattr(mesher, "generate", None)) and not isinstance(mesher, type)
            if not is_mesher and not (name == "default" and mesher is None):
                raise InputError(
                    f"the mesher of {name!r} must be an object such as Structured(); got {mesher!r}"
                )

    def generate(self, domain: Pslg, size: Any = None, progress: Progress | None = None) -> Mesh:
        """Mesh a domain.

        Parameters
        ----------
        domain : Pslg
            What to mesh.
        size : None, float, mapping, callable or SizeField
            Wanted edge length, for all meshers.
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Raises
        ------
        NameLookupError
            If a name matches no region.
        MeshingError
            If a mesher cannot do its regions, or two meshers cannot agree at an interface.
        """
        if domain.periodic:
            raise InputError("a domain with periodic sides can have one mesher only")
        assembly = Assembly(domain)
        for mesher, regions in self._groups(domain):
            part = subdomain(domain, regions, assembly)
            mesh = mesher.generate(part.domain, size, progress)
            assembly.add(part, mesh, type(mesher).__name__)
        methods = {name: type(m).__name__ for name, m in self.meshers.items()}
        return assembly.finished({"method": "PerRegion", "meshers": methods})

    def _groups(self, domain: Pslg) -> list[tuple[Mesher, np.ndarray]]:
        """Meshers with the regions of each, in the order of meshing."""
        default = DelaunayRefinement() if self.default is None else self.default
        of: list[Mesher] = [default] * len(domain.region_names)
        for name, mesher in self.meshers.items():
            for found in find_names(name, domain.region_names, what="region"):
                of[domain.region_names.index(found)] = mesher
        groups: list[tuple[Mesher, list[int]]] = []
        for region, mesher in enumerate(of):
            for other, members in groups:
                if other == mesher:
                    members.append(region)
                    break
            else:
                groups.append((mesher, [region]))
        groups.sort(key=lambda group: _turn(group[0]))
        return [(mesher, np.array(members)) for mesher, members in groups]


def _turn(mesher: Mesher) -> int:
    """Grids cannot follow others; triangulations follow anything."""
    if isinstance(mesher, Structured):
        return 0
    return 2 if isinstance(mesher, (DelaunayRefinement, ConstrainedDelaunay)) else 1

"""Places on the exact surfaces that the facets of a mesh of space approximate."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.domain.surface_mesh import project_on_pairs
from csgmesh.domain.surfaces import Surfaces
from csgmesh.measures.space.placement import domain_labels, facet_labels
from csgmesh.mesh import KINDS, Mesh
from csgmesh.tolerance import ON_CURVE_SHARE, accuracy, coordinate_ulp

_NONE = np.zeros(0, np.int64)


@dataclass(frozen=True, eq=False)
class ExactSurfaces:
    """The exact surface of each facet of a mesh, found anew from its names and corners.

    Attributes
    ----------
    mesh : Mesh
    surfaces : Surfaces or None
        None for a mesh without a domain, such as one read from a file.
    facet_surface : dict of str to (f,) int64
        Into `surfaces`; -1 for facets whose corners lie on none that carries their names.
    """

    mesh: Mesh
    surfaces: Surfaces | None
    facet_surface: dict[str, np.ndarray]

    @staticmethod
    def of(mesh: Mesh) -> ExactSurfaces:
        """Find the surfaces of a mesh's facets in the domain that it remembers."""
        domain: object = mesh.domain
        if not isinstance(domain, Plc):
            none = {kind: np.full(len(rows), -1) for kind, rows in mesh.facets.items()}
            return ExactSurfaces(mesh, None, none)
        found = {kind: _surfaces_of(mesh, kind, domain) for kind in mesh.facets}
        return ExactSurfaces(mesh, domain.surfaces, found)

    @cached_property
    def nearest(self) -> float:
        """Places no further off than this are on their surface already: rounding."""
        return coordinate_ulp(self.mesh.points)

    def of_facets(self, kind: str, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places near those given of each facet (f, 3) on its surface, and which of them moved."""
        out, on = np.array(places), self.facet_surface[kind]
        known = np.flatnonzero(on >= 0)
        if self.surfaces is None or not len(known):
            return out, np.zeros(len(out), bool)
        return _moved(out, known, self.surfaces.project(on[known], out[known]), self.nearest)

    def of_edges(
        self,
        facet_edges: dict[str, np.ndarray],
        places: np.ndarray,
        wanted: np.ndarray | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Places near those given of each edge (e, 3) on the surfaces of all facets around it.

        Parameters
        ----------
        facet_edges : dict of str to (f, k) int64
            Edges of each facet.
        places : (e, 3) float64
        wanted : (e,) bool, optional
            Edges that are asked for; the others stay. Default: all.

        Returns
        -------
        places : (e, 3) float64
        moved : (e,) bool
            Edges whose place is another one now.
        """
        out = np.array(places)
        if self.surfaces is None or not facet_edges:
            return out, np.zeros(len(out), bool)
        n = len(self.surfaces) + 1
        keys = [
            (edges * n + self.facet_surface[kind][:, None] + 1).ravel()
            for kind, edges in facet_edges.items()
        ]
        edge, on = np.divmod(np.unique(np.concatenate(keys)), n)
        asked = (on > 0) if wanted is None else (on > 0) & wanted[edge]
        edge, on = edge[asked], on[asked] - 1
        first = np.flatnonzero(np.diff(edge, prepend=-1))
        count = np.diff(np.append(first, len(edge)))
        single, several = first[count == 1], first[count > 1]
        foot = np.empty((len(first), 3))
        foot[count == 1] = self.surfaces.project(on[single], out[edge[single]])
        pairs = self._pairs(on, several, count[count > 1], out[edge[several]])
        foot[count > 1] = project_on_pairs(self.surfaces, pairs, out[edge[several]])
        return _moved(out, edge[first], foot, self.nearest)

    def _pairs(
        self, on: np.ndarray, first: np.ndarray, count: np.ndarray, places: np.ndarray
    ) -> np.ndarray:
        """Two of the surfaces on[first : first + count] each, that cross as steeply as possible."""
        assert self.surfaces is not None
        pairs = np.column_stack([on[first], on[first + 1]])
        steepest = np.full(len(first), np.inf)
        for i in range(int(count.max(initial=0))):
            for j in range(i):
                at = np.flatnonzero(count > i)
                a, b = on[first[at] + j], on[first[at] + i]
                normals = [self.surfaces.normals(s, places[at]) for s in (a, b)]
                cosine = np.abs((normals[0] * normals[1]).sum(axis=1))
                steeper = cosine < steepest[at]
                pairs[at[steeper]] = np.column_stack([a, b])[steeper]
                steepest[at[steeper]] = cosine[steeper]
        return pairs


def _moved(
    out: np.ndarray, at: np.ndarray, foot: np.ndarray, nearest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Put those places on their feet that are not there already."""
    far = np.abs(foot - out[at]).max(axis=1, initial=0.0) > nearest
    out[at[far]] = foot[far]
    moved = np.zeros(len(out), bool)
    moved[at[far]] = True
    return out, moved


def _surfaces_of(mesh: Mesh, kind: str, domain: Plc) -> np.ndarray:
    """Surface of each facet of a kind: one with its names, between its regions, at its corners.

    Of several, the one nearest to the facet's middle, then the first.
    """
    corners = mesh.points[mesh.facets[kind][:, : KINDS[kind].n_corners]]
    marker, region = mesh.facet_marker[kind], mesh.facet_region[kind]
    nearest = accuracy(ON_CURVE_SHARE, domain.diagonal, mesh.points)
    out, best = np.full(len(corners), -1), np.full(len(corners), np.inf)
    known = domain_labels(domain)
    for label, own in facet_labels(mesh, marker, region):
        for s in np.unique(domain.facet_surface[known.get(label, _NONE)]).tolist():
            flat = corners[own].reshape(-1, 3)
            off = domain.surfaces.distance(np.full(len(flat), s), flat)
            at = own[(off.reshape(len(own), -1) <= nearest).all(axis=1)]
            middle = domain.surfaces.distance(np.full(len(at), s), corners[at].mean(axis=1))
            nearer = middle < best[at] - nearest
            out[at[nearer]], best[at[nearer]] = s, middle[nearer]
    return out

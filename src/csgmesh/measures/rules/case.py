"""What the rules look at: a mesh, the domain it must mesh, and what is derived from them once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.measures.matching import Matching, match_facets
from csgmesh.measures.quality import Quality, quality
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.topology import Edges, edges_of
from csgmesh.tolerance import ON_CURVE_SHARE, accuracy


@dataclass(frozen=True, eq=False)
class Case:
    """A mesh under examination. Cells and facets are counted through all kinds.

    Attributes
    ----------
    mesh : Mesh
    domain : Pslg or None
        What it must mesh: a freshly evaluated reference, or else what it remembers.
    contains : callable or None
        Region number, into the domain's region names, of points; -1 outside.
    min_angle : float or None
        Bound asked of the angles, degrees.
    """

    mesh: Mesh
    domain: Pslg | None
    contains: Callable[[np.ndarray], np.ndarray] | None
    min_angle: float | None

    @cached_property
    def corners(self) -> dict[str, np.ndarray]:
        """Cells without their mid-side points."""
        return {kind: rows[:, : KINDS[kind].n_corners] for kind, rows in self.mesh.cells.items()}

    @cached_property
    def edges(self) -> Edges:
        """Edges of the cells."""
        return edges_of(self.mesh.cells, self.mesh.n_points)

    @cached_property
    def cell_region(self) -> np.ndarray:
        """Region of each cell, (n_cells,), as the mesh claims."""
        return np.concatenate([_NONE, *self.mesh.cell_region.values()])

    @cached_property
    def facets(self) -> np.ndarray:
        """End points of each facet, (f, 2)."""
        rows = [rows[:, :2] for rows in self.mesh.facets.values()]
        return np.concatenate([np.zeros((0, 2), np.int64), *rows])

    @cached_property
    def facet_nodes(self) -> list[tuple[str, np.ndarray, np.ndarray]]:
        """Kind, numbers and coordinates (k, n, 2) of the facets that are curved."""
        found, before = [], 0
        for kind, rows in self.mesh.facets.items():
            if KINDS[kind].order > 1:
                found.append((kind, before + np.arange(len(rows)), self.mesh.points[rows]))
            before += len(rows)
        return found

    @cached_property
    def facet_edge(self) -> np.ndarray:
        """Edge that each facet is, -1 for none, (f,)."""
        return self.edges.find(self.facets)

    @cached_property
    def facet_marker(self) -> np.ndarray:
        """Marker of each facet, (f,)."""
        return np.concatenate([_NONE, *self.mesh.facet_marker.values()])

    @cached_property
    def facet_region(self) -> np.ndarray:
        """Regions on the left and the right of each facet as the mesh claims, (f, 2)."""
        rows = list(self.mesh.facet_region.values())
        return np.concatenate([np.zeros((0, 2), np.int64), *rows])

    @cached_property
    def facet_curve(self) -> np.ndarray:
        """Curve of each facet as the mesh claims, (f,)."""
        return np.concatenate([_NONE, *self.mesh.facet_curve.values()])

    @cached_property
    def facet_interval(self) -> np.ndarray:
        """Interval of each facet on its curve as the mesh claims, (f, 2)."""
        return np.concatenate([np.zeros((0, 2)), *self.mesh.facet_interval.values()])

    @cached_property
    def quality(self) -> Quality:
        """Measures of the cells."""
        return quality(self.mesh)

    @cached_property
    def diagonal(self) -> float:
        """Diagonal of the domain's box, or of the mesh's."""
        if self.domain is not None:
            return self.domain.diagonal
        extent = np.ptp(self.mesh.points, axis=0) if self.mesh.n_points else np.zeros(2)
        return float(np.hypot(*extent))

    @cached_property
    def tolerance(self) -> float:
        """How far a vertex may be from its exact curve."""
        return accuracy(ON_CURVE_SHARE, self.diagonal, self.mesh.points)

    @cached_property
    def matching(self) -> Matching:
        """The domain's curve under each facet, found from coordinates alone."""
        assert self.domain is not None
        return match_facets(self.domain, self.mesh.points[self.facets], self.tolerance)

    @cached_property
    def region_of_mesh(self) -> np.ndarray:
        """The domain's number of each region of the mesh, -2 for a name it does not have.

        The last entry stands for -1, outside, so that it can be indexed with -1.
        """
        assert self.domain is not None
        numbers = {name: i for i, name in enumerate(self.domain.region_names)}
        return np.array([*(numbers.get(n, -2) for n in self.mesh.region_names), -1])

    def cell_places(self, cells: np.ndarray) -> np.ndarray:
        """Middles of cells, (k, 2)."""
        out, before = np.zeros((len(cells), 2)), 0
        for rows in self.corners.values():
            at = np.flatnonzero((cells >= before) & (cells < before + len(rows)))
            out[at] = self.mesh.points[rows[cells[at] - before]].mean(axis=1)
            before += len(rows)
        return out

    def facet_places(self, facets: np.ndarray) -> np.ndarray:
        """Middles of facets, (k, 2)."""
        return self.mesh.points[self.facets[facets]].mean(axis=1)

    def edge_places(self, edges: np.ndarray) -> np.ndarray:
        """Middles of edges, (k, 2)."""
        return self.mesh.points[self.edges.points[edges]].mean(axis=1)


_NONE = np.zeros(0, np.int64)

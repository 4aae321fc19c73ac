"""What the rules of space look at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.measures.space.placement import Label, domain_labels, facet_labels
from csgmesh.measures.space.quality import SpaceQuality, space_quality
from csgmesh.mesh import KINDS, Mesh
from csgmesh.mesh.faces import Faces, canonical_faces, faces_of
from csgmesh.tolerance import ON_CURVE_SHARE, accuracy

_NONE = np.zeros(0, np.int64)


@dataclass(frozen=True, eq=False)
class SpaceCase:
    """A mesh of space under examination, with what is derived from it once."""

    mesh: Mesh
    domain: Plc | None
    contains: Callable[[np.ndarray], np.ndarray] | None

    @cached_property
    def corners(self) -> dict[str, np.ndarray]:
        """Cells without their mid-side points."""
        return {kind: rows[:, : KINDS[kind].n_corners] for kind, rows in self.mesh.cells.items()}

    @cached_property
    def centres(self) -> np.ndarray:
        """Means of the corners of each cell, (n_cells, 3)."""
        means = [self.mesh.points[rows].mean(axis=1) for rows in self.corners.values()]
        return np.concatenate([np.zeros((0, 3)), *means])

    @cached_property
    def cell_region(self) -> np.ndarray:
        """Region of each cell, and -1 at last, so that it can be indexed with -1."""
        return np.concatenate([*self.mesh.cell_region.values(), [-1]]).astype(np.int64)

    @cached_property
    def faces(self) -> Faces:
        """Faces of the cells."""
        return faces_of(self.mesh.cells)

    @cached_property
    def quality(self) -> SpaceQuality:
        """Measures of the cells."""
        return space_quality(self.mesh)

    @cached_property
    def facets(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of each facet in canonical order, (f, 4), and whether it runs that way."""
        rows, ways = [np.zeros((0, 4), np.int64)], [np.zeros(0, bool)]
        for kind, facet in self.mesh.facets.items():
            ordered, forwards = canonical_faces(facet[:, : KINDS[kind].n_corners])
            rows.append(ordered)
            ways.append(forwards)
        return np.concatenate(rows), np.concatenate(ways)

    @cached_property
    def facet_face(self) -> np.ndarray:
        """Face that each facet is, -1 for none, (f,)."""
        return self.faces.find(self.facets[0])

    @cached_property
    def facet_kind(self) -> np.ndarray:
        """Kind of each facet, (f,)."""
        facets = self.mesh.facets
        return np.repeat(np.array(list(facets), str), [len(rows) for rows in facets.values()])

    @cached_property
    def facet_marker(self) -> np.ndarray:
        """Marker of each facet, (f,)."""
        return np.concatenate([_NONE, *self.mesh.facet_marker.values()])

    @cached_property
    def facet_region(self) -> np.ndarray:
        """Regions behind and in front of each facet, as the mesh claims, (f, 2)."""
        return np.concatenate([np.zeros((0, 2), np.int64), *self.mesh.facet_region.values()])

    @cached_property
    def labels(self) -> list[tuple[Label, np.ndarray]]:
        """Names and regions of facets, and which facets have them."""
        return facet_labels(self.mesh, self.facet_marker, self.facet_region)

    @cached_property
    def triangles(self) -> np.ndarray:
        """Facets cut into triangles with the facets' orientation, and their facets, (t, 4)."""
        rows, ways = self.facets
        number = np.arange(len(rows))
        quad = rows[:, 3] >= 0
        parts = [
            np.column_stack([rows[:, [0, 1, 2]], number]),
            np.column_stack([rows[quad][:, [0, 2, 3]], number[quad]]),
        ]
        out = np.concatenate(parts)
        turned = ~ways[out[:, 3]]
        out[turned] = out[turned][:, [0, 2, 1, 3]]
        return out

    @cached_property
    def tolerance(self) -> float:
        """How far a vertex may be from its exact surface."""
        assert self.domain is not None
        return accuracy(ON_CURVE_SHARE, self.domain.diagonal, self.mesh.points)

    @cached_property
    def corners_off(self) -> np.ndarray:
        """How far the corners of each facet are at the most from the surface it names, (f,)."""
        rows = self.facets[0]
        return self.off_surfaces(self.mesh.points[np.where(rows < 0, rows[:, :1], rows)])

    def off_surfaces(self, places: np.ndarray) -> np.ndarray:
        """Largest distance of each facet's places (f, k, 3) from one surface it names, (f,).

        Infinite for facets with names, or between regions, that no facet of the domain has.
        """
        domain = self.domain
        assert domain is not None
        out = np.full(len(places), np.inf)
        k = places.shape[1]
        known = domain_labels(domain)
        for label, own in self.labels:
            on = known.get(label, _NONE)
            flat = places[own].reshape(-1, 3)
            for s in np.unique(domain.facet_surface[on]).tolist():
                off = domain.surfaces.distance(np.full(len(flat), s), flat).reshape(-1, k)
                out[own] = np.minimum(out[own], off.max(axis=1))
        return out

    def face_places(self, faces: np.ndarray) -> np.ndarray:
        """Middles of faces, (k, 3)."""
        return _middles(self.mesh.points, self.faces.points[faces])

    def facet_places(self, facets: np.ndarray) -> np.ndarray:
        """Middles of facets, (k, 3)."""
        return _middles(self.mesh.points, self.facets[0][facets])


def _middles(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    three = points[rows[:, :3]].sum(axis=1)
    quad = rows[:, 3] >= 0
    three[quad] += points[rows[quad, 3]]
    return three / np.where(quad, 4.0, 3.0)[:, None]

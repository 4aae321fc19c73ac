"""Meshes of regions, glued where they share edges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import MeshingError
from csgmesh.mesh import Mesh
from csgmesh.mesh.blocks import Block
from csgmesh.meshers.per_region.subdomain import Subdomain
from csgmesh.meshers.per_region.unsplitting import unsplit


class Assembly:
    """What is meshed so far.

    Attributes
    ----------
    is_done : (n_regions,) bool
    points : (n, 2)
    facets : (f, 2) int64
        Each with the first of `sides` on its left.
    sides, marker, curve, interval
        Of the facets, as in the given domain.
    """

    def __init__(self, domain: Pslg) -> None:
        self.domain = domain
        self.is_done = np.zeros(len(domain.region_names), bool)
        self.points = np.zeros((0, 2))
        self.point_marker = np.zeros(0, np.int64)
        self.facets = np.zeros((0, 2), np.int64)
        self.sides = np.zeros((0, 2), np.int64)
        self.marker = np.zeros(0, np.int64)
        self.curve = np.zeros(0, np.int64)
        self.interval = np.zeros((0, 2))
        self.cells: dict[str, list[np.ndarray]] = {}
        self.regions: dict[str, list[np.ndarray]] = {}
        self.blocks: list[tuple[str, str, Block]] = []
        self.deviation = domain.deviation

    def region_at(self, points: np.ndarray) -> np.ndarray:
        """Region of the given domain that points lie in."""
        if not len(points):
            return np.zeros(0, np.int64)
        from csgmesh.domain.rays import UpwardRays

        domain = self.domain
        above = UpwardRays(domain.points, domain.segments).first(points)
        ends = domain.points[domain.segments[above], 0]
        below = np.where(ends[:, 0] < ends[:, 1], *domain.segment_region[above, ::-1].T)
        return np.asarray(np.where(above < 0, -1, below))

    def interface(self, regions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """All points, and the facets that have one of the regions on their far side."""
        return self.points, np.flatnonzero(np.isin(self.sides[:, 1], regions))

    def pieces(
        self, facets: np.ndarray, is_in: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Facets as segments of the other side: ends, regions, markers."""
        sides = self.sides[facets]
        turned = np.stack([sides[:, 1], np.full(len(facets), -1)], axis=1)
        return self.facets[facets, ::-1], turned, self.marker[facets]

    def add(self, part: Subdomain, mesh: Mesh, who: str) -> None:
        """Take a mesh of some regions in."""
        mesh = unsplit(mesh, part.given[mesh.facet_marker["line"]] >= 0, who)
        line, marker = mesh.facets["line"], mesh.facet_marker["line"]
        given = part.given[marker]
        number = np.full(mesh.n_points, -1)
        old = np.flatnonzero(given >= 0)
        number[line[old]] = self.facets[given[old], ::-1]
        self._match_corners(mesh, line, number)
        new = np.flatnonzero(number < 0)
        number[new] = len(self.points) + np.arange(len(new))
        self.points = np.concatenate([self.points, mesh.points[new]])
        probe = np.where(mesh.point_marker >= 0, part.marker[mesh.point_marker], -1)
        self.point_marker = np.concatenate([self.point_marker, probe[new]])
        own = np.flatnonzero(given < 0)
        sides = mesh.facet_region["line"][own].copy()
        open_ = sides[:, 1] < 0
        sides[open_, 1] = part.other[marker[own[open_]]]
        self.facets = np.concatenate([self.facets, number[line[own]]])
        self.sides = np.concatenate([self.sides, sides])
        self.marker = np.concatenate([self.marker, part.marker[marker[own]]])
        self.curve = np.concatenate([self.curve, mesh.facet_curve["line"][own]])
        self.interval = np.concatenate([self.interval, mesh.facet_interval["line"][own]])
        n_before = {kind: sum(map(len, rows)) for kind, rows in self.cells.items()}
        for kind, rows in mesh.cells.items():
            self.cells.setdefault(kind, []).append(number[rows])
            self.regions.setdefault(kind, []).append(mesh.cell_region[kind])
            self.is_done[np.unique(mesh.cell_region[kind])] = True
        for name, block in mesh.blocks.items():
            kind = next(iter(mesh.cells))
            cells = block.cells + n_before.get(kind, 0)
            self.blocks.append((kind, name, Block(cells, number[block.points])))
        if mesh.domain is not None:
            self.deviation = max(self.deviation, mesh.domain.deviation)

    def _match_corners(self, mesh: Mesh, line: np.ndarray, number: np.ndarray) -> None:
        """Points of facets that touch what is there in a vertex only."""
        if not len(self.facets):
            return
        known = {tuple(self.points[v]): v for v in np.unique(self.facets).tolist()}
        for v in np.unique(line).tolist():
            if number[v] < 0:
                number[v] = known.get(tuple(mesh.points[v]), -1)

    def finished(self, info: Mapping[str, object]) -> Mesh:
        """All regions as one mesh."""
        if not self.is_done.all():
            raise MeshingError(
                f"region {self.domain.region_names[int(np.argmin(self.is_done))]!r} was not meshed"
            )
        turned = (self.sides[:, 1] >= 0) & (self.sides[:, 1] < self.sides[:, 0])

        def oriented(pairs: np.ndarray) -> np.ndarray:
            return np.where(turned[:, None], pairs[:, ::-1], pairs)

        domain = self.domain
        if self.deviation > domain.deviation:
            values = {name: getattr(domain, name) for name in domain.__dataclass_fields__}
            domain = Pslg.build(**(values | {"deviation": self.deviation}))
        offset, before = {}, 0
        for kind, rows in self.cells.items():
            offset[kind] = before
            before += sum(map(len, rows))
        return Mesh(
            points=self.points,
            cells={kind: np.concatenate(rows) for kind, rows in self.cells.items()},
            cell_region={kind: np.concatenate(rows) for kind, rows in self.regions.items()},
            region_names=domain.region_names,
            facets={"line": oriented(self.facets)},
            facet_marker={"line": self.marker},
            boundary_names=domain.boundary_names,
            facet_region={"line": oriented(self.sides)},
            facet_curve={"line": self.curve},
            facet_interval={"line": oriented(self.interval)},
            point_marker=self.point_marker,
            curves=domain.curves,
            domain=domain,
            info=info,
            blocks={
                name: Block(block.cells + offset[kind], block.points)
                for kind, name, block in self.blocks
            },
        )

"""Delaunay refinement: quality triangles of any domain, with exact curved boundaries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError, InputError
from csgmesh.mesh import Mesh
from csgmesh.meshers.assembly import assemble
from csgmesh.meshers.constrained_delaunay import triangulated
from csgmesh.meshers.refiner import Refiner
from csgmesh.meshers.subdivision import pieces_by_turning
from csgmesh.meshers.workspace import Progress, Workspace

LARGEST_MIN_ANGLE = 34.0


@dataclass(frozen=True)
class DelaunayRefinement:
    min_angle: float = 30.0
    gradation: float = 0.3
    max_points: int = 10**7

    def generate(self, domain: Pslg, size=None, progress: Progress | None = None) -> Mesh:
        pieces = pieces_by_turning(domain)
        work = triangulated(domain, pieces, progress)
        refiner = Refiner(work, self.min_angle, self.max_points)
        if size is not None:
            refiner.number[4] = float(size) ** 2
        done = refiner.run()
        refiner.publish()
        return assemble(work, {})

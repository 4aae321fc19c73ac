"""Meshes of sizes that vary: a coarse mesh finds the sizes out, a second one follows them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NoReturn

import numpy as np

from csgmesh.domain.input_angles import SharpCorners
from csgmesh.domain.pslg import Pslg
from csgmesh.errors import BudgetError
from csgmesh.meshers.background import Background, Spacing
from csgmesh.meshers.bands import lay_bands
from csgmesh.meshers.constrained_delaunay import triangulated
from csgmesh.meshers.lattice import Blocks, lay_lattice
from csgmesh.meshers.lower_bound import least_points
from csgmesh.meshers.refiner import Refiner
from csgmesh.meshers.sizing import OVER_BUDGET, POINTS_PER_AREA, Sizing, feature_sizes
from csgmesh.meshers.subdivision import Spaced, Subdivision, pieces_by_turning
from csgmesh.meshers.workspace import Progress, Workspace
from csgmesh.size.resolve import ResolvedSize

#: Where the size is more than this share of what a segment asks for, the segment decides.
SHORT = 0.99
Lay = Callable[[Subdivision], Blocks | None]
#: Adds points to a domain for an edge length, where sizes, if there are any yet, are that large.
Seed = Callable[[Pslg, float, Background | None], Pslg]


class Meshing:
    """One run of the mesher, which can be stopped with the mesh so far.

    New vertices are placed frontally, as far from an edge as their size asks for. For that sizes
    must be known away from the boundary before anything is placed there: a first mesh with edges a
    few times too long finds them out, and is thrown away.
    """

    def __init__(
        self,
        domain: Pslg,
        corners: SharpCorners,
        limits: tuple[float, float, int],
        progress: Progress | None,
        seed: Seed | None = None,
    ) -> None:
        self.domain = domain
        self.seed = seed
        self.corners = corners
        self.min_angle, self.gradation, self.max_points = limits
        self.progress = progress
        self.work: Workspace
        self.refiner: Refiner

    def start(
        self, pieces: np.ndarray, spacing: Spaced | None = None, lay: Lay | None = None
    ) -> None:
        """Triangulate the domain, with its segments cut into pieces."""
        self.work = triangulated(self.domain, pieces, self.progress, spacing, lay)

    def prepare(self) -> None:
        """Make a refiner of what is triangulated."""
        self.refiner = Refiner(self.work, self.corners, self.min_angle, self.max_points)

    def without_size(self) -> bool:
        """Follow the features alone; False when the budget of points ran out."""
        self.start(pieces_by_turning(self.domain))
        self.prepare()
        return self.refiner.run()

    def uniform(self, size: float) -> bool:
        """Mesh with one size which no feature undercuts."""
        pieces = np.rint(self.domain.lengths() / size).astype(np.int64)
        if self.seed is not None:
            self.domain = self.seed(self.domain, size, None)
            self.start(self._at_least(pieces))
        else:
            self.start(self._at_least(pieces), lay=lambda cut: lay_lattice(self.domain, cut, size))
        self.prepare()
        self.refiner.set_uniform(size)
        self.refiner.go_depth_first()
        return self.refiner.run()

    def graded(self, size: ResolvedSize, feature: np.ndarray) -> bool:
        """Mesh with sizes that vary."""
        self.start(pieces_by_turning(self.domain))
        self.prepare()
        self.refiner.set_sizes()
        sizing = Sizing(self.refiner, size, feature, self.gradation)
        if not sizing.approach():
            return False
        ground = Background.of(self.work, self.refiner.size)
        at = self.work.rank[: len(feature)]
        # Edges shorter than wanted would be carried far inside by a search in depth.
        is_even = not (ground.size[at] > SHORT * feature).any()
        spacing = self._spacing()
        pieces = self._at_least(np.rint(spacing.edges).astype(np.int64))
        spacing.even = pieces > np.maximum(np.rint(spacing.edges), 1)
        fixed = np.array(size.constants)
        if self.seed is None:
            self.start(pieces, spacing, lambda cut: lay_bands(self.domain, cut, ground, fixed))
        else:
            if size.uniform is not None:
                self.domain = self.seed(self.domain, size.uniform, ground)
            self.start(pieces, spacing)
        self.prepare()
        self.refiner.set_background(ground)
        if is_even and self.work.has_lattice:
            self.refiner.go_depth_first()
        if not self.refiner.run():
            return False
        return Sizing(self.refiner, size, feature, self.gradation).confirm()

    def _at_least(self, pieces: np.ndarray) -> np.ndarray:
        """As many pieces as curves ask for; segments at sharp corners are left to the shells."""
        pieces[self.corners.is_sharp_end.any(axis=1)] = 1
        return np.maximum(pieces, pieces_by_turning(self.domain))

    def _spacing(self) -> Spacing:
        refiner, n = self.refiner, self.refiner.n_sub
        ends = refiner.ends[: 2 * n].reshape(-1, 2)
        across = np.diff(self.work.points.reshape(-1, 2)[ends], axis=1)[:, 0]
        return Spacing(
            self.domain,
            refiner.segments(),
            refiner.interval[: 2 * n].reshape(-1, 2),
            np.hypot(across[:, 0], across[:, 1]),
            refiner.size[ends],
        )

    def run(self, size: ResolvedSize | None) -> bool:
        """Mesh the domain; False when the budget of points ran out."""
        least, region = least_points(self.domain, self.corners, self.min_angle)
        if least > self.max_points:
            self._refuse(
                f"region {self.domain.region_names[region]!r} is so flat that angles of "
                f"{self.min_angle:g} degrees take {least:.2g} points at least"
            )
        if size is None:
            return self.without_size()
        feature = feature_sizes(self.domain)
        if size.uniform is None:
            return self.graded(size, feature)
        expected = float(self.domain.chord_areas().sum()) * POINTS_PER_AREA / size.uniform**2
        if expected > OVER_BUDGET * self.max_points:
            self._refuse(
                f"a size of {size.uniform:g} asks for about {expected:.2g} points in a domain "
                f"{self.domain.diagonal:.3g} across"
            )
        if feature.min() >= size.uniform:
            return self.uniform(size.uniform)
        return self.graded(size, feature)

    def _refuse(self, reason: str) -> NoReturn:
        """Give up before any refinement."""
        self.start(pieces_by_turning(self.domain))
        self.prepare()
        raise BudgetError(f"{reason}; max_points is {self.max_points}")

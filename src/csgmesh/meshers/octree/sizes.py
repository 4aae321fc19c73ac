"""Sizes in space: what is asked for, what the boundary needs, and how fast both may grow."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.domain.plc import Plc
from csgmesh.errors import BudgetError
from csgmesh.meshers.octree.demands import LARGEST_SHARE, SizeDemands
from csgmesh.meshers.octree.thin_walls import ThinWalls, thin_walls
from csgmesh.size.field import Source, UniformSize
from csgmesh.size.resolve import resolve
from csgmesh.tree import LinearTree

#: Side of the cubes of a body-centred lattice whose edges are one long on average: of the fourteen
#: edges at a point eight are sqrt(3)/2 of the side long, six as long as the side.
CUBE = 14.0 / (8.0 * np.sqrt(0.75) + 6.0)
#: A uniform size that nothing undercuts by more than this is taken to be uniform.
NEARLY = 0.85
_MOST_PASSES = 64


@dataclass(frozen=True, eq=False)
class SpaceSizes:
    """Wanted edge length h(x) in a solid, a callable of points (n, 3).

    At each leaf of an octree the size is known as the value of a source and the distance from it,
    so that it grows by `gradation` per unit of length from where it is small.

    Attributes
    ----------
    domain : Plc
    uniform : float or None
        The one size of a mesh that is alike everywhere.
    largest : float
        No size is larger.
    gradation : float
    wanted : callable or None
        What was asked for, apart from boundaries.
    tree : LinearTree
        Empty of meaning where the size is uniform.
    value : (n,) float64
        Size at the centre of each leaf by itself.
    source : (n,) int64
        Leaf from which each leaf's size grows.
    is_free : (n,) uint8
        Leaves where nothing but what was asked for counts.
    given : SizeDemands
        What the sizes were made of.
    walls : ThinWalls or None
        Thin walls that were found.

    Examples
    --------
    >>> import csgmesh as cm
    >>> domain = cm.evaluate(cm.Box((0, 0, 0), (1, 1, 1)))
    >>> SpaceSizes.of(domain, {"box.left": 0.05, "default": 0.2}, 0.3, 10**6)(
    ...     np.array([[0.0, 0.5, 0.5], [0.3, 0.5, 0.5], [1.0, 0.5, 0.5]])).round(2)
    array([0.05, 0.15, 0.2 ])
    """

    domain: Plc
    uniform: float | None
    largest: float
    gradation: float
    wanted: Source | None
    tree: LinearTree
    value: np.ndarray
    source: np.ndarray
    is_free: np.ndarray
    given: SizeDemands
    walls: ThinWalls | None = None

    @classmethod
    def of(cls, domain: Plc, size: Any, gradation: float, max_points: int) -> SpaceSizes:
        """Sizes of a domain from a `size=` argument.

        Raises
        ------
        SizeError, NameLookupError
            If the size is not positive and finite somewhere in the domain, or names nothing.
        BudgetError
            If it asks for far more than `max_points` points.
        """
        asked = resolve(size, domain)  # type: ignore[arg-type]
        return cls.made(SizeDemands.of(domain, asked), gradation, max_points)

    @classmethod
    def made(cls, given: SizeDemands, gradation: float, max_points: int) -> SpaceSizes:
        """Sizes from demands."""
        domain = given.domain
        base = given.base
        uniform = base.value if isinstance(base, UniformSize) else None
        largest = LARGEST_SHARE * domain.diagonal if base is None else np.inf
        if uniform is not None:
            largest = uniform
            check_budget(float(domain.volumes().sum()) / uniform**3, max_points, domain, uniform)
        root = root_of(domain, uniform)
        if uniform is not None and given.least >= NEARLY * uniform:
            none = np.zeros(0)
            return cls(domain, uniform, uniform, gradation, None, root, none, none, none, given)
        tree = given.grown(root, largest, max_points)
        value, is_free = given.at_leaves(tree, largest)
        source = spread(tree, value, gradation)
        out = cls(
            domain,
            None,
            largest,
            gradation,
            None if uniform is not None else base,
            tree,
            value,
            source,
            is_free,
            given,
        )
        out._check_budget(max_points)
        return out

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Wanted edge length at each of `points` (n, 3), as (n,)."""
        if self.uniform is not None:
            return np.full(len(points), self.uniform)
        flat = np.ascontiguousarray(points, np.float64).reshape(-1)
        flat = flat if flat.flags.writeable else flat.copy()
        out = np.empty(len(points))
        tree = self.tree
        kernels.sizes_at(
            tree.key,
            tree.level,
            flat,
            tree.unit,
            self.value,
            self.source,
            self.is_free,
            self.gradation,
            out,
        )
        np.minimum(out, self.largest, out=out)
        if self.wanted is not None:
            np.minimum(out, self.given.ask(points), out=out)
        return out

    def fit_for_walls(self, across: int, points: int, max_points: int) -> SpaceSizes:
        """The sizes, no larger than cells `across` thin walls ask for.

        Walls share in so many `points`. Where they ask for more points than `max_points` all the
        same, they get larger sizes, or are left alone.
        """
        while across and points:
            found = thin_walls(self.domain, self, across, points)
            if found is None:
                break
            if not len(found.size):
                return replace(self, walls=found)
            given = self.given.joined(found.triangles, found.size)
            try:
                return replace(SpaceSizes.made(given, self.gradation, max_points), walls=found)
            except BudgetError:
                points //= 4
        return self

    def smaller_at(self, points: np.ndarray, share: float, max_points: int) -> SpaceSizes:
        """The sizes with `share` of what they are now at some points (k, 3)."""
        given = self.given.joined(np.repeat(points[:, None], 3, axis=1), share * self(points))
        return replace(SpaceSizes.made(given, self.gradation, max_points), walls=self.walls)

    def _check_budget(self, max_points: int) -> None:
        """Refuse sizes that ask for more points than allowed, by the volumes of leaves inside."""
        lo, extent = self.tree.boxes()
        size = self(lo + 0.5 * extent)
        share = extent.prod(axis=1) / size**3
        where = lo + 0.5 * extent
        oracle = self.domain.oracle
        if oracle is not None:
            share = np.where(oracle.region(where) >= 0, share, 0.0)
            smallest = float(size.min(initial=np.inf, where=share > 0))
            check_budget(float(share.sum()), max_points, self.domain, smallest)


def root_of(domain: Plc, uniform: float | None) -> LinearTree:
    """A cube around a domain; leaves of some level have the side that fits a uniform size.

    The side is rounded to 20 bits and the corner to a 2^-12th of it: then no coordinate of the
    lattice is rounded, and exact tests settle its many points on one sphere by plain arithmetic.
    """
    low, high = domain.bounds()
    width = float((high - low).max())
    side = CUBE * (uniform if uniform is not None else 0.01 * width)
    mantissa, exponent = np.frexp(side)
    side = float(np.ldexp(np.round(mantissa * 2.0**20), exponent - 20))
    n = 2.0 ** np.ceil(np.log2(max(width / side + 2.0, 2.0)))
    unit = 2.0**-12 * side
    corner = np.round((0.5 * (low + high) - 0.5 * n * side) / unit) * unit
    return LinearTree.root(corner, np.full(3, n * side))


def spread(tree: LinearTree, value: np.ndarray, gradation: float) -> np.ndarray:
    """Leaf from which each leaf's size grows, so that no size grows faster than the gradation."""
    source = np.arange(tree.n_leaves)
    for turn in range(_MOST_PASSES):
        if not kernels.spread_sizes(
            tree.key, tree.level, tree.unit, value, source, gradation, turn % 2
        ):
            break
    return source


def check_budget(cubes: float, max_points: int, domain: Plc, smallest: float) -> None:
    """Refuse sizes that fill more cubes of their own length than the points allowed can.

    Raises
    ------
    BudgetError
        With the estimate.
    """
    estimate = 2.0 * cubes / CUBE**3
    if estimate > max_points:
        low, high = domain.bounds()
        box = " to ".join(
            "(" + ", ".join(f"{c:.6g}" for c in corner) + ")" for corner in (low, high)
        )
        raise BudgetError(
            f"the size asks for about {estimate:.3g} points, max_points allows {max_points:,}; "
            f"sizes go down to {smallest:.3g} in the box {box}"
        )

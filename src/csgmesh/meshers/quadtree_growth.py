"""The tree of a domain: as fine as its size, its curves and its gaps ask for."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.handmade import FaceOracle
from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.quadtree_sampling import bent_segments, leaf_sizes, leaves_at
from csgmesh.meshers.subdivision import Subdivision, pieces_by_turning, subdivide
from csgmesh.size.resolve import ResolvedSize, evaluate
from csgmesh.tree import LinearTree
from csgmesh.tree.growth import Features, Growth, RegionOf

#: Largest leaf of a graded tree as a share of the size. Leaves are powers of two, so that edges
#: come out between half of this and 1.4 times it.
GRADED = 1.24
#: Largest leaf beside a segment of the domain, as a share of the segment's length.
SEGMENT = 1.6
#: Most different sides that a leaf may have for the sake of sides of the domain on its own.
STRETCH = 1.12
#: Leaves of a graded tree whose sizes are sampled on a grid this fine, relative to the root.
SAMPLED = 32
#: A bent piece is cut where leaves beside it are this much smaller.
TOO_LONG = 1.5
ROUNDS = 12
MOST_PIECES = 4096
#: Pieces of a bent segment whose ends tell how far it reaches.
BOUNDS_PIECES = 16


def cell_numbers(domain: Pslg, side: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Size and number of cells of a grid that fits the domain's box as well as it can.

    Parameters
    ----------
    side : float or None
        Wanted; without one, as few cells as come near to squares.
    """
    lo, hi = curved_bounds(domain)
    width = hi - lo
    if side is None:
        tries = np.arange(1, 9)
        n = np.maximum(np.rint(width[:, None] / (width.min() / tries)), 1)
        cells = width[:, None] / n
        stretch = cells.max(axis=0) / cells.min(axis=0)
        best = int(np.argmax(stretch < 1.02)) if (stretch < 1.02).any() else int(stretch.argmin())
        n, cell = n[:, best], cells[:, best]
    else:
        n = np.maximum(np.rint(width / side), 1)
        cell = width / n
    reference = side if side is not None else float(cell.min())
    if cell.max() / cell.min() > STRETCH:
        cell = np.full(2, reference)
        n = np.ceil(width / cell)
    return cell, n.astype(np.int64)


def curved_bounds(domain: Pslg) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the box of the domain's curves, which chords do not reach everywhere."""
    parts = np.where(bent_segments(domain), BOUNDS_PIECES, 1)
    points = subdivide(domain, parts).points
    return points.min(axis=0), points.max(axis=0)


def root_of(domain: Pslg, side: float | None) -> tuple[LinearTree, int]:
    """A root whose leaves of a level, which is returned too, are the cells of such a grid."""
    cell, n = cell_numbers(domain, side)
    # One cell more than needed: no vertex that counts lies on the far sides of the root.
    level = int(np.ceil(np.log2(n.max() + 1)))
    return LinearTree.root(curved_bounds(domain)[0], cell * 2.0**level), level


class Grower:
    """Makes the tree of a domain and a size.

    Parameters
    ----------
    domain : Pslg
    size : ResolvedSize or None
    scale : float
        Leaves wanted, as a share of the size.
    budget : int
        Bound on the number of leaves.
    parts : int
        Into how many parts each edge along a curve will be cut afterwards.
    """

    def __init__(
        self, domain: Pslg, size: ResolvedSize | None, scale: float, budget: int, parts: int
    ) -> None:
        self.domain, self.size, self.scale, self.budget = domain, size, scale, budget
        self.chord = np.where(bent_segments(domain), parts, 1) * domain.lengths()
        self.uniform = None if size is None else size.uniform
        side = None if self.uniform is None else scale * self.uniform
        self.root, self.level = root_of(domain, side)
        self.parts = self._first_parts()
        self.finer: list[tuple[np.ndarray, np.ndarray]] = []

    def grown(self, width: int) -> Growth:
        """A balanced tree; chords of curves are nowhere much longer than the leaves beside them."""
        for _ in range(ROUNDS):
            pieces = subdivide(self.domain, self.parts)
            growth = Growth(self.root, self._features(pieces), self._regions(pieces))
            growth.grow(self._is_coarse, self.budget)
            tree, region = growth.tree.balance(True, width, growth.region, self.budget)
            assert region is not None
            growth.tree, growth.region = tree, region
            if not self._cut_long(pieces, tree):
                break
        return growth

    def refine_at(self, points: np.ndarray, size: np.ndarray) -> None:
        """Ask for smaller leaves at points, in trees still to be grown."""
        self.finer.append((points, size))

    def _first_parts(self) -> np.ndarray:
        """Into how many pieces each segment is cut: by turning, and by the size along it."""
        domain, size = self.domain, self.size
        parts = pieces_by_turning(domain)
        if size is None:
            return parts
        middle = subdivide(domain, np.full(domain.n_segments, 2)).points[domain.n_points :]
        wanted = np.full(domain.n_segments, np.inf)
        bent = bent_segments(domain)
        if size.default is not None:
            wanted[bent] = evaluate(size.default, middle[bent])
        for markers, source in size.boundary:
            at = np.isin(domain.segment_marker, markers)
            wanted[at] = np.minimum(wanted[at], evaluate(source, middle[at]))
        more = np.ceil(domain.lengths() / (GRADED * self.scale * wanted))
        return np.maximum(parts, np.clip(more, 1, MOST_PIECES).astype(np.int64))

    def _features(self, pieces: Subdivision) -> Features:
        domain, segment = self.domain, pieces.segment
        ends = pieces.points[pieces.ends]
        wanted = SEGMENT * self.chord[segment]
        middle = ends.mean(axis=1)
        loose = np.flatnonzero(domain.point_marker >= 0)
        if self.size is not None:
            for markers, source in self.size.boundary:
                at = np.isin(domain.segment_marker[segment], markers)
                value = GRADED * self.scale * evaluate(source, middle[at])
                wanted[at] = np.minimum(wanted[at], value)
        chord = ends[:, 1] - ends[:, 0]
        length = domain.lengths()[segment] * np.diff(pieces.share, axis=1)[:, 0]
        slack = np.sqrt(np.maximum(length**2 - (chord**2).sum(axis=1), 0.0))
        at = domain.points[loose]
        return Features(
            np.concatenate([ends, np.stack([at, at], axis=1)]),
            np.r_[slack, np.zeros(len(loose))],
            np.concatenate([domain.segments[segment], np.column_stack([loose, loose])]),
            np.array(domain.points),
            np.concatenate([domain.segment_region[segment], np.zeros((len(loose), 2), np.int64)]),
            np.r_[wanted, self._wanted_at(loose)],
        )

    def _wanted_at(self, loose: np.ndarray) -> np.ndarray:
        """Largest leaf at embedded points that a size names."""
        out = np.full(len(loose), np.inf)
        if self.size is not None:
            for markers, source in self.size.boundary:
                at = np.isin(self.domain.point_marker[loose], markers)
                value = GRADED * self.scale * evaluate(source, self.domain.points[loose[at]])
                out[at] = np.minimum(out[at], value)
        return out

    def _regions(self, pieces: Subdivision) -> RegionOf:
        sides = self.domain.segment_region[pieces.segment]
        return FaceOracle(pieces.points, pieces.ends, sides).region

    def _is_coarse(self, growth: Growth, leaves: np.ndarray) -> np.ndarray:
        lo, extent = growth.tree[leaves].boxes()
        side = extent.max(axis=1)
        out = self._asked(growth, leaves, lo, extent)
        if self.size is None:
            return out
        if self.uniform is not None:
            return out | (growth.tree.level[leaves] < self.level)
        return out | (side > GRADED * self.scale * self._smallest(growth, leaves, lo, extent))

    def _asked(
        self, growth: Growth, leaves: np.ndarray, lo: np.ndarray, extent: np.ndarray
    ) -> np.ndarray:
        """Leaves larger than was asked for at points in them."""
        out = np.zeros(len(leaves), bool)
        for points, size in self.finer:
            at = leaves_at(growth.tree, points)
            row = np.minimum(np.searchsorted(leaves, at), len(leaves) - 1)
            here = leaves[row] == at
            row, size = row[here], size[here]
            out[row[extent[row].max(axis=1) > size]] = True
        return out

    def _smallest(
        self, growth: Growth, leaves: np.ndarray, lo: np.ndarray, extent: np.ndarray
    ) -> np.ndarray:
        """Smallest size at sample points of leaves; coarse ones get more of them."""
        assert self.size is not None
        out = np.full(len(leaves), np.inf)
        level = growth.tree.level[leaves]
        for deep in np.unique(level):
            at = np.flatnonzero(level == deep)
            k = max(SAMPLED >> int(deep), 2)
            grid = (np.arange(k) + 0.5) / k
            share = np.stack(np.meshgrid(grid, grid), axis=-1).reshape(-1, 2)
            for part in np.array_split(at, max(len(at) * k * k // 1_000_000, 1)):
                points = lo[part, None] + share * extent[part, None]
                value = self._sizes(growth, leaves[part], points.reshape(-1, 2), k * k)
                out[part] = value.reshape(len(part), k * k).min(axis=1)
        return out

    def _sizes(
        self, growth: Growth, leaves: np.ndarray, points: np.ndarray, each: int
    ) -> np.ndarray:
        """Sizes at points, `each` of them in every leaf, in the regions that the leaf is in."""
        assert self.size is not None
        default = np.full(len(points), np.inf)
        if self.size.default is not None:
            default = evaluate(self.size.default, points)
        if not self.size.region:
            return default
        row, feature = growth.features_of(leaves)
        sides = growth.features.sides[feature]
        region = growth.region[leaves]
        out = np.full((len(leaves), each), np.inf)
        seen = np.zeros(len(leaves), bool)
        covered = np.zeros(len(self.domain.region_names), bool)
        for regions, source in self.size.region:
            covered[regions] = True
            inside = np.isin(region, regions)
            inside[row[np.isin(sides, regions).any(axis=1)]] = True
            at = np.flatnonzero(inside)
            where = points.reshape(len(leaves), each, 2)[at].reshape(-1, 2)
            out[at] = np.minimum(out[at], evaluate(source, where).reshape(-1, each))
        plain = (region >= 0) & ~covered[np.maximum(region, 0)]
        other = (sides >= 0) & ~covered[np.maximum(sides, 0)]
        plain[row[other.any(axis=1)]] = True
        seen |= plain
        return np.where(seen[:, None], np.minimum(out, default.reshape(-1, each)), out).ravel()

    def _cut_long(self, pieces: Subdivision, tree: LinearTree) -> bool:
        """Double the pieces of bent segments beside smaller leaves; whether there were any."""
        domain = self.domain
        bent = np.flatnonzero(bent_segments(domain)[pieces.segment])
        ends = pieces.points[pieces.ends[bent]]
        length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
        long = length > TOO_LONG * leaf_sizes(tree, ends.mean(axis=1))
        segments = np.unique(pieces.segment[bent[long]])
        self.parts[segments] *= 2
        return bool(len(segments))

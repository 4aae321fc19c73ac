"""Which facets may touch which leaves, found without looking at pairs of facets.

A plane that has a facet on one side and a whole leaf on the other keeps them apart, but for corners
that both have in it; so pairs of facets need to be looked at only where no such plane is found.
Planes are those of a convex leaf's facets around a common corner, those of flat faces, and those
tangent to the box, cylinder or ball around a leaf in the coordinates of its own axes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.neighbours import distinct
from csgmesh.boundary.shells import CLEAR, Shells, outside

#: A corner is off a plane if it is higher than this share of its distance from the corner in the
#: plane: then what is near the plane is near that corner.
_SLOPE = 1e-4

#: A facet whose height is a smaller share of its length does not say which plane it is in.
_NEEDLE = 1e-6

#: Leaves of more faces than this are looked at as a whole.
_FEW_FACES = 8

#: Facets looked at together, and pairs of facets and leaves: a few tens of megabytes.
_BLOCK = 64
_CHUNK = 1 << 19


@dataclass(frozen=True, eq=False)
class Sides:
    """Facets that take part: corners (m, 3) into points, surfaces, layers and leaves (m,)."""

    points: np.ndarray
    triangles: np.ndarray
    surface: np.ndarray
    layer: np.ndarray
    leaf: np.ndarray


@dataclass(frozen=True, eq=False)
class Contacts:
    """Which facets may touch other facets of which leaves: keys ``facet * n_leaves + leaf``."""

    n_leaves: int
    leaf: np.ndarray
    keys: np.ndarray

    @property
    def facets(self) -> np.ndarray:
        """Facets that may touch any, (k,)."""
        return distinct(self.keys // self.n_leaves)

    def among(self, pairs: np.ndarray) -> np.ndarray:
        """Those pairs of facets (k, 2) of which each may touch the other's leaf."""
        for a, b in ((0, 1), (1, 0)):
            key = pairs[:, a] * self.n_leaves + self.leaf[pairs[:, b]]
            pairs = pairs[_found(self.keys, key)]
        return pairs


def contacts(sides: Sides, known: Shells, snap: float) -> Contacts:
    """Find which facets no plane keeps apart from which leaves."""
    n = len(known.lo)
    beyond_leaf, beyond_face = _apart_at_corners(sides, known, snap)
    own = _own(sides, known, beyond_face, snap)
    found = [own * n + sides.leaf[own]]
    for facet, leaf in _boxes_met(sides, known, snap):
        keep = ~_found(beyond_leaf, facet * n + leaf)
        facet, leaf = facet[keep], leaf[keep]
        keep = ~outside(sides.points, sides.triangles[facet], leaf, known, snap)
        facet, leaf = facet[keep], leaf[keep]
        keep = ~_beside_faces(sides, known, facet, leaf, beyond_face, snap)
        found.append(facet[keep] * n + leaf[keep])
    keys = distinct(np.concatenate(found))
    # Both must be open to the other.
    one, two = sides.leaf[keys // n], keys % n
    ways = distinct(one * n + two)
    return Contacts(n, sides.leaf, keys[_found(ways, two * n + one)])


def _found(keys: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Which of the wanted numbers are among the sorted keys."""
    if not len(keys):
        return np.zeros(len(wanted), bool)
    at = np.searchsorted(keys, wanted)
    at[at == len(keys)] = 0
    return keys[at] == wanted


def _apart_at_corners(sides: Sides, known: Shells, snap: float) -> tuple[np.ndarray, np.ndarray]:
    """Facets kept apart by the plane of a facet with a corner in common.

    Keys of facet and leaf, where the leaf is convex and the facet above; and of facet and surface,
    where the surface is flat and the facet on either side.
    """
    points, triangles = sides.points, sides.triangles
    n_faces = len(known.leaf)
    sheet = (sides.layer + 1) * n_faces + sides.surface
    low = np.full(len(points), np.iinfo(np.int64).max)
    high = np.full(len(points), -1)
    for k in range(3):
        np.minimum.at(low, triangles[:, k], sheet)
        np.maximum.at(high, triangles[:, k], sheet)
    at = np.flatnonzero((low < high)[triangles].ravel())
    vertex = triangles.ravel()[at]
    order = np.argsort(vertex, kind="stable")
    vertex, facet = vertex[order], at[order] // 3
    begin = np.searchsorted(vertex, vertex)
    count = np.searchsorted(vertex, vertex, side="right") - begin
    corner = points[triangles]
    normal, is_plane = _normals(corner)
    by_leaf, by_face = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for i, j in _spread(begin, count):
        f, g = facet[i], facet[j]
        keep = (sheet[f] != sheet[g]) & is_plane[g]
        keep &= known.is_flat[sides.surface[g]] | known.is_convex[sides.leaf[g]]
        f, g, v = f[keep], g[keep], vertex[i[keep]]
        foot = points[v]
        above = below = np.ones(len(f), bool)
        for k in range(3):
            c = triangles[f, k]
            way = points[c] - foot
            rise = np.einsum("kj,kj->k", way, normal[g])
            least = np.maximum(CLEAR * snap, _SLOPE * np.sqrt(np.einsum("kj,kj->k", way, way)))
            common = (triangles[g] == c[:, None]).any(axis=1)
            above = above & (common | (rise > least))
            below = below & (common | (rise < -least))
        other = sides.leaf[f] != sides.leaf[g]
        whole = above & other & known.is_convex[sides.leaf[g]]
        by_leaf.append(f[whole] * len(known.lo) + sides.leaf[g[whole]])
        half = (above | below) & known.is_flat[sides.surface[g]]
        by_face.append(f[half] * n_faces + sides.surface[g[half]])
    return distinct(np.concatenate(by_leaf)), distinct(np.concatenate(by_face))


def _normals(corner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit normals of facets, and which of these can be trusted."""
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = np.cross(u, v)
    size = np.sqrt((normal * normal).sum(axis=1))
    w = v - u
    longest = np.maximum(np.maximum((u * u).sum(axis=1), (v * v).sum(axis=1)), (w * w).sum(axis=1))
    return normal / np.maximum(size, 1e-300)[:, None], size > _NEEDLE * longest


def _spread(begin: np.ndarray, count: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs of each row with the rows from `begin` on, `count` of them, some at a time."""
    total = np.cumsum(count)
    whole = int(total[-1]) if len(total) else 0
    cuts = np.searchsorted(total, np.arange(_CHUNK, whole + _CHUNK, _CHUNK))
    before = 0
    for cut in distinct(np.append(cuts + 1, len(begin))).tolist():
        part = slice(before, min(cut, len(begin)))
        before = part.stop
        times = count[part]
        i = np.repeat(np.arange(part.start, part.stop), times)
        j = np.repeat(begin[part] - np.cumsum(times) + times, times) + np.arange(len(i))
        yield i, j


def _boxes_met(sides: Sides, known: Shells, snap: float) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Facets and other leaves whose boxes overlap, some at a time."""
    corner = sides.points[sides.triangles]
    lo, hi = corner.min(axis=1) - CLEAR * snap, corner.max(axis=1) + CLEAR * snap
    size = np.ptp(sides.points, axis=0).max() * (1.0 + 1e-9)
    cell = ((0.5 * (lo + hi) - sides.points.min(axis=0)) * (31.0 / size)).astype(np.int64)
    order = np.argsort(sides.leaf * (1 << 15) + _interleaved(np.clip(cell, 0, 31)), kind="stable")
    start = np.arange(0, len(order), _BLOCK)
    block_lo = np.minimum.reduceat(lo[order], start)
    block_hi = np.maximum.reduceat(hi[order], start)
    present = distinct(sides.leaf)
    for part in np.array_split(present, -(-len(start) * len(present) // _CHUNK)):
        met = np.ones((len(part), len(start)), bool)
        for axis in range(3):
            met &= known.lo[part, axis, None] <= block_hi[:, axis]
            met &= known.hi[part, axis, None] >= block_lo[:, axis]
        leaf, block = np.nonzero(met)
        leaf = part[leaf]
        count = np.minimum(_BLOCK, len(order) - start[block])
        for row, at in _spread(start[block], count):
            facet, other = order[at], leaf[row]
            keep = sides.leaf[facet] != other
            for axis in range(3):
                facet, other = facet[keep], other[keep]
                keep = (lo[facet, axis] <= known.hi[other, axis]) & (
                    hi[facet, axis] >= known.lo[other, axis]
                )
            yield facet[keep], other[keep]


def _interleaved(cell: np.ndarray) -> np.ndarray:
    """Morton codes of cells (k, 3) below 32."""
    out = np.zeros(len(cell), np.int64)
    for bit in range(5):
        for axis in range(3):
            out |= ((cell[:, axis] >> bit) & 1) << (3 * bit + axis)
    return out


def _faces_of(known: Shells) -> tuple[np.ndarray, np.ndarray]:
    """First surface and number of surfaces of each leaf."""
    first = np.searchsorted(known.leaf, np.arange(len(known.lo) + 1))
    return first[:-1], np.diff(first)


def _beside_faces(
    sides: Sides,
    known: Shells,
    facet: np.ndarray,
    leaf: np.ndarray,
    beyond_face: np.ndarray,
    snap: float,
) -> np.ndarray:
    """Which facets are on one side of each face of a leaf that has few and flat ones."""
    first, count = _faces_of(known)
    n_bent = np.bincount(known.leaf[~known.is_flat], minlength=len(first))
    out = np.zeros(len(facet), bool)
    some = np.flatnonzero((count[leaf] <= _FEW_FACES) & (n_bent[leaf] == 0))
    left = np.ones(len(some), bool)
    for k in range(_FEW_FACES):
        at = np.flatnonzero(left & (k < count[leaf[some]]))
        f, s = facet[some[at]], first[leaf[some[at]]] + k
        left[at] = _beside(sides, known, f, s, beyond_face, snap)
    out[some] = left
    return out


def _beside(
    sides: Sides,
    known: Shells,
    facet: np.ndarray,
    face: np.ndarray,
    beyond_face: np.ndarray,
    snap: float,
) -> np.ndarray:
    """Which facets are on one side of the plane of a face, but for common corners."""
    corner = sides.points[sides.triangles[facet]]
    rise = np.einsum("kij,kj->ki", corner, known.normal[face]) - known.height[face][:, None]
    least = CLEAR * snap
    clear = (rise > least).all(axis=1) | (rise < -least).all(axis=1)
    clear[~clear] = _found(beyond_face, facet[~clear] * len(known.leaf) + face[~clear])
    return clear


def _own(sides: Sides, known: Shells, beyond_face: np.ndarray, snap: float) -> np.ndarray:
    """Facets that may touch others of their own leaf that lie on other faces or in other layers.

    Each facet is to be on one side of all flat faces of its leaf but its own. Then a face that is
    not flat must be the only one.
    """
    first, count = _faces_of(known)
    n_bent = np.bincount(known.leaf[~known.is_flat], minlength=len(first))
    m = len(sides.leaf)
    low, high = np.full(len(first), m), np.full(len(first), -2)
    np.minimum.at(low, sides.leaf, sides.layer)
    np.maximum.at(high, sides.leaf, sides.layer)
    is_open = (low < high) | (count > _FEW_FACES) | (n_bent > 1)
    for k in range(_FEW_FACES):
        face = first[sides.leaf] + k
        at = np.flatnonzero(~is_open[sides.leaf] & (k < count[sides.leaf]))
        at = at[(face[at] != sides.surface[at]) & known.is_flat[face[at]]]
        clear = _beside(sides, known, at, face[at], beyond_face, snap)
        is_open[sides.leaf[at[~clear]]] = True
    return np.flatnonzero(is_open[sides.leaf])

"""Lattice tetrahedra that go into the mesh as they are.

A tetrahedron of the body-centred cubic lattice has a sphere of its own: no fifth point of the
lattice lies on it. So if no other point lies inside either, every Delaunay tetrahedralisation of
all points has it, and none needs to be computed there. Only the points on the rim of the kept
ones have to be inserted: a tetrahedron outside has all its corners among these and the surface's,
and an empty sphere, so it is Delaunay among these alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels

#: Tetrahedra around a vertex in the middle of the lattice.
_STAR = 24


@dataclass(frozen=True, eq=False)
class Kept:
    """Kept tetrahedra and what they have in common with the others.

    Attributes
    ----------
    tets : (t, 4) int64
        Of positive volume, in numbers of the inner points.
    is_inserted : (k,) bool
        Inner points that are not wholly among kept tetrahedra.
    walls : (f, 3) int64
        Faces of one kept tetrahedron only, counterclockwise seen from outside.
    owner : (f,) int64
        That tetrahedron.
    """

    tets: np.ndarray
    is_inserted: np.ndarray
    walls: np.ndarray
    owner: np.ndarray

    @classmethod
    def of(cls, tets: np.ndarray, n: int) -> Kept:
        """What tetrahedra (t, 4) among n points are."""
        is_rim = np.bincount(tets.reshape(-1), minlength=n) != _STAR
        rims = is_rim.view(np.int8)
        near = np.flatnonzero(
            rims[tets[:, 0]] + rims[tets[:, 1]] + rims[tets[:, 2]] + rims[tets[:, 3]] >= 3
        )
        sides = tets[near][:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
        on_rim = np.flatnonzero(rims[sides[:, 0]] & rims[sides[:, 1]] & rims[sides[:, 2]])
        sides, owner = sides[on_rim], near[on_rim // 4]
        # Numbers of points have 26 bits: the two larger ones of a side are one key, and sides with
        # the same two lie together, whatever the third.
        a, b, c = sides.T
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        middle = a + b + c - low - high
        order = np.lexsort([low, high << 32 | middle])
        key, low = (high << 32 | middle)[order], low[order]
        differs = np.ones(len(key) + 1, bool)
        differs[1:-1] = (key[1:] != key[:-1]) | (low[1:] != low[:-1])
        single = order[differs[1:] & differs[:-1]]
        return cls(tets, is_rim, sides[single], owner[single])

    def without(self, bad: np.ndarray) -> Kept:
        """The same without some tetrahedra."""
        return Kept.of(np.delete(self.tets, np.unique(bad), axis=0), len(self.is_inserted))

    def parts(self) -> np.ndarray:
        """Component of the kept tetrahedra that each inner point belongs to, (k,) int64."""
        part = np.empty(len(self.is_inserted), np.int64)
        kernels.tetra_components(np.ascontiguousarray(self.tets).reshape(-1), part)
        return part

    def regions(self, outside: np.ndarray) -> np.ndarray:
        """Region of each kept tetrahedron from what lies outside each wall (f,), (t,) int64."""
        if not len(self.tets) or (outside == outside[0]).all():
            return np.full(len(self.tets), outside[0] if len(outside) else 0, np.int64)
        part = self.parts()
        region = np.full(len(part), -1)
        region[part[self.walls[:, 0]]] = outside
        return np.asarray(region[part[self.tets[:, 0]]])

"""The shell around the kernels of tetrahedra: arrays that grow, interruptions."""

from __future__ import annotations

import numpy as np

from csgmesh import kernels

# What the kernel returns.
_ROOM, _SLICE, _DUPLICATE, _COPLANAR, _TETS = 1, 2, 4, 7, 10

#: Tetrahedra that a cavity may hold before its buffers have to grow; most hold fewer than forty.
_CAVITY = 4096
#: Slots a point needs, at first: there are 6.8 tetrahedra a point where points lie at random.
_SLOTS = 7.5
#: Longest ring of an edge that flips look at.
_WIDEST = 16
#: How far the box around a domain is, in diagonals: far enough that the spheres of large flat
#: triangles of the surface do not reach its corners.
_FAR = 4.0
#: Numbers of points share a 64-bit key with their place on a curve, and four corners of 6.8
#: tetrahedra a point must have a 31-bit number.
MOST_POINTS = 2**26


class Net:
    """Delaunay tetrahedra of points, in the kernels' arrays.

    Vertices are numbered in the order of their insertion: `order` leads to the numbers of the
    points, `rank` back. Coordinates are scaled by a power of two, which rounds nothing; `diagonal`
    is that of the points' box.
    """

    def __init__(self, points: np.ndarray, *, has_box: bool) -> None:
        largest = float(np.abs(points).max()) if points.size else 1.0
        given = points * 2.0 ** -np.frexp(largest)[1] if largest > 0.0 else points
        span = given.max(axis=0) - given.min(axis=0) if len(given) else np.zeros(3)
        self.diagonal = float(np.sqrt((span * span).sum()))
        if has_box:
            given = np.vstack([given, _box(given)])
        self.n_points = len(points)
        self.order = kernels.space_order(given)
        self.rank = np.empty_like(self.order)
        self.rank[self.order] = np.arange(len(self.order))
        self.xyz = given[self.order].reshape(-1)
        slots = int(_SLOTS * len(given)) + 64
        self.vert, self.nei = np.empty(4 * slots, np.int32), np.empty(4 * slots, np.int32)
        self.mark, self.free = np.empty(slots, np.int32), np.empty(slots, np.int32)
        self.work = np.empty((2, _CAVITY), np.int32)
        self.counts = np.zeros(9, np.int64)
        self._homes: np.ndarray | None = None

    @property
    def n_slots(self) -> int:
        """Slots in use, some of them empty."""
        return int(self.counts[1])

    def insert(self) -> bool:
        """Insert all points; False if two are the same, see `twins`, or all lie in a plane."""
        while True:
            status = kernels.insert_in_space(
                self.xyz,
                self.vert,
                self.nei,
                self.mark,
                self.free,
                self.work,
                self.counts,
                len(self.order),
            )
            if status == _ROOM:
                self.widen()
            elif status == _TETS:
                self.grow()
            elif status != _SLICE:
                return status not in (_DUPLICATE, _COPLANAR)

    @property
    def twins(self) -> tuple[int, int] | None:
        """The two points that stopped `insert` because they are the same."""
        if self.counts[1] == 0:
            return None
        i, j = sorted((int(self.order[self.counts[6]]), int(self.order[self.counts[0]])))
        return i, j

    def widen(self) -> None:
        """Double the buffers of a cavity."""
        self.work = np.empty((2, 2 * self.work.shape[1]), np.int32)

    def grow(self) -> None:
        """Make half as much room again for tetrahedra."""
        have = len(self.mark)
        slots = have * 3 // 2 + 8192
        for name, width in (("vert", 4), ("nei", 4), ("mark", 1), ("free", 1)):
            longer = np.empty(width * slots, np.int32)
            longer[: width * have] = getattr(self, name)
            setattr(self, name, longer)

    @property
    def homes(self) -> np.ndarray:
        """A tetrahedron of each vertex."""
        if self._homes is None:
            self._homes = np.empty(len(self.order), np.int32)
            kernels.vertex_homes(self.vert, self._homes, self.n_slots)
        return self._homes

    def recover(self, triangles: np.ndarray, missing: np.ndarray) -> int:
        """Flip until missing ones (k,) of triangles (m, 3) are faces; how many were done.

        No triangle that is a face already ceases to be one.
        """
        corners = self.rank[triangles]
        edges = np.ascontiguousarray(corners[:, [0, 1, 1, 2, 2, 0]]).reshape(-1)
        stays = np.full(4 << len(edges).bit_length(), -1, np.int64)
        kernels.mark_edges(edges, stays)
        wanted = np.ascontiguousarray(corners[missing]).reshape(-1)
        ring, worth = np.empty((4, 4 * _WIDEST), np.int64), np.empty(_WIDEST**2)
        apex, state = np.empty(_WIDEST**2, np.int64), np.zeros(2, np.int64)
        while True:
            status = kernels.recover_triangles(
                self.xyz,
                self.vert,
                self.nei,
                self.mark,
                self.free,
                self.homes,
                stays,
                self.work,
                ring,
                apex,
                worth,
                self.counts,
                wanted,
                state,
            )
            if status == _ROOM:
                self.widen()
            elif status == _TETS:
                self.grow()
            elif status != _SLICE:
                return int(state[1])

    def faces(self, triangles: np.ndarray) -> np.ndarray:
        """Where triangles (k, 3) of points are faces, (k,) int64; -1 where there is no such."""
        out = np.empty(len(triangles), np.int64)
        counts = np.array([0, self.counts[8]])
        corners = self.rank[triangles].reshape(-1)
        while kernels.find_faces(
            self.vert, self.nei, self.mark, self.homes, corners, out, self.work, counts
        ):
            self.widen()
        self.counts[8] = counts[1]
        return out

    def flood(
        self, triangles: np.ndarray, where: np.ndarray, sides: np.ndarray, stops: np.ndarray
    ) -> tuple[np.ndarray, int]:
        """Region of each slot, -2 where no triangle leads, and what the kernel says.

        Parameters
        ----------
        triangles : (m, 3) int64
            Walls.
        where : (m,) int64
            Faces that these are.
        sides : (m, 2) int64
            Regions behind and in front of each.
        stops : (f,) int64
            Faces that are walls, too.
        """
        n = self.n_slots
        region, stack = np.empty(n, np.int32), np.empty(n, np.int32)
        wall = np.empty(4 * n, np.uint8)
        status = kernels.flood_space(
            self.xyz,
            self.vert,
            self.nei,
            wall,
            self.rank[triangles].reshape(-1),
            where,
            stops,
            np.ascontiguousarray(sides, np.int64).reshape(-1),
            region,
            stack,
            n,
        )
        return region, int(status)

    def across(self, triangles: np.ndarray, faces: np.ndarray) -> np.ndarray:
        """Corner that sees each triangle (k, 3), a face, from its front, (k,) int64."""
        other = self.nei[faces].astype(np.int64)
        corners = np.column_stack([self.rank[triangles], self.vert[faces]])
        is_front = kernels.tetra_orientations(self.xyz.reshape(-1, 3), corners) > 0
        return np.where(is_front, faces, other)

    def cells(self) -> tuple[np.ndarray, np.ndarray]:
        """Tetrahedra (m, 4) of all slots in numbers of the points, and which of them are any."""
        rows = self.vert[: 4 * self.n_slots].reshape(-1, 4)
        return rows, (rows[:, 0] >= 0) & (rows[:, 3] >= 0)


def _box(points: np.ndarray) -> np.ndarray:
    """Eight corners of a box far around points.

    Their coordinates are small multiples of a power of two, as those of many points are: exact
    zeros are found sooner among such.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    reach = _FAR * float(np.sqrt(((high - low) ** 2).sum()))
    unit = 2.0 ** (np.frexp(reach)[1] - 6)
    low, high = np.floor((low - reach) / unit), np.ceil((high + reach) / unit)
    return np.array([np.where([k & 1, k & 2, k & 4], high, low) for k in range(8)]) * unit

"""The part of a mesh of tetrahedra around its bad cells, as the kernels want it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.domain.surface_mesh import ON_CURVE, ON_FACE
from csgmesh.improve.tetrahedra.chords import Chords

Progress = Callable[[str, int, int], None]

# Kinds of vertices in the kernels.
FREE, SLIDING, ALONG, FIXED, FROZEN = range(5)
#: Mark of vertices at the end of a piece.
OUTER = 3
# Places in the kernels' `count`.
NEXT, DONE, VERTICES, WISHES, THOROUGH = 2, 3, 7, 29, 30
# Rooms that the kernels need: cells of a star or cavity, vertices of a ring, row of a table.
WIDEST, LONGEST, ROW = 96, 9, 12
#: Room for more cells and vertices, as shares of those there are.
MORE_CELLS, MORE_VERTICES = 0.25, 0.02


class Piece:
    """Cells near the bad ones, cut out and connected.

    Parameters
    ----------
    points, tets, region
        The whole mesh.
    scores : (m,) float64
        Shapes of the tetrahedra.
    chords : Chords
        The surface; its triangles change with the work.
    wide : bool
        Whether to take two layers of cells around the bad ones, so that cells which come of their
        treatment can be treated, too; else one.
    bars : (3,) float64
        Shape that cells are treated to reach, shape where a vertex may stop moving, and shape below
        which vertices may come and go.
    """

    def __init__(
        self,
        points: np.ndarray,
        tets: np.ndarray,
        region: np.ndarray,
        scores: np.ndarray,
        chords: Chords,
        wide: bool,
        bars: np.ndarray,
    ) -> None:
        mark = np.zeros(len(points), np.int8)
        chosen = np.zeros(len(tets), np.int8)
        kernels.choose_cells(tets.reshape(-1), scores, bars[0], int(wide), mark, chosen)
        self.chords = chords
        self.chosen = chosen != 0
        self.vertices = np.flatnonzero(mark)
        self.n = len(self.vertices)
        number = np.full(len(points), -1)
        number[self.vertices] = np.arange(self.n)
        local = number[chords.triangles]
        self.walls = np.flatnonzero((local >= 0).all(axis=1))
        begin, segment = _neighbours(number[chords.surface.segments], self.n)
        self.arrays = _arrays(
            xyz=points[self.vertices],
            kind=self._kinds(mark[self.vertices]),
            corner=number[tets[self.chosen]],
            region=region[self.chosen],
            score=scores[self.chosen],
            triangle=local[self.walls].reshape(-1).astype(np.int32),
            face=chords.face[self.walls].astype(np.int32),
            normal=chords.normals[self.walls].reshape(-1),
            limit=chords.limit,
            segment_begin=begin,
            segment=segment,
            number=bars,
        )

    def _kinds(self, mark: np.ndarray) -> np.ndarray:
        surface = self.chords.surface
        kind = np.full(self.n, FREE, np.int8)
        on = np.flatnonzero(self.vertices < surface.n_points)
        dim = surface.point_dim[self.vertices[on]]
        kind[on] = np.where(dim == ON_FACE, SLIDING, np.where(dim == ON_CURVE, ALONG, FIXED))
        kind[mark == OUTER] = FROZEN
        return kind

    def work(self, rounds: int, thorough: bool, progress: Progress | None) -> int:
        """Treat the bad cells, then let vertices slide along the surface, a few times.

        Returns how often anything got better.
        """
        self.arrays.count[THOROUGH] = thorough
        total = 0
        for _ in range(rounds):
            done = self._treat(progress) + self._slide()
            total += done
            if not done or not len(self._bad()):
                break
        return total

    def _bad(self) -> np.ndarray:
        """Cells below the bar, the worst first."""
        score = self.arrays.score
        bad = np.flatnonzero(score <= self.arrays.number[0])
        return bad[np.argsort(score[bad], kind="stable")].astype(np.int32)

    def _treat(self, progress: Progress | None) -> int:
        count, bad = self.arrays.count, self._bad()
        count[[NEXT, DONE]] = 0
        while kernels.treat_cells(self.arrays, bad):
            if progress is not None:
                progress("improve", int(count[NEXT]), len(bad))
        return int(count[DONE])

    def _slide(self) -> int:
        """Let vertices of bad cells on the surface have better places there; how many moved."""
        a, bad = self.arrays, self._bad()
        a.count[[NEXT, DONE, WISHES]] = 0
        busy = np.zeros(len(a.kind), np.int8)
        while kernels.wish_moves(a, bad, busy):
            pass
        return self.settle(kernels.grant_wishes)

    def settle(self, decide: Callable[[Any, np.ndarray], None]) -> int:
        """Put the wishes on the exact surface and move where `decide` lets them; how many moved.

        No two wishes are of one triangle.
        """
        a, n = self.arrays, int(self.arrays.count[WISHES])
        if not n:
            return 0
        wishing = a.wish[:n].astype(np.int64)
        places = a.moves.reshape(-1, 3)
        places[:n] = self.chords.surface.project(self.vertices[wishing], places[:n])
        triangles = a.triangle.reshape(-1, 3)
        normals = a.normal.reshape(-1, 3, 3)
        refused, row, column, new = self.chords.refused(
            triangles, a.face, normals, a.xyz.reshape(-1, 3), wishing, places[:n]
        )
        moved = (~refused).astype(np.int8)
        decide(a, moved)
        number = np.zeros(len(a.kind), np.int64)
        number[wishing] = np.arange(n)
        kept = moved[number[triangles[row, column]]] != 0
        normals[row[kept], column[kept]] = new[kept]
        return int(moved.sum())

    def put_back(
        self, points: np.ndarray, tets: np.ndarray, region: np.ndarray, scores: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The whole mesh with this piece as it is now; the surface is brought up to date, too.

        The arrays given are written to, so that the good cells of a large mesh stay where they are.
        """
        a = self.arrays
        n, n_now = self.n, int(a.count[VERTICES])
        xyz = a.xyz.reshape(-1, 3)
        number = np.concatenate([self.vertices, len(points) + np.arange(n_now - n)])
        points = np.concatenate([points, xyz[n:n_now]])
        points[self.vertices] = xyz[:n]
        corner = a.corner.reshape(-1, 4)
        used = corner[:, 0] >= 0
        places = np.flatnonzero(self.chosen)
        tets = _replaced(tets, places, number[corner[used]])
        region = _replaced(region, places, a.region[used])
        scores = _replaced(scores, places, a.score[used])
        self.chords.triangles[self.walls] = self.vertices[a.triangle.reshape(-1, 3)]
        self.chords.normals[self.walls] = a.normal.reshape(-1, 3, 3)
        return points, tets, region, scores


def _replaced(rows: np.ndarray, places: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Rows of which those at `places`, ascending, are taken by new ones, more or fewer."""
    n, k = len(places), len(new)
    if k >= n:
        rows[places] = new[:n]
        return np.concatenate([rows, new[n:]]) if k > n else rows
    rows[places[:k]] = new
    # The last rows move to where nothing is left.
    free, length = places[k:], len(rows) - (n - k)
    stay = np.ones(n - k, bool)
    stay[free[free >= length] - length] = False
    rows[free[free < length]] = rows[length:][stay]
    return rows[:length]


def _neighbours(ends: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Other ends of the segments (k, 2) of each of n vertices: where they begin, and all of them.

    Segments with an end -1 are left out.
    """
    ends = ends[(ends >= 0).all(axis=1)]
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[np.lexsort((ends[:, 1], ends[:, 0]))]
    begin = np.zeros(n + 1, np.int32)
    np.cumsum(np.bincount(ends[:, 0], minlength=n), out=begin[1:])
    return begin, ends[:, 1].astype(np.int32)


def _arrays(xyz: np.ndarray, corner: np.ndarray, kind: np.ndarray, **given: np.ndarray) -> Any:
    """The kernels' arrays with room for more, their cells connected."""
    n, m = len(xyz), len(corner)
    room = m + int(MORE_CELLS * m) + 500
    vertex_room = n + int(MORE_VERTICES * n) + 50
    i32 = np.int32
    arrays = kernels.Piece(
        xyz=_longer(xyz, 3 * vertex_room, 0, np.float64),
        kind=_longer(kind, vertex_room, FROZEN, np.int8),
        of_vertex=np.full(vertex_room, -1, i32),
        changed=np.zeros(vertex_room, i32),
        corner=_longer(corner, 4 * room, -1, i32),
        mate=np.full(4 * room, -1, i32),
        wall=np.full(4 * room, -1, i32),
        region=_longer(given.pop("region"), room, -1, i32),
        score=_longer(given.pop("score"), room, 2.0, np.float64),
        tried=np.full(room, -1, i32),
        mark=np.zeros(room, i32),
        star=np.zeros(WIDEST, i32),
        ring=np.zeros(LONGEST + 1, i32),
        ring_cell=np.zeros(LONGEST + 1, i32),
        spoke=np.zeros(LONGEST + 1, i32),
        split=np.zeros(2 * ROW * ROW, i32),
        span=np.zeros(ROW * ROW),
        fresh=np.zeros(8 * WIDEST, i32),
        fresh_region=np.zeros(2 * WIDEST, i32),
        slot=np.zeros(2 * WIDEST, i32),
        border=np.zeros(5 * 8 * WIDEST, i32),
        link=np.zeros(9 * 2 * WIDEST),
        value=np.zeros(2 * WIDEST),
        slope=np.zeros(3 * 16),
        place=np.zeros(6),
        wish=np.zeros(n, i32),
        moves=np.zeros(3 * n),
        count=_longer(np.array([0, 0, 0, 0, m, -1, room, n, vertex_room]), 32, 0, np.int64),
        **given,
    )
    table = np.full(1 << max(int(4 * m).bit_length() + 1, 6), -1, i32)
    kernels.connect_cells(
        arrays.corner, arrays.mate, arrays.wall, arrays.of_vertex, arrays.triangle, m, table
    )
    kernels.fix_pinched(arrays, m, np.zeros(n, i32))
    return arrays


def _longer(start: np.ndarray, size: int, value: float, dtype: type) -> np.ndarray:
    out: np.ndarray = np.full(size, value, dtype)
    out[: start.size] = start.ravel()
    return out

"""A mesh of triangles taken apart into the kernels' arrays, and put together again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from csgmesh import kernels
from csgmesh.errors import InputError
from csgmesh.improve.boundary_vertices import FIXED, FREE, SLIDING, classify_boundary
from csgmesh.mesh import Mesh

Progress = Callable[[str, int, int], None]

#: Edges stay between these shares of the wanted length, or what they are if that is worse: a
#: little within the [0.6, 1.6] that is promised for nearly all edges.
SHORTEST, LONGEST = 0.62, 1.55

# Room that the kernels need: triangles of a star, entries of the log, vertices of a crowd.
WIDEST, LOG_ROOM, CROWD = 24, 4096, 40

# Places in the kernels' `count` and `number`.
EFFORT, NEXT, DONE, SWEEPS, ROUNDS, LIMIT = 1, 2, 3, 5, 6, 7
GOAL, EASY = 3, 4


class Workpiece:
    """Vertices, half-edges and facets of a mesh under improvement.

    Parameters
    ----------
    mesh : Mesh
        Of triangles.
    size : float or None
        Wanted edge length; without one, at each vertex the mean length of its edges.
    pinned : (k,) int64
        Vertices that must not move.
    """

    def __init__(self, mesh: Mesh, size: float | None, pinned: np.ndarray) -> None:
        check_triangles(mesh)
        self.mesh = mesh
        n, m = mesh.n_points, len(mesh.cells["triangle"])
        facets = mesh.facets.get("line", np.zeros((0, 2), np.int64))
        curves, curve = mesh.curves, mesh.facet_curve.get("line", np.zeros(0, np.int64))
        xy = np.array(mesh.points).reshape(-1)
        origin = mesh.cells["triangle"].astype(np.int32).reshape(-1)
        twin, line = np.full(3 * m, -1, np.int32), np.full(3 * m, -1, np.int32)
        edge_of = np.full(n, -1, np.int32)
        kernels.pair_half_edges(
            origin, twin, edge_of, np.empty(3 * m, np.int32), facets.astype(np.int32).ravel(), line
        )
        region = mesh.cell_region["triangle"].astype(np.int32)
        around = np.full((n, 2), -1, np.int32)
        kind = np.full(n, FREE, np.int8)
        if len(facets):
            classify_boundary(mesh, facets, kind, around)
        _fix_bare_edges(origin, twin, line, region, kind)
        kind[pinned] = FIXED
        deviation = mesh.domain.deviation if mesh.domain is not None else 0.0
        self.arrays = kernels.Arrays(
            xy=xy,
            origin=origin,
            twin=twin,
            line=line,
            region=region,
            edge_of=edge_of,
            kind=kind,
            around=around.reshape(-1),
            interval=np.array(mesh.facet_interval.get("line", np.zeros((0, 2)))).reshape(-1),
            curve=curve.astype(np.int32),
            curve_kind=np.zeros(0, np.int8) if curves is None else np.array(curves.kind),
            curve_data=np.zeros(0) if curves is None else np.array(curves.data).reshape(-1),
            size=np.full(n, 0.0 if size is None else float(size)),
            ring=np.empty(4 * WIDEST),
            log=np.empty(2 * LOG_ROOM, np.int32),
            past=np.empty(3 * LOG_ROOM),
            crowd=np.empty(CROWD, np.int32),
            stamp=np.zeros(n, np.int32),
            failed=np.full(m, -1, np.int32),
            count=np.zeros(8, np.int64),
            number=np.array([deviation, SHORTEST, LONGEST, 0.0, 0.0]),
        )
        length = self.measure()
        if size is None:
            self.arrays.size[:] = length

    def measure(self) -> np.ndarray:
        """Find the quality of the triangles; returns the mean edge length at each vertex."""
        arrays = self.arrays
        n = len(arrays.kind)
        length, degree = np.zeros(n), np.zeros(n, np.int32)
        self.quality = np.empty(len(arrays.failed))
        kernels.measure(arrays.xy, arrays.origin, self.quality, length, degree)
        return length / np.maximum(degree, 1)

    def treat(self, sweeps: int, rounds: int, progress: Progress | None) -> int:
        """Treat all triangles beyond the goal, the worst first; how many got better."""
        count = self.arrays.count
        self.measure()
        bad = np.flatnonzero(self.quality > self.arrays.number[GOAL])
        if not len(bad):
            return 0
        bad = bad[np.argsort(-self.quality[bad], kind="stable")].astype(np.int32)
        count[[NEXT, DONE, SWEEPS, ROUNDS]] = 0, 0, sweeps, rounds
        while kernels.treat_triangles(self.arrays, bad):
            if progress is not None:
                progress("improve", int(count[NEXT]), len(bad))
        return int(count[DONE])

    def smooth(self, optimal: bool, progress: Progress | None) -> int:
        """Move all vertices towards the centres of their stars; how many moved."""
        count = self.arrays.count
        count[[NEXT, DONE]] = 0
        while kernels.smooth_vertices(self.arrays, int(optimal)):
            if progress is not None:
                progress("smooth", int(count[NEXT]), len(self.arrays.kind))
        return int(count[DONE])

    def slid(self) -> np.ndarray:
        """Sliding vertices that have moved."""
        moved = (self.arrays.xy.reshape(-1, 2) != self.mesh.points).any(axis=1)
        return np.flatnonzero(moved & (self.arrays.kind == SLIDING))

    def finished(self) -> Mesh:
        """The mesh as it is now; what names and regions say stays as it was."""
        arrays = self.arrays
        intervals = {"line": arrays.interval.reshape(-1, 2)} if "line" in self.mesh.facets else {}
        return replace(
            self.mesh,
            points=arrays.xy.reshape(-1, 2),
            cells={"triangle": arrays.origin.reshape(-1, 3)},
            facet_interval=intervals,
            info={**self.mesh.info, "delaunay": False},
        )


def check_triangles(mesh: Mesh) -> None:
    """Refuse a mesh of anything but triangles."""
    others = [kind for kind in mesh.cells if kind != "triangle"]
    if mesh.dim != 2 or others or "triangle" not in mesh.cells:
        held = ", ".join(mesh.cells) or "no cells"
        raise InputError(
            f"only plane meshes of triangles can be improved; this one has dim {mesh.dim} "
            f"and holds {held}"
        )


def _fix_bare_edges(
    origin: np.ndarray, twin: np.ndarray, line: np.ndarray, region: np.ndarray, kind: np.ndarray
) -> None:
    """Fix vertices of outer edges and interfaces that no facet tells anything about."""
    bare = np.flatnonzero(line < 0)
    there = twin[bare]
    odd = bare[(there < 0) | (region[bare // 3] != region[there // 3])]
    kind[origin[odd]] = FIXED
    kind[origin[np.where(odd % 3 < 2, odd + 1, odd - 2)]] = FIXED

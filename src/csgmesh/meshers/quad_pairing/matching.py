"""Which triangles become quads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.mesh import Mesh

#: Angles of a quad, degrees, beyond which two triangles are not paired.
SHARPEST, BLUNTEST = 30.0, 155.0
#: What an interior vertex needs: with two cells both would have two edges on one line.
LEAST_CELLS = 3
#: Width of the search for alternating paths, as the kernel has it.
WIDEST = 128
#: What one cell too many or too few at a vertex counts beside the quad's worst angle.
BY_DEGREE = 0.15


@dataclass(frozen=True, eq=False)
class Pairing:
    """Cells of quads and triangles.

    Attributes
    ----------
    corners : (c, 4) int64
        Corners of each cell, -1 behind those of a triangle.
    edges : (c, 4) int64
        Number of the edge that leaves each corner, -1 likewise.
    region : (c,) int64
    ends : (e, 2) int64
        Ends of each edge that is left.
    facet : (e,) int64
        Facet that each edge is, -1 for none, and whether it runs along it.
    """

    corners: np.ndarray
    edges: np.ndarray
    region: np.ndarray
    ends: np.ndarray
    facet: np.ndarray


def pair(mesh: Mesh) -> Pairing:
    """Pair the triangles of a mesh."""
    cells = mesh.cells["triangle"]
    facets = mesh.facets["line"]
    n, m = mesh.n_points, len(cells)
    origin = cells.astype(np.int32).reshape(-1)
    twin, line = np.full(3 * m, -1, np.int32), np.full(3 * m, -1, np.int32)
    first = np.full(n, -1, np.int32)
    room = np.empty(3 * m, np.int32)
    kernels.pair_half_edges(origin, twin, first, room, facets.astype(np.int32).ravel(), line)
    h = np.arange(3 * m, dtype=np.int32)
    own = np.flatnonzero((twin < h) & (twin >= 0) | (twin < 0)).astype(np.int32)
    number = np.empty(3 * m, np.int32)
    number[own] = np.arange(len(own), dtype=np.int32)
    number[twin[own][twin[own] >= 0]] = number[own[twin[own] >= 0]]
    lost = _match(mesh.points, origin, twin, line, own, number, n)
    return _cells(mesh, origin, twin, line, own, number, lost)


def _match(
    points: np.ndarray,
    origin: np.ndarray,
    twin: np.ndarray,
    line: np.ndarray,
    own: np.ndarray,
    number: np.ndarray,
    n: int,
) -> np.ndarray:
    """The edge that each triangle loses, -1 for triangles left over."""
    inner = own[(twin[own] >= 0) & (line[own] < 0)]
    g = twin[inner]
    quad = np.stack([origin[inner], origin[_before(g)], origin[g], origin[_before(inner)]], axis=1)
    worst, best = _angles(points, quad)
    degree = np.bincount(origin, minlength=n).astype(np.int32)
    is_outer = np.zeros(n, bool)
    bare = np.flatnonzero(twin < 0)
    is_outer[origin[bare]] = is_outer[origin[_after(bare)]] = True
    wish = degree.astype(float) - np.where(is_outer, 3.0, 6.0)
    excess = wish[quad[:, 0]] + wish[quad[:, 2]] - wish[quad[:, 1]] - wish[quad[:, 3]]
    value = 1.0 - np.maximum(90.0 - worst, best - 90.0) / 90.0 + BY_DEGREE * np.clip(excess, -2, 2)
    good = np.flatnonzero((worst >= SHARPEST) & (best <= BLUNTEST))
    order = good[np.argsort(-value[good], kind="stable")].astype(np.int32)
    edges = np.stack([origin[inner], origin[g]], axis=1).astype(np.int32)
    sides = np.stack([inner // 3, g // 3], axis=1).astype(np.int32)
    lost = np.full(len(origin) // 3, -1, np.int32)
    least = np.where(is_outer, 1, LEAST_CELLS).astype(np.int32)
    flat, beside = edges.reshape(-1), sides.reshape(-1)
    kernels.pair_greedily(flat, beside, order, lost, degree, least)
    way = np.full(len(origin), -1, np.int32)
    way[inner[good]] = way[g[good]] = good.astype(np.int32)
    stamp, came = np.full(len(lost), -1, np.int32), np.empty(len(lost), np.int32)
    while True:
        free = np.flatnonzero(lost < 0).astype(np.int32)
        stamp[:] = -1
        queue = np.empty((2, WIDEST), np.int32)
        if not len(free) or not kernels.pair_along_paths(
            flat, beside, way, lost, degree, least, stamp, came, free, queue
        ):
            break
    out = np.full(len(lost), -1, np.int64)
    has = lost >= 0
    out[has] = number[inner[lost[has]]]
    return out


def _angles(points: np.ndarray, quad: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest angle of quads in degrees."""
    x, y = (points[quad.T, k] for k in (0, 1))
    dx, dy = np.roll(x, -1, axis=0) - x, np.roll(y, -1, axis=0) - y
    px, py = np.roll(dx, 1, axis=0), np.roll(dy, 1, axis=0)
    det, dot = px * dy - py * dx, -(px * dx + py * dy)
    angle = np.degrees(np.arctan2(det, dot))
    angle[angle < 0] += 360.0
    return angle.min(axis=0), angle.max(axis=0)


def _cells(
    mesh: Mesh,
    origin: np.ndarray,
    twin: np.ndarray,
    line: np.ndarray,
    own: np.ndarray,
    number: np.ndarray,
    lost: np.ndarray,
) -> Pairing:
    """Quads and triangles with the edges that are left, renumbered."""
    gone = np.zeros(len(own), bool)
    gone[lost[lost >= 0]] = True
    left = np.cumsum(~gone) - 1
    h = own[gone]
    g = twin[h]
    ring = np.stack([_after(g), _before(g), _after(h), _before(h)], axis=1)
    alone = np.flatnonzero(lost < 0)
    region = mesh.cell_region["triangle"]
    corners = np.full((len(ring) + len(alone), 4), -1)
    edges = corners.copy()
    corners[: len(ring)] = origin[ring]
    edges[: len(ring)] = left[number[ring]]
    single = 3 * alone[:, None] + np.arange(3)
    corners[len(ring) :, :3] = origin[single]
    edges[len(ring) :, :3] = left[number[single]]
    kept = own[~gone]
    return Pairing(
        corners,
        edges,
        np.concatenate([region[h // 3], region[alone]]),
        np.stack([origin[kept], origin[_after(kept)]], axis=1).astype(np.int64),
        line[kept].astype(np.int64),
    )


def _after(h: np.ndarray) -> np.ndarray:
    return np.where(h % 3 == 2, h - 2, h + 1)


def _before(h: np.ndarray) -> np.ndarray:
    return np.where(h % 3 == 0, h + 2, h - 1)

"""Vertices of the boundary on the exact strata, and relaxation of the cells behind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.meshers.hexahedra.blocks import Blocks
from csgmesh.meshers.hexahedra.labels import unresolved
from csgmesh.meshers.hexahedra.strata import Strata, on_both

FIXED, ON_CURVE, ON_FACE, FREE = 0, 1, 2, 3


@dataclass(frozen=True, eq=False)
class Places:
    """Where the vertices of a boundary belong.

    Attributes
    ----------
    kind : (n,) int64
        `FIXED` at corners, `ON_CURVE`, `ON_FACE` or `FREE`.
    on_face : (k,) int64
        Vertices on one face; `face` (k,) is theirs.
    on_curve : (c,) int64
        Vertices on a curve; `pair` (c, 2) are the faces that meet there.
    at_corner : (j,) int64
        Vertices at corners; `corner` (j,) are theirs.
    """

    kind: np.ndarray
    on_face: np.ndarray
    face: np.ndarray
    on_curve: np.ndarray
    pair: np.ndarray
    at_corner: np.ndarray
    corner: np.ndarray


def places_of(blocks: Blocks, strata: Strata, size: float) -> Places:
    """The stratum of each vertex, from the labels of the quads around it."""
    entry = np.column_stack([blocks.quads.ravel(), np.repeat(blocks.label, 4)])
    entry = np.unique(entry, axis=0)
    n = len(blocks.points)
    count = np.bincount(entry[:, 0], minlength=n)
    first = np.cumsum(count) - count
    kind = np.full(n, FREE)
    kind[count == 1], kind[count == 2], kind[count > 2] = ON_FACE, ON_CURVE, FIXED
    on_face = np.flatnonzero(count == 1)
    on_curve = np.flatnonzero(count == 2)
    pair = entry[first[on_curve][:, None] + [0, 1], 1]
    known = {tuple(row) for row in np.unique(strata.pair, axis=0).tolist()}
    for v, row in zip(on_curve.tolist(), pair.tolist(), strict=True):
        if tuple(row) not in known:
            raise unresolved("faces that do not meet are neighbours", blocks.points[v])
    at_corner = np.flatnonzero(count > 2)
    corner = [
        _corner(strata, blocks.points[v], entry[first[v] : first[v] + count[v], 1].tolist(), size)
        for v in at_corner.tolist()
    ]
    found = np.array(corner, np.int64)
    twice = np.flatnonzero(np.bincount(found, minlength=len(strata.corners)) > 1)
    if len(twice):
        raise unresolved("several vertices belong to one corner", strata.corners[twice[0]])
    return Places(kind, on_face, entry[first[on_face], 1], on_curve, pair, at_corner, found)


def _corner(strata: Strata, point: np.ndarray, faces: list[int], size: float) -> int:
    best, nearest = -1, np.inf
    for k, around in enumerate(strata.corner_faces):
        if set(faces) <= set(around):
            distance = float(np.sqrt(((strata.corners[k] - point) ** 2).sum()))
            if distance < nearest:
                best, nearest = k, distance
    if best < 0 or nearest > 4.0 * size:
        raise unresolved("faces without a common corner meet", point)
    return best


def put(points: np.ndarray, places: Places, strata: Strata, first: bool = False) -> None:
    """Move vertices of the boundary onto their strata, in place."""
    points[places.at_corner] = strata.corners[places.corner]
    if len(places.on_face):
        points[places.on_face] = strata.on_faces(places.face, points[places.on_face])
    if len(places.on_curve):
        if first:
            points[places.on_curve], _ = strata.on_curves(places.pair, points[places.on_curve])
        else:
            rows = strata.face_surface[places.pair]
            points[places.on_curve] = on_both(strata.domain.surfaces, rows, points[places.on_curve])


def frames(points: np.ndarray, places: Places, strata: Strata) -> np.ndarray:
    """Normals of vertices on faces, tangents of those on curves, (n, 3)."""
    out = np.zeros_like(points)
    out[places.on_face] = strata.normals(places.face, points[places.on_face])
    if len(places.on_curve):
        at = points[places.on_curve]
        along = np.cross(
            strata.normals(places.pair[:, 0], at), strata.normals(places.pair[:, 1], at)
        )
        size = np.sqrt((along**2).sum(axis=1))
        flat = np.flatnonzero(size < 0.05)
        _, along[flat] = strata.on_curves(places.pair[flat], at[flat])
        size[flat] = 1.0
        out[places.on_curve] = along / size[:, None]
    return out


def spread(
    points: np.ndarray, blocks: Blocks, places: Places, strata: Strata, loose: np.ndarray
) -> None:
    """Even out loose vertices (n,) bool along curves, then on faces, by their neighbours."""
    quads = blocks.quads
    edge = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    label = np.repeat(blocks.label, 4)
    low = np.sort(edge, axis=1)
    order = np.lexsort((low[:, 1], low[:, 0]))
    is_feature = label[order[0::2]] != label[order[1::2]]
    edge = low[order[0::2]]
    for wanted, chosen in ((ON_CURVE, edge[is_feature]), (ON_FACE, edge)):
        moved = np.flatnonzero((places.kind == wanted) & loose)
        ways = np.concatenate([chosen, chosen[:, ::-1]])
        ways = ways[places.kind[ways[:, 0]] == wanted]
        count = np.bincount(ways[:, 0], minlength=len(points))[moved]
        for _ in range(_SPREADING):
            mean = np.column_stack(
                [np.bincount(ways[:, 0], points[ways[:, 1], k], len(points)) for k in range(3)]
            )[moved]
            points[moved] = 0.25 * points[moved] + 0.75 * mean / np.maximum(count, 1)[:, None]
            put(points, places, strata, first=wanted == ON_CURVE)


_SPREADING = 6
#: Layers of cells behind the boundary whose vertices move.
_LAYERS = 4
_UNTANGLING = 60
_ROUNDING = 8
_SHARPENING = 8


@dataclass
class Relaxation:
    """Cells near the boundary and the state of their relaxation."""

    points: np.ndarray
    hexes: np.ndarray
    star: np.ndarray
    star_begin: np.ndarray
    vertices: np.ndarray
    scale: np.ndarray
    places: Places
    strata: Strata

    @classmethod
    def of(
        cls,
        points: np.ndarray,
        blocks: Blocks,
        places: Places,
        strata: Strata,
        size: float,
        loose: np.ndarray,
    ) -> Relaxation:
        """Of the cells within some layers of loose vertices (n,) bool."""
        hexes = blocks.hexes
        moves = loose.copy()
        for _ in range(_LAYERS):
            moves[hexes[moves[hexes].any(axis=1)].ravel()] = True
        active = hexes[moves[hexes].any(axis=1)]
        count = np.bincount(active.ravel(), minlength=len(points))
        begin = np.concatenate([[0], np.cumsum(count)])
        star = np.argsort(active.ravel(), kind="stable")
        vertices = np.flatnonzero(moves & (places.kind != FIXED))
        scale = np.full(len(points), 1.0 / size)
        return cls(points, active, star, begin, vertices, scale, places, strata)

    def sweep(self, epsilon: float, power: int) -> None:
        """Visit each vertex once, then put those of the boundary back."""
        scratch = np.zeros((4, 9))
        frame = frames(self.points, self.places, self.strata)
        start = 0
        while start < len(self.vertices):
            start = kernels.relax(
                self.points,
                self.hexes,
                self.star,
                self.star_begin,
                self.places.kind,
                frame,
                self.scale,
                scratch,
                self.vertices,
                start,
                epsilon,
                power,
            )
        put(self.points, self.places, self.strata)

    def least(self) -> float:
        """Smallest determinant at a corner."""
        return float(
            kernels.least_determinant(self.points, self.hexes, self.scale, np.zeros((1, 9)))
        )

    def worst(self) -> float:
        """Smallest scaled Jacobian at a corner."""
        out = np.empty(len(self.hexes))
        kernels.least_corners(self.points, self.hexes, out)
        return float(out.min(initial=1.0))

    def run(self) -> None:
        """Untangle, round, then raise the worst."""
        for _ in range(_UNTANGLING):
            least = self.least()
            if least > 0.0:
                break
            self.sweep(np.sqrt(1e-12 + 0.04 * min(least, 0.0) ** 2), 1)
        best, kept = self.worst(), self.points.copy()
        for power, times in ((1, _ROUNDING), (3, _SHARPENING)):
            for _ in range(times):
                self.sweep(np.sqrt(1e-12 + 0.04 * min(self.least(), 0.0) ** 2), power)
                now = self.worst()
                if now > best:
                    best, kept = now, self.points.copy()
        self.points[:] = kept

"""Vertices of the boundary on the exact strata."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.meshers.hexahedra.blocks import Blocks, paired_edges
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
    face : (n,) int64
        Of vertices on one face, -1 of others.
    pair : (n, 2) int64
        The faces that meet at vertices on a curve, -1 of others.
    at_corner : (j,) int64
        Vertices at corners; `corner` (j,) are theirs.
    """

    kind: np.ndarray
    face: np.ndarray
    pair: np.ndarray
    at_corner: np.ndarray
    corner: np.ndarray


def places_of(blocks: Blocks, strata: Strata, size: float) -> Places:
    """The stratum of each vertex, from the labels of the quads around it."""
    n, faces = len(blocks.points), strata.n_faces
    key = np.sort(blocks.quads.ravel() * faces + np.repeat(blocks.label, 4))
    key = key[np.append(True, np.diff(key) > 0)]
    vertex, label = key // faces, key % faces
    count = np.bincount(vertex, minlength=n)
    first = np.cumsum(count) - count
    kind = np.full(n, FREE)
    kind[count == 1], kind[count == 2], kind[count > 2] = ON_FACE, ON_CURVE, FIXED
    face, pair = np.full(n, -1), np.full((n, 2), -1)
    face[kind == ON_FACE] = label[first[kind == ON_FACE]]
    on_curve = np.flatnonzero(kind == ON_CURVE)
    pair[on_curve] = label[first[on_curve][:, None] + [0, 1]]
    known = np.unique(strata.pair @ [faces, 1])
    strange = on_curve[~np.isin(pair[on_curve] @ [faces, 1], known)]
    if len(strange):
        raise unresolved("faces that do not meet are neighbours", blocks.points[strange[0]])
    at_corner = np.flatnonzero(count > 2)
    corner = [
        _corner(strata, blocks.points[v], label[first[v] : first[v] + count[v]].tolist(), size)
        for v in at_corner.tolist()
    ]
    for k, around in enumerate(strata.corner_faces):
        if len(around) == 1:
            near = np.flatnonzero(face == around[0])
            gap = ((blocks.points[near] - strata.corners[k]) ** 2).sum(axis=1)
            if not len(near) or gap.min() > (4.0 * size) ** 2:
                raise unresolved("a peak is lost", strata.corners[k])
            peak = near[np.argmin(gap)]
            kind[peak], face[peak] = FIXED, -1
            at_corner, corner = np.append(at_corner, peak), [*corner, k]
    found = np.array(corner, np.int64)
    twice = np.flatnonzero(np.bincount(found, minlength=len(strata.corners)) > 1)
    if len(twice):
        raise unresolved("several vertices belong to one corner", strata.corners[twice[0]])
    return Places(kind, face, pair, at_corner, found)


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


def put(
    points: np.ndarray, places: Places, strata: Strata, which: np.ndarray, first: bool = False
) -> None:
    """Move some vertices of the boundary (k,) onto their strata, in place."""
    kind = places.kind[which]
    on_face, on_curve = which[kind == ON_FACE], which[kind == ON_CURVE]
    if len(on_face):
        points[on_face] = strata.on_faces(places.face[on_face], points[on_face])
    if len(on_curve):
        if first:
            points[on_curve], _ = strata.on_curves(places.pair[on_curve], points[on_curve])
        else:
            rows = strata.face_surface[places.pair[on_curve]]
            points[on_curve] = on_both(strata.domain.surfaces, rows, points[on_curve])


def frames(points: np.ndarray, places: Places, strata: Strata, which: np.ndarray) -> np.ndarray:
    """Normals of some vertices on faces, tangents of those on curves, (n, 3)."""
    out = np.zeros_like(points)
    kind = places.kind[which]
    on_face, on_curve = which[kind == ON_FACE], which[kind == ON_CURVE]
    out[on_face] = strata.normals(places.face[on_face], points[on_face])
    if len(on_curve):
        at, pair = points[on_curve], places.pair[on_curve]
        along = np.cross(strata.normals(pair[:, 0], at), strata.normals(pair[:, 1], at))
        size = np.sqrt((along**2).sum(axis=1))
        flat = np.flatnonzero(size < 0.05)
        if len(flat):
            _, along[flat] = strata.on_curves(pair[flat], at[flat])
            size[flat] = 1.0
        out[on_curve] = along / size[:, None]
    return out


def spread(
    points: np.ndarray, blocks: Blocks, places: Places, strata: Strata, loose: np.ndarray
) -> None:
    """Even out loose vertices (n,) bool along curves, then on faces, by their neighbours."""
    quads = blocks.quads
    one, two = paired_edges(quads)
    label = blocks.label
    is_feature = label[one // 4] != label[two // 4]
    tail, head = quads.ravel(), quads[:, [1, 2, 3, 0]].ravel()
    edge = np.column_stack([tail[one], head[one]])
    is_curve = loose & (places.kind == ON_CURVE)
    on_face = loose & (places.kind == ON_FACE)
    close = is_curve.copy()
    for _ in range(_RINGS):
        close[edge[close[edge].any(axis=1)].ravel()] = True
    for moves, chosen, rounds in (
        (is_curve, edge[is_feature], _SPREADING),
        (on_face, edge, _SPREADING),
        (on_face & close, edge, _SPREADING_AT_CURVES),
    ):
        moved = np.flatnonzero(moves)
        if not len(moved):
            continue
        ways = np.concatenate([chosen, chosen[:, ::-1]])
        ways = ways[moves[ways[:, 0]]]
        ways = ways[np.argsort(ways[:, 0], kind="stable")]
        begin = np.append(np.searchsorted(ways[:, 0], moved), len(ways))
        out = np.empty((len(moved), 3))
        neighbours = np.ascontiguousarray(ways[:, 1])
        for _ in range(rounds):
            kernels.average_along(points, moved, begin, neighbours, 0.75, out)
            points[moved] = out
            put(points, places, strata, moved, first=moves is is_curve)


_SPREADING = 4
#: Further rounds for vertices on faces so many quads from a curve: rows of cells along curves
#: start without any width, and optimisation does not open them.
_SPREADING_AT_CURVES, _RINGS = 26, 6

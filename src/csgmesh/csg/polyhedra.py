"""Faces given by a user: their triangles, and whether they close."""

from __future__ import annotations

import numpy as np

from csgmesh.csg.rings import ring_area
from csgmesh.errors import ShapeError

#: A face counts as flat when its corners lie within this share of its extent of one plane:
#: files carry six digits.
_FLAT_SHARE = 1e-5


def face_triangles(
    points: np.ndarray, faces: list[tuple[int, ...]], where: str
) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of polygonal faces, (m, 3), and the face of each, (m,).

    Raises
    ------
    ShapeError
        If a face is not flat or has no area.
    """
    triangles: list[tuple[int, int, int]] = []
    owner: list[int] = []
    for number, face in enumerate(faces):
        corners = points[list(face)]
        normal = _normal(corners)
        size = float(np.abs(corners - corners[0]).max())
        length = float(np.sqrt((normal**2).sum()))
        if length <= 1e-14 * size * size:
            raise ShapeError(f"{where}: face {number} has no area; its corners are {face}")
        off = np.abs((corners - corners[0]) @ (normal / length))
        if off.max() > _FLAT_SHARE * size:
            raise ShapeError(
                f"{where}: face {number} must be flat; corner {face[int(off.argmax())]} lies "
                f"{off.max():.3g} off its plane"
            )
        # The plane is seen along the largest component of its normal, which keeps orientation.
        axis = int(np.abs(normal).argmax())
        kept = [(1, 2), (2, 0), (0, 1)][axis]
        flat = corners[:, kept] * [1.0, np.sign(normal[axis])]
        own = _ears(flat)
        triangles += [(face[a], face[b], face[c]) for a, b, c in own]
        owner += [number] * len(own)
    return np.array(triangles, np.int64), np.array(owner, np.int64)


def _normal(corners: np.ndarray) -> np.ndarray:
    """Twice the area vector of a polygon (Newell)."""
    shifted = corners - corners[0]
    return np.cross(shifted, np.roll(shifted, -1, axis=0)).sum(axis=0)


def _ears(ring: np.ndarray) -> list[tuple[int, int, int]]:
    """Triangles of a counterclockwise polygon by cutting ears (Meisters 1975)."""
    left = list(range(len(ring)))
    out: list[tuple[int, int, int]] = []
    while len(left) > 3:
        best = None
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            area = ring_area(ring[[a, b, c]])
            if area <= 0.0:
                continue
            others = ring[[v for v in left if v not in (a, b, c)]]
            if not _within(others, ring[[a, b, c]]).any():
                best = k
                break
            if best is None:
                best = k
        k = 0 if best is None else best
        out.append((left[k - 1], left[k], left[(k + 1) % len(left)]))
        del left[k]
    out.append((left[0], left[1], left[2]))
    return out


def _within(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Which points lie in a counterclockwise triangle or on its sides."""
    result = np.ones(len(points), bool)
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        (x, y), (dx, dy) = start, end - start
        result &= dx * (points[:, 1] - y) >= dy * (points[:, 0] - x)
    return result


def oriented_outward(points: np.ndarray, triangles: np.ndarray, where: str) -> bool:
    """Whether a closed surface's triangles are counterclockwise seen from outside.

    Raises
    ------
    ShapeError
        If an edge is not shared by two faces that run along it in opposite directions, or the
        surface encloses nothing.
    """
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    low, high = edges.min(axis=1), edges.max(axis=1)
    key = low * len(points) + high
    order = np.argsort(key, kind="stable")
    forward = np.where(edges[:, 0] == low, 1, -1)
    starts = np.flatnonzero(np.r_[True, np.diff(key[order]) != 0])
    balance = np.add.reduceat(forward[order], starts)
    count = np.diff(np.r_[starts, len(order)])
    wrong = np.flatnonzero((balance != 0) | (count % 2 != 0))
    if len(wrong):
        at = order[starts[wrong[0]]]
        a, b = edges[at].tolist()
        raise ShapeError(
            f"{where}: each edge must be shared by two faces that run along it in opposite "
            f"directions; the edge from point {a} {tuple(points[a].tolist())} to point {b} "
            f"{tuple(points[b].tolist())} is used {count[wrong[0]]} times"
        )
    corners = points[triangles] - points.mean(axis=0)
    volume = float(np.linalg.det(corners).sum())
    extent = float(np.ptp(points, axis=0).max())
    if abs(volume) <= 1e-14 * extent**3:
        raise ShapeError(f"{where}: the faces must enclose a volume; they enclose none")
    return volume > 0.0

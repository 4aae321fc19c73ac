"""How often a closed triangulated surface winds around points."""

from __future__ import annotations

import numpy as np

from csgmesh.spatial import Boxes

#: Points asked about at once: with a few hundred candidates each, the pairs stay in memory.
_CHUNK = 65_536


def winding_numbers(points: np.ndarray, corners: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Winding number of a closed surface around each point, (n,) int64.

    A ray goes up from each point, displaced by an infinitesimal (e, e², 0), so that it never meets
    an edge (simulation of simplicity, Edelsbrunner and Mücke 1990); both triangles of an edge
    compute the same cross product of the same two points.
    """
    out = np.zeros(len(points), np.int64)
    shape = corners[triangles]
    flat = shape[:, :, :2]
    columns = Boxes(flat.min(axis=1), flat.max(axis=1))
    for start in range(0, len(points), _CHUNK):
        part = points[start : start + _CHUNK]
        pairs = columns.overlapping(part[:, :2], part[:, :2])
        if not len(pairs):
            continue
        p, own = part[pairs[:, 0]], triangles[pairs[:, 1]]
        sides = [_side(p, corners, own[:, k], own[:, (k + 1) % 3]) for k in range(3)]
        turn = np.where((sides[0] == sides[1]) & (sides[1] == sides[2]), sides[0], 0)
        hit = np.flatnonzero(turn)
        a, b, c = (shape[pairs[hit, 1], k] for k in range(3))
        normal = np.cross(b - a, c - a)
        below = (((a - p[hit]) * normal).sum(axis=1) * np.sign(normal[:, 2])) >= 0.0
        np.add.at(out, start + pairs[hit[below], 0], turn[hit[below]])
    return out


def _side(p: np.ndarray, corners: np.ndarray, tail: np.ndarray, head: np.ndarray) -> np.ndarray:
    """+1 where p, displaced, lies left of the edge seen from above, -1 where right."""
    swap = tail > head
    a = corners[np.where(swap, head, tail)]
    d = corners[np.where(swap, tail, head)] - a
    value = d[:, 0] * (p[:, 1] - a[:, 1]) - d[:, 1] * (p[:, 0] - a[:, 0])
    value = np.where(value == 0.0, -d[:, 1], value)
    value = np.where(value == 0.0, d[:, 0], value)
    return np.where(swap, -np.sign(value), np.sign(value)).astype(np.int64)

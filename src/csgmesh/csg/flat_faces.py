"""Flat faces of a triangulated surface: triangles that lie in one plane, side by side."""

from __future__ import annotations

import numpy as np

from csgmesh.graphs import components

#: Neighbours whose normals differ by more than this sine are no one face, however small they are.
_TURN = 1e-3


def flat_faces(points: np.ndarray, triangles: np.ndarray, share: float) -> np.ndarray:
    """Number of the flat face of each triangle, (m,), in the order of their first triangles.

    Parameters
    ----------
    points, triangles : (n, 3), (m, 3)
        A closed surface.
    share : float
        Corners of a face lie within this share of the surface's extent of one plane.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1.0]])
    >>> pyramid = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    >>> flat_faces(corners, pyramid, 1e-9)
    array([0, 0, 1, 2, 3, 4])
    """
    allowed = share * float(np.ptp(points, axis=0).max())
    corner = points[triangles]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    length = np.sqrt((area**2).sum(axis=1))
    normal = area / np.where(length > 0.0, length, 1.0)[:, None]
    a, b = neighbours(triangles)
    # The larger of the two has the better normal.
    swap = length[a] < length[b]
    a, b = np.where(swap, b, a), np.where(swap, a, b)
    off = np.abs(((corner[b] - corner[a][:, :1]) * normal[a][:, None]).sum(axis=2)).max(axis=1)
    along = (normal[a] * normal[b]).sum(axis=1)
    same = (off <= allowed) & ((along >= np.sqrt(1.0 - _TURN**2)) | (length[b] == 0.0))
    n_faces, face = components(len(triangles), a[same], b[same])
    # A chain of small turns is no plane: such a face falls apart into its triangles.
    total = np.zeros((n_faces, 3))
    np.add.at(total, face, area)
    size = np.sqrt((total**2).sum(axis=1))
    total /= np.where(size > 0.0, size, 1.0)[:, None]
    _, first = np.unique(face, return_index=True)
    origin = corner[first, 0]
    height = np.abs(((corner - origin[face][:, None]) * total[face][:, None]).sum(axis=2))
    worst = np.zeros(n_faces)
    np.maximum.at(worst, face, height.max(axis=1))
    bent = (worst > 4.0 * allowed)[face]
    face[bent] = n_faces + np.arange(int(bent.sum()))
    _, first, number = np.unique(face, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[number.reshape(-1)]


def neighbours(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of triangles that follow one another around an edge, (k,) each."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    return order[:-1][same] // 3, order[1:][same] // 3

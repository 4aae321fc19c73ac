"""Faces and incidences of a complex in space. Coordinates are never looked at.

Cells are counted through all kinds in the order of the mapping; only their corners count.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from csgmesh.mesh.kinds import KINDS


@dataclass(frozen=True, eq=False)
class Faces:
    """The faces of a complex in space, triangles and quads alike.

    Attributes
    ----------
    points : (f, 4) int64
        Corners in canonical order: the lowest first, then its lower neighbour; -1 for the fourth
        corner of a triangle. Rows sorted.
    behind, ahead : (f,) int64
        A cell that the face's normal, by the order of `points`, points out of, and one that it
        points into; -1 for none.
    n_behind, n_ahead : (f,) int64
        How many such cells there are; at most one in a conforming mesh.
    """

    points: np.ndarray
    behind: np.ndarray
    ahead: np.ndarray
    n_behind: np.ndarray
    n_ahead: np.ndarray

    @property
    def count(self) -> np.ndarray:
        """Number of cells at each face, (f,)."""
        return self.n_behind + self.n_ahead

    def find(self, canonical: np.ndarray) -> np.ndarray:
        """Numbers of faces in canonical order, (k,); -1 for what is no face."""
        table = np.concatenate([self.points, canonical])
        _, key = np.unique(table, axis=0, return_inverse=True)
        key = key.reshape(-1)
        number = np.full(int(key.max(initial=-1)) + 1, -1)
        number[key[: len(self.points)]] = np.arange(len(self.points))
        return number[key[len(self.points) :]]


def canonical_faces(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (k, 3 or 4) in canonical order, (k, 4), and whether each row runs that way.

    Examples
    --------
    >>> canonical_faces(np.array([[5, 2, 7]]))
    (array([[ 2,  5,  7, -1]]), array([False]))
    """
    k = rows.shape[1]
    start = np.argmin(rows, axis=1)
    turned = np.take_along_axis(rows, (start[:, None] + np.arange(k)) % k, axis=1)
    forwards = turned[:, 1] < turned[:, k - 1]
    backwards = np.concatenate([turned[:, :1], turned[:, :0:-1]], axis=1)
    turned = np.where(forwards[:, None], turned, backwards)
    if k == 3:
        turned = np.concatenate([turned, np.full((len(rows), 1), -1)], axis=1)
    return turned, forwards


def faces_of(cells: Mapping[str, np.ndarray]) -> Faces:
    """The faces of cells in space.

    Examples
    --------
    >>> faces_of({"tetra": np.array([[0, 1, 2, 3]])}).n_ahead.tolist()
    [1, 0, 1, 0]
    """
    rows, owner, ways, before = [np.zeros((0, 4), np.int64)], [_NONE], [np.zeros(0, bool)], 0
    for kind, cell in cells.items():
        for face, face_kind in zip(KINDS[kind].facets, KINDS[kind].facet_kinds, strict=True):
            corners = cell[:, list(face[: KINDS[face_kind].n_corners])]
            ordered, forwards = canonical_faces(corners)
            rows.append(ordered)
            ways.append(forwards)
            owner.append(np.arange(before, before + len(cell)))
        before += len(cell)
    table, cell_of, way = np.concatenate(rows), np.concatenate(owner), np.concatenate(ways)
    points, key = np.unique(table, axis=0, return_inverse=True)
    key = key.reshape(-1)
    behind, ahead = np.full(len(points), -1), np.full(len(points), -1)
    behind[key[way]] = cell_of[way]
    ahead[key[~way]] = cell_of[~way]
    n_behind = np.bincount(key[way], minlength=len(points))
    n_ahead = np.bincount(key[~way], minlength=len(points))
    return Faces(points, behind, ahead, n_behind, n_ahead)


_NONE = np.zeros(0, np.int64)

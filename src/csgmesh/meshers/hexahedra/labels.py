"""Which face of the domain each outer quad of the core belongs to."""

from __future__ import annotations

import numpy as np

from csgmesh.errors import MeshingError
from csgmesh.meshers.hexahedra.blocks import beside
from csgmesh.meshers.hexahedra.core import Core
from csgmesh.meshers.hexahedra.skin import side_points
from csgmesh.meshers.hexahedra.strata import Finder, Strata

#: How much a quad that faces away from a face counts, in cells of distance.
_FACING = 1.0
_ROUNDS = 30

#: What a face between other regions counts.
_APART = 100.0


def labelled(strata: Strata, core: Core, size: float) -> np.ndarray:
    """Face of each side of a core: near it, facing alike, in patches without teeth."""
    finder = Finder.of(strata, 1.5 * size, 2.5 * size, np.arange(len(strata.face)))
    quads = side_points(core)
    centre = core.grid.middles(core.owner)
    axis, rows = core.way // 2, np.arange(len(centre))
    centre[rows, axis] = core.grid.points(quads[:, 0])[rows, axis]
    face, distance, place = finder.nearest(centre)
    lost = np.flatnonzero(face[:, 0] < 0)
    if len(lost):
        raise unresolved("no face of the domain is near", centre[lost[0]])
    label = face[:, 0].copy()
    regions = np.column_stack([core.behind, core.front])
    several = np.flatnonzero(
        (face[:, 1] >= 0) | (strata.face_regions[label] != regions).any(axis=1)
    )
    face, place = face[several], place[several]
    cost = distance[several] / size
    way = 2.0 * (core.way[several] % 2) - 1.0
    for k in range(face.shape[1]):
        own = np.flatnonzero(face[:, k] >= 0)
        normal = strata.normals(face[own, k], place[own, k])
        cost[own, k] += _FACING * (1.0 - normal[np.arange(len(own)), axis[several][own]] * way[own])
        cost[own, k] += _APART * (strata.face_regions[face[own, k]] != regions[several][own]).any(1)
    order = np.argsort(cost, axis=1, kind="stable")
    face = np.take_along_axis(face, order, axis=1)
    cost = np.take_along_axis(cost, order, axis=1)
    label[several] = face[:, 0]
    exact = cost[:, 0] <= 1e-6
    _without_teeth(label, several[~exact], face[~exact], beside(quads))
    return label


def _without_teeth(
    label: np.ndarray, loose: np.ndarray, face: np.ndarray, across: np.ndarray
) -> None:
    """Relabel loose quads that at least three neighbours with one other label surround."""
    for _ in range(_ROUNDS):
        near = label[across[loose]]
        changed = False
        for k in range(4):
            wanted = near[:, k]
            votes = (near == wanted[:, None]).sum(axis=1)
            known = (face == wanted[:, None]).any(axis=1)
            turn = (votes >= 3) & (wanted != label[loose]) & known
            if turn.any():
                label[loose[turn]] = wanted[turn]
                changed = True
                break
        if not changed:
            return


def unresolved(what: str, place: np.ndarray) -> MeshingError:
    """The error that the domain cannot be made of cells of this size."""
    x, y, z = place
    return MeshingError(
        f"the domain is not resolved by cells of this size: {what} at ({x:.6g}, {y:.6g}, {z:.6g})"
    )

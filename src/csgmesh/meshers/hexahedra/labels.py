"""Which face of the domain each outer quad of the core belongs to."""

from __future__ import annotations

import numpy as np

from csgmesh.errors import MeshingError
from csgmesh.meshers.hexahedra.blocks import beside
from csgmesh.meshers.hexahedra.strata import Finder, Strata

#: How much a quad that faces away from a face counts, in cells of distance.
_FACING = 1.0
_ROUNDS = 30


def labelled(
    strata: Strata,
    finder: Finder,
    points: np.ndarray,
    quads: np.ndarray,
    ways: np.ndarray,
    size: float,
) -> np.ndarray:
    """Face of each quad: near it, facing alike, in patches without teeth."""
    centre = points[quads].mean(axis=1)
    normal = np.zeros((len(quads), 3))
    normal[np.arange(len(quads)), ways[:, 0]] = 2.0 * ways[:, 1] - 1.0
    face, distance, place = finder.nearest(centre)
    lost = np.flatnonzero(face[:, 0] < 0)
    if len(lost):
        raise unresolved("no face of the domain is near", centre[lost[0]])
    cost = distance / size
    for k in range(face.shape[1]):
        own = np.flatnonzero(face[:, k] >= 0)
        facing = (strata.normals(face[own, k], place[own, k]) * normal[own]).sum(axis=1)
        cost[own, k] += _FACING * (1.0 - facing)
    order = np.argsort(cost, axis=1, kind="stable")
    face = np.take_along_axis(face, order, axis=1)
    cost = np.take_along_axis(cost, order, axis=1)
    label = face[:, 0].copy()
    exact = cost[:, 0] <= 1e-6
    _without_teeth(label, exact, face, cost, quads)
    return label


def _without_teeth(
    label: np.ndarray, exact: np.ndarray, face: np.ndarray, cost: np.ndarray, quads: np.ndarray
) -> None:
    """Relabel quads that at least three neighbours with one other label surround."""
    across = beside(quads)
    for _ in range(_ROUNDS):
        near = label[across]
        changed = False
        for k in range(4):
            wanted = near[:, k]
            votes = (near == wanted[:, None]).sum(axis=1)
            known = (face == wanted[:, None]).any(axis=1)
            turn = np.flatnonzero((votes >= 3) & (wanted != label) & known & ~exact)
            if len(turn):
                label[turn] = wanted[turn]
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

"""The $Periodic section of MSH 4.1 files: which points of one curve entity match another's."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from csgmesh.mesh import Mesh, PeriodicPair


@dataclass(frozen=True)
class Link:
    """Points of an entity and those of its master.

    Attributes
    ----------
    dim, entity, master : int
    affine : (16,) float64
        The map from the master to the entity as a matrix of 4 by 4, a row after the other; empty
        where the file has none.
    nodes : (k, 2) int64
        Points of the entity and their masters, counted from 0.
    """

    dim: int
    entity: int
    master: int
    affine: np.ndarray
    nodes: np.ndarray


def links(mesh: Mesh, entities: Sequence[tuple[str, np.ndarray]]) -> list[Link]:
    """What to write.

    Parameters
    ----------
    mesh : Mesh
    entities : sequence of (str, (k,) int64)
        Kind and facets of each curve entity, in the order of their tags, from 1.
    """
    entity_of = {kind: np.zeros(len(rows), np.int64) for kind, rows in mesh.facets.items()}
    for tag, (kind, which) in enumerate(entities, 1):
        entity_of[kind][which] = tag
    found = []
    for pair in mesh.periodic:
        affine = np.eye(4)
        affine[: mesh.dim, : mesh.dim], affine[: mesh.dim, 3] = pair.matrix, pair.offset
        image = np.full(mesh.n_points, -1)
        image[pair.points[:, 0]] = pair.points[:, 1]
        for kind, rows in pair.facets.items():
            tags = entity_of[kind][rows]
            for master, entity in np.unique(tags, axis=0).tolist():
                here = rows[(tags == [master, entity]).all(axis=1), 0]
                points = np.unique(mesh.facets[kind][here][:, : mesh.dim])
                nodes = np.column_stack([image[points], points])
                found.append(Link(mesh.dim - 1, entity, master, affine.ravel(), nodes))
    return found


def pairs(
    mesh: Mesh, found: Iterable[tuple[Link, tuple[str, str]]], number: np.ndarray
) -> tuple[PeriodicPair, ...]:
    """The pairs of a mesh that a file told of; links of the same names and map become one.

    Parameters
    ----------
    mesh : Mesh
    found : iterable of (Link, (str, str))
        With the names of the master and of the entity.
    number : (n,) int64
        Number in the mesh of each point of the file, -1 for those left out.
    """
    groups: dict[tuple[tuple[str, str], bytes], list[np.ndarray]] = {}
    for link, names in found:
        points = number[link.nodes[:, ::-1]]
        points = points[(points >= 0).all(axis=1)]
        affine = link.affine if len(link.affine) == 16 else _translation(mesh, points)
        groups.setdefault((names, affine.tobytes()), []).append(points)
    made = []
    for (names, code), parts in groups.items():
        affine = np.frombuffer(code).reshape(4, 4)
        points = np.unique(np.concatenate(parts), axis=0)
        facets = {kind: _facets(mesh, kind, points) for kind in mesh.facets}
        facets = {kind: rows for kind, rows in facets.items() if len(rows)}
        d = mesh.dim
        made.append(PeriodicPair(names, affine[:d, :d], affine[:d, 3], points, facets))
    return tuple(made)


def _translation(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    affine = np.eye(4)
    if len(points):
        across = mesh.points[points[:, 1]] - mesh.points[points[:, 0]]
        affine[: mesh.dim, 3] = np.median(across, axis=0)
    return affine.ravel()


def _facets(mesh: Mesh, kind: str, points: np.ndarray) -> np.ndarray:
    """Facets whose ends have images that are the ends of a facet, and those."""
    image = np.full(mesh.n_points, -1)
    image[points[:, 0]] = points[:, 1]
    ends = np.sort(mesh.facets[kind][:, :2], axis=1)
    key = ends[:, 0] * mesh.n_points + ends[:, 1]
    order = np.argsort(key, kind="stable")
    there = np.sort(image[ends], axis=1)
    at = np.searchsorted(key[order], there[:, 0] * mesh.n_points + there[:, 1])
    at = order[np.minimum(at, len(key) - 1)] if len(key) else at
    matched = (there[:, 0] >= 0) & (ends[at] == there).all(axis=1)
    # A facet is not its own image, even where a map keeps its ends.
    matched &= at != np.arange(len(ends))
    return np.column_stack([np.flatnonzero(matched), at[matched]])

"""Sheets of bodies and leaves made one complex: which facets there are, between what, with names.

After `touching.settle`, facets that overlap are equal. Each group of equal facets is one facet of
the complex: the bodies on whose boundaries it lies are its regions, and all leaves that have a part
there give it their names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from csgmesh.boundary.neighbours import distinct, ordered, overlapping_pairs
from csgmesh.boundary.sheet_table import Sheets
from csgmesh.csg.program import Leaf

#: The layer of facets that only bring names.
NAMES_ONLY = -1


@dataclass(frozen=True, eq=False)
class Joined:
    """Facets of a complex.

    Attributes
    ----------
    triangles : (m, 3) int64
        Counterclockwise seen from outside the first region.
    surface : (m,) int64
        The class of surfaces.
    region : (m, 2) int64
    names : list of tuple of str
        Each combination, its names in the order of leaves and parts.
    name : (m,) int64
        Into `names`.
    """

    triangles: np.ndarray
    surface: np.ndarray
    region: np.ndarray
    names: list[tuple[str, ...]]
    name: np.ndarray


def with_rivals(
    bodies: Sheets, leaves: Sheets, leaf_of: np.ndarray, of: np.ndarray, shared: np.ndarray
) -> Sheets:
    """Add what other leaves have where a body's facets coincide with surfaces of theirs.

    Parameters
    ----------
    bodies, leaves : Sheets
        What bounds the regions, and the boundaries of all leaves.
    leaf_of, of, shared : (s,) arrays
        Leaf and class of each surface, and whether a class has several leaves.
    """
    own = np.flatnonzero(shared[bodies.surface])
    other = np.flatnonzero(shared[leaves.surface])
    if not len(own):
        return bodies
    corner = np.concatenate(
        [bodies.points[bodies.triangles[own]], leaves.points[leaves.triangles[other]]]
    )
    surface = np.concatenate([bodies.surface[own], leaves.surface[other]])
    pairs = overlapping_pairs(corner.min(axis=1), corner.max(axis=1), leaf_of[surface])
    one, two = pairs[of[surface[pairs[:, 0]]] == of[surface[pairs[:, 1]]]].T
    met = np.unique(two[(one < len(own)) & (two >= len(own))] - len(own))
    chosen = other[met]
    used, triangles = np.unique(leaves.triangles[chosen], return_inverse=True)
    return Sheets(
        np.concatenate([bodies.points, leaves.points[used]]),
        np.concatenate([bodies.triangles, len(bodies.points) + triangles.reshape(-1, 3)]),
        np.concatenate([bodies.surface, leaves.surface[chosen]]),
        np.concatenate([bodies.layer, np.full(len(chosen), NAMES_ONLY)]),
        bodies.moved,
    )


def joined(
    sheets: Sheets,
    of: np.ndarray,
    leaf_of: np.ndarray,
    parts: Sequence[tuple[int, ...]],
    leaves: Sequence[Leaf],
) -> Joined:
    """One facet for each group of equal ones that separates different regions."""
    ranked = np.sort(sheets.triangles, axis=1)
    order = ordered(ranked, len(sheets.points))
    new = np.r_[True, (np.diff(ranked[order], axis=0) != 0).any(axis=1)][: len(order)]
    group = np.empty(len(order), np.int64)
    group[order] = np.cumsum(new) - 1
    corners = ranked[order[new]]
    region = _regions(sheets, ranked, group, len(corners))
    # Outwards from the first region, the lower of two.
    flip = (region[:, 0] < 0) | ((region[:, 1] >= 0) & (region[:, 1] < region[:, 0]))
    region[flip] = region[flip, ::-1]
    corners[flip] = corners[flip, ::-1]
    surface = np.full(len(corners), len(of))
    bounds = sheets.layer >= 0
    np.minimum.at(surface, group[bounds], of[sheets.surface[bounds]])
    kept = np.flatnonzero(region[:, 0] != region[:, 1])
    names, name = _names(sheets, group, len(corners), leaf_of, parts, leaves)
    return Joined(corners[kept], surface[kept], region[kept], names, name[kept])


def _regions(sheets: Sheets, ranked: np.ndarray, group: np.ndarray, n: int) -> np.ndarray:
    """Bodies behind and in front of each group, corners in increasing order, (n, 2)."""
    t = sheets.triangles
    turned = np.roll(ranked, -1, axis=1), np.roll(ranked, -2, axis=1)
    even = (t == ranked).all(axis=1) | np.logical_or.reduce(
        [(t == other).all(axis=1) for other in turned]
    )
    region = np.full((n, 2), -1)
    for layer in range(int(sheets.layer.max()) + 1):
        own = sheets.layer == layer
        net = np.bincount(group[own], np.where(even[own], 1.0, -1.0), n)
        # Later bodies cover earlier ones, by less than the snap distance if at all.
        region[net > 0, 0] = layer
        region[net < 0, 1] = layer
    return region


def _names(
    sheets: Sheets,
    group: np.ndarray,
    n: int,
    leaf_of: np.ndarray,
    parts: Sequence[tuple[int, ...]],
    leaves: Sequence[Leaf],
) -> tuple[list[tuple[str, ...]], np.ndarray]:
    """All combinations of names, and the number of each group's."""
    n_surfaces = len(leaf_of)
    key = distinct(group * n_surfaces + sheets.surface)
    of_group, surface = key // n_surfaces, key % n_surfaces
    start = np.searchsorted(of_group, np.arange(n + 1))
    known: dict[tuple[str, ...], int] = {}

    def number(on: Sequence[int]) -> int:
        entries = sorted((int(leaf_of[s]), p) for s in on for p in parts[s])
        names = tuple(dict.fromkeys(leaves[leaf].names[p] for leaf, p in entries))
        return known.setdefault(names, len(known))

    # Nearly all facets lie on one surface, and there are few of these.
    lone = np.diff(start) == 1
    single, at = np.unique(surface[start[:-1][lone]], return_inverse=True)
    out = np.empty(n, np.int64)
    out[lone] = np.array([number([s]) for s in single.tolist()], np.int64)[at]
    for k in np.flatnonzero(~lone).tolist():
        out[k] = number(surface[start[k] : start[k + 1]].tolist())
    return list(known), out

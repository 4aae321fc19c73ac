"""Which facets of the domain a facet of the mesh stands for, by names, regions and place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.mesh import Mesh

if TYPE_CHECKING:
    from csgmesh.measures.space.case import SpaceCase

#: Names of a facet, and those of the regions on its two sides, None for outside.
Label = tuple[frozenset[str], frozenset[str | None]]

#: So many pairs of a place and a triangle are looked at together.
_PAIRS = 2_000_000

#: A facet's middle may be off the domain's facets that it stands for by this share of its
#: inradius, where their rim is curved; the middle is further than that from its own sides.
_SHARE = 0.5


def facet_labels(
    mesh: Mesh, marker: np.ndarray, region: np.ndarray
) -> list[tuple[Label, np.ndarray]]:
    """The different labels of a mesh's facets, and which facets have them."""
    return _grouped(marker, region, mesh.boundary_names, mesh.region_names)


def domain_labels(domain: Plc) -> dict[Label, np.ndarray]:
    """The facets of a domain by label."""
    found: dict[Label, np.ndarray] = {}
    groups = _grouped(
        domain.facet_marker, domain.facet_region, domain.boundary_names, domain.region_names
    )
    for label, facets in groups:
        found[label] = np.concatenate([found.get(label, np.zeros(0, np.int64)), facets])
    return found


def _grouped(
    marker: np.ndarray,
    region: np.ndarray,
    boundary_names: tuple[tuple[str, ...], ...],
    region_names: tuple[str, ...],
) -> list[tuple[Label, np.ndarray]]:
    rows = np.column_stack([marker, region])
    keys, group = np.unique(rows, axis=0, return_inverse=True)
    out = []
    for g, (m, *sides) in enumerate(keys.tolist()):
        names = frozenset(boundary_names[m] if 0 <= m < len(boundary_names) else ())
        beside = frozenset(region_names[r] if 0 <= r < len(region_names) else None for r in sides)
        out.append(((names, beside), np.flatnonzero(group.reshape(-1) == g)))
    return out


def misplaced_facets(case: SpaceCase) -> np.ndarray:
    """Facets beside those of the domain that carry their label, sorted.

    Only where one surface carries several labels: elsewhere the surface tells.
    """
    domain = case.domain
    assert domain is not None
    labels = domain_labels(domain)
    shared = _shared_surfaces(domain, labels)
    corners = case.mesh.points[case.triangles[:, :3]]
    owner, bad = case.triangles[:, 3], [np.zeros(0, np.int64)]
    for label, facets in case.labels:
        candidates = labels.get(label, np.zeros(0, np.int64))
        candidates = candidates[shared[domain.facet_surface[candidates]]]
        at = np.flatnonzero(np.isin(owner, facets))
        for s in np.unique(domain.facet_surface[candidates]).tolist():
            flat = corners[at].reshape(-1, 3)
            off = domain.surfaces.distance(np.full(len(flat), s), flat).reshape(-1, 3).max(axis=1)
            on = at[off <= case.tolerance]
            targets = domain.points[
                domain.facets[candidates[domain.facet_surface[candidates] == s]]
            ]
            far = _far_from(corners[on], targets, case.tolerance + domain.deviation)
            bad.append(owner[on[far]])
    return np.unique(np.concatenate(bad))


def _shared_surfaces(domain: Plc, labels: dict[Label, np.ndarray]) -> np.ndarray:
    """Which surfaces carry several labels, (n_surfaces,) bool."""
    count = np.zeros(len(domain.surfaces), np.int64)
    for facets in labels.values():
        count[np.unique(domain.facet_surface[facets])] += 1
    return count > 1


def _far_from(corners: np.ndarray, targets: np.ndarray, slack: float) -> np.ndarray:
    """Which triangles (k, 3, 3) have their middle further from all targets than they may."""
    middle = corners.mean(axis=1)
    sides = np.sqrt(((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=2)).sum(axis=1)
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # The inradius is twice the area over the sides.
    reach = slack + _SHARE * np.sqrt((area**2).sum(axis=1)) / np.maximum(sides, 1e-300)
    nearest = np.full(len(corners), np.inf)
    lo, hi = targets.min(axis=1), targets.max(axis=1)
    step = max(_PAIRS // max(len(targets), 1), 1)
    # Places side by side look at the same few triangles.
    order = np.lexsort(middle.T)
    for start in range(0, len(order), step):
        own = order[start : start + step]
        wide = reach[own].max()
        near = (lo <= middle[own].max(axis=0) + wide) & (hi >= middle[own].min(axis=0) - wide)
        few = targets[near.all(axis=1)]
        if len(few):
            nearest[own] = _distances(middle[own], few).min(axis=1)
    return nearest > reach


def _distances(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Distances of places (k, 3) from triangles (m, 3, 3), (k, m)."""
    out = np.full((len(places), len(triangles)), np.inf)
    a, b, c = (triangles[:, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.sqrt((normal**2).sum(axis=1)), 1e-300)[:, None]
    inside = np.ones(out.shape, bool)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        away = places[:, None] - start
        inside &= (np.cross(along, away) * normal).sum(axis=2) >= 0.0
        length = np.maximum((along**2).sum(axis=1), 1e-300)
        t = np.clip((away * along).sum(axis=2) / length, 0.0, 1.0)
        rest = away - t[:, :, None] * along
        np.minimum(out, np.sqrt((rest**2).sum(axis=2)), out=out)
    height = np.abs(((places[:, None] - a) * normal).sum(axis=2))
    return np.where(inside, np.minimum(out, height), out)

"""Some regions of a domain as a domain, with interfaces that are meshed already."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from csgmesh.domain.pslg import Pslg

if TYPE_CHECKING:
    from csgmesh.meshers.per_region.assembly import Assembly


@dataclass(frozen=True, eq=False)
class Subdomain:
    """A domain, and what its markers stand for.

    Attributes
    ----------
    domain : Pslg
        Its markers: one for each marker of the given domain and region on the other side, then one
        for each edge on an interface that is meshed already.
    marker : (k,) int64
        Of the given domain.
    other : (k,) int64
        Region on the other side, of regions that are not in the subdomain; -1 for none.
    given : (k,) int64
        Facet of the assembly, -1 for those that are not meshed yet.
    """

    domain: Pslg
    marker: np.ndarray
    other: np.ndarray
    given: np.ndarray


def subdomain(domain: Pslg, regions: np.ndarray, assembly: Assembly) -> Subdomain:
    """The regions, with segments of interfaces replaced where they have been meshed."""
    is_in = np.zeros(len(domain.region_names) + 1, bool)
    is_in[regions] = True
    done = np.append(assembly.is_done, False)
    left, right = domain.segment_region.T
    inside = is_in[left] | is_in[right]
    is_old = inside & (done[left] | done[right])
    own = np.flatnonzero(inside & ~is_old)
    points, old = assembly.interface(regions)
    turned = ~is_in[left[own]]
    ends = np.where(turned[:, None], domain.segments[own, ::-1], domain.segments[own])
    interval = domain.segment_interval[own]
    interval = np.where(turned[:, None], interval[:, ::-1], interval)
    sides = domain.segment_region[own]
    sides = np.where(turned[:, None], sides[:, ::-1], sides)
    other = np.where(is_in[sides[:, 1]], -1, sides[:, 1])
    sides = np.where(is_in[sides], sides, -1)
    pairs = np.stack([domain.segment_marker[own], other], axis=1)
    kinds, marker = np.unique(pairs, axis=0, return_inverse=True)
    marker = marker.ravel()
    old_rows, old_sides, old_marker = assembly.pieces(old, is_in)
    numbers, merged = _numbered(domain, ends, points, old_rows)
    probes = np.flatnonzero(domain.point_marker >= 0)
    region = assembly.region_at(domain.points[probes])
    probes = probes[is_in[region]]
    probe_points = domain.points[probes]
    names = [domain.boundary_names[m] for m in kinds[:, 0].tolist()]
    names += [(*domain.boundary_names[m], f"edge {k}") for k, m in enumerate(old_marker.tolist())]
    first_probe = len(names)
    markers = np.concatenate([marker, len(kinds) + np.arange(len(old))])
    build = Pslg.build(
        points=np.concatenate([merged, probe_points]),
        segments=numbers,
        segment_curve=np.concatenate([domain.segment_curve[own], np.full(len(old), -1)]),
        segment_interval=np.concatenate([interval, np.tile([0.0, 1.0], (len(old), 1))]),
        segment_marker=markers,
        segment_region=np.concatenate([sides, old_sides]),
        point_marker=np.concatenate(
            [np.full(len(merged), -1), first_probe + domain.point_marker[probes]]
        ),
        boundary_names=(*names, *domain.boundary_names),
        region_names=domain.region_names,
        curves=domain.curves,
        deviation=domain.deviation,
        snap=domain.snap,
        report=domain.report,
        oracle=domain.oracle,
    )
    n = len(domain.boundary_names)
    return Subdomain(
        build,
        np.concatenate([kinds[:, 0], old_marker, np.arange(n)]),
        np.concatenate([kinds[:, 1], np.full(len(old) + n, -1)]),
        np.concatenate([np.full(len(kinds), -1), old, np.full(n, -1)]),
    )


def _numbered(
    domain: Pslg, ends: np.ndarray, points: np.ndarray, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Ends of all segments by their places, and the points; equal coordinates are one point."""
    place = np.concatenate([domain.points[ends.ravel()], points[rows.ravel()]])
    found, number = np.unique(place, axis=0, return_inverse=True)
    return number.reshape(-1, 2), found

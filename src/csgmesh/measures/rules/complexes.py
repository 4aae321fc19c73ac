"""Rules about how cells fit together: conforming, facets, no overlap, components and holes."""

from __future__ import annotations

import numpy as np

from csgmesh import graphs
from csgmesh.measures.loops import Counts, region_counts
from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.measures.rules.case import Case
from csgmesh.mesh.orientation import orientations
from csgmesh.mesh.topology import closure_counts, components
from csgmesh.spatial import Boxes


def check_conforming(case: Case) -> Check:
    """Each edge has one cell, or two on different sides."""
    rule, edges = "conforming", case.edges
    crowded = np.flatnonzero(edges.count > 2)
    failures = offenders(
        rule, "edge", crowded, case.edge_places(crowded), "has|have more than two cells"
    )
    folded = np.flatnonzero((edges.count == 2) & (edges.n_left != 1))
    failures += offenders(
        rule, "edge", folded, case.edge_places(folded), "has|have two cells on the same side"
    )
    return Check.of(rule, len(edges.points), failures)


def check_facets(case: Case) -> Check:
    """The facets are the boundary edges and those between regions; others are embedded paths."""
    rule, edges = "facets", case.edges
    stray = np.flatnonzero(case.facet_edge < 0)
    failures = offenders(rule, "facet", stray, case.facet_places(stray), "is|are no edge of a cell")
    known = case.facet_edge[case.facet_edge >= 0]
    times = np.bincount(known, minlength=len(edges.points))
    twice = np.flatnonzero(times > 1)
    failures += offenders(
        rule, "edge", twice, case.edge_places(twice), "is|are listed as a facet more than once"
    )
    region = np.r_[case.cell_region, -1]
    left, right = region[edges.left], region[edges.right]
    missing = np.flatnonzero((left != right) & (times == 0))
    failures += offenders(
        rule, "edge", missing, case.edge_places(missing), "bounds|bound a region without a facet"
    )
    failures += _wrong_sides(case, region)
    return Check.of(rule, len(case.facets), failures)


def _wrong_sides(case: Case, region: np.ndarray) -> list[Failure]:
    rule, edges = "facets", case.edges
    at = np.flatnonzero(case.facet_edge >= 0)
    edge = case.facet_edge[at]
    forwards = case.facets[at, 0] < case.facets[at, 1]
    left = region[np.where(forwards, edges.left[edge], edges.right[edge])]
    right = region[np.where(forwards, edges.right[edge], edges.left[edge])]
    given = case.facet_region[at]
    wrong = at[(given[:, 0] != left) | (given[:, 1] != right)]
    failures = offenders(
        rule,
        "facet",
        wrong,
        case.facet_places(wrong),
        "has|have other regions than the cells beside",
    )
    turned = at[(given[:, 0] < 0) | ((given[:, 1] >= 0) & (given[:, 1] < given[:, 0]))]
    return failures + offenders(
        rule,
        "facet",
        turned,
        case.facet_places(turned),
        "does|do not have the domain, or the region of lower number, on the left",
    )


def check_overlap(case: Case) -> Check:
    """Boundary edges meet at common points only, and no cell lies over a boundary.

    A conforming mesh of counterclockwise cells covers each point as often as its boundary winds
    around it, so the cells overlap nowhere exactly if this holds. A vertex that hangs inside an
    edge shows as two boundary edges on each other.
    """
    rule = "overlap"
    boundary = case.edges.boundary()
    ends = case.mesh.points[boundary]
    bad = _crossings(case.mesh.points, boundary, ends)
    numbers = case.edges.find(boundary[bad[:, 0]])
    detail = ""
    if len(bad):
        a, b = boundary[bad[0]].tolist()
        detail = f"points {a[0]}-{a[1]} and {b[0]}-{b[1]}"
    failures = offenders(
        rule,
        "edge",
        numbers,
        case.edge_places(numbers),
        "lies|lie over another boundary edge",
        detail,
    )
    failures += _covered_loops(case, boundary)
    return Check.of(rule, len(boundary), failures)


def _crossings(points: np.ndarray, boundary: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Pairs of boundary edges with more in common than an end point, (k, 2)."""
    if not len(boundary):
        return np.zeros((0, 2), np.int64)
    pairs = Boxes(ends.min(axis=1), ends.max(axis=1)).pairs()
    first, second = boundary[pairs[:, 0]], boundary[pairs[:, 1]]
    shared = np.zeros(len(pairs), bool)
    # Turn edges that share a point so that it is the start of both.
    for i in (0, 1):
        for j in (0, 1):
            at = (first[:, i] == second[:, j]) & ~shared
            first[at] = np.stack([first[at, i], first[at, 1 - i]], axis=1)
            second[at] = np.stack([second[at, j], second[at, 1 - j]], axis=1)
            shared |= at
    signs = []
    for edge, other in ((first, second), (second, first)):
        signs.append([_turn(points, edge, other[:, k]) for k in (0, 1)])
    (a, b), (c, d) = signs
    along = ((points[first[:, 1]] - points[first[:, 0]]) * _arm(points, second)).sum(axis=1)
    crosses = (a * b <= 0) & (c * d <= 0) & ~shared
    return pairs[crosses | (shared & (b == 0) & (along > 0))]


def _turn(points: np.ndarray, edge: np.ndarray, point: np.ndarray) -> np.ndarray:
    return orientations(points, np.stack([edge[:, 0], edge[:, 1], point], axis=1))


def _arm(points: np.ndarray, edge: np.ndarray) -> np.ndarray:
    return points[edge[:, 1]] - points[edge[:, 0]]


def _covered_loops(case: Case, boundary: np.ndarray) -> list[Failure]:
    """Loops of the boundary that lie inside cells they do not belong to."""
    used, compact = np.unique(boundary, return_inverse=True)
    compact = compact.reshape(boundary.shape)
    _, loop = graphs.components(len(used), compact[:, 0], compact[:, 1])
    _, first = np.unique(loop, return_index=True)
    probe = used[first]
    pairs = case.mesh.locator.all_cells_of(case.mesh.points[probe])
    over = np.ones(len(pairs), bool)
    before = 0
    for rows in case.corners.values():
        at = np.flatnonzero((pairs[:, 1] >= before) & (pairs[:, 1] < before + len(rows)))
        corners = rows[pairs[at, 1] - before]
        over[at] = ~(corners == probe[pairs[at, 0], None]).any(axis=1)
        before += len(rows)
    covered = probe[np.unique(pairs[over, 0])]
    return offenders(
        "overlap",
        "point",
        covered,
        case.mesh.points[covered],
        "lies|lie on the boundary and yet in a cell of another loop",
    )


def check_topology(case: Case) -> Check:
    """Each region, and the whole, has as many components and holes as the domain."""
    rule, region = "components and holes", case.cell_region
    n = len(case.mesh.region_names)
    outer = np.r_[region, -1]
    inner = outer[case.edges.left] == outer[case.edges.right]
    each = _counts(case, inner, region, n)
    whole = each if n == 1 else _counts(case, inner | True, np.zeros_like(region), 1)
    if case.domain is None:
        return Check.skipped(rule, f"no domain to compare with; {_told(whole, 0)}")
    wanted_each, wanted_whole = region_counts(case.domain)
    failures = []
    if _told(whole, 0) != _told(wanted_whole, 0):
        message = f"the domain has {_told(wanted_whole, 0)}; the mesh has {_told(whole, 0)}"
        failures.append(Failure(rule, message))
    for i, j in enumerate(case.region_of_mesh[:n].tolist()):
        if j >= 0 and _told(each, i) != _told(wanted_each, j):
            message = f"region {case.mesh.region_names[i]!r} of the domain has "
            message += f"{_told(wanted_each, j)}; the mesh has {_told(each, i)}"
            failures.append(Failure(rule, message, (), "region", (i,)))
    return Check.of(rule, n, failures, _told(whole, 0))


def _counts(case: Case, is_open: np.ndarray, group: np.ndarray, n: int) -> Counts:
    count, component = components(case.edges, is_open)
    owner = np.zeros(count, np.int64)
    owner[component] = group
    pieces, euler = closure_counts(case.edges, component, group, n)
    return Counts(np.bincount(owner, minlength=n), pieces - euler, euler)


def _told(counts: Counts, i: int) -> str:
    parts, holes = int(counts.components[i]), int(counts.holes[i])
    return (
        f"{parts:,} component{'s' * (parts != 1)}, {holes:,} hole{'s' * (holes != 1)}, "
        f"Euler characteristic {counts.euler[i]}"
    )

"""Rules about how cells fit together: conforming, facets, no overlap, components and holes."""

from __future__ import annotations

import numpy as np

from csgmesh.measures.loops import region_counts
from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.measures.rules.case import Case
from csgmesh.mesh.orientation import orientations
from csgmesh.mesh.topology import components, connected, interior_euler
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
    _, loop = connected(len(used), compact[:, 0], compact[:, 1])
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
    rule, edges = "components and holes", case.edges
    region = np.r_[case.cell_region, -1]
    n = len(case.mesh.region_names)
    same = region[edges.left] == region[edges.right]
    parts, holes = _counts(case, same, case.cell_region, n)
    everything = np.ones(len(edges.points), bool)
    whole = _counts(case, everything, np.zeros(len(case.cell_region), np.int64), 1)
    summary = f"{whole[0][0]} components, {whole[1][0]} holes, Euler {whole[0][0] - whole[1][0]}"
    if case.domain is None:
        return Check.skipped(rule, f"no domain to compare with; {summary}")
    wanted_parts, wanted_holes = region_counts(case.domain)
    failures = []
    if (whole[0][0], whole[1][0]) != (wanted_parts[-1], wanted_holes[-1]):
        wanted = f"{wanted_parts[-1]} components and {wanted_holes[-1]} holes"
        failures.append(Failure(rule, f"the domain has {wanted}; the mesh has {summary}"))
    for i, j in enumerate(case.region_of_mesh[:n].tolist()):
        if j >= 0 and (parts[i], holes[i]) != (wanted_parts[j], wanted_holes[j]):
            wanted = f"{wanted_parts[j]} components and {wanted_holes[j]} holes"
            message = f"region {case.mesh.region_names[i]!r} has {wanted} in the domain; "
            message += f"the mesh has {parts[i]} and {holes[i]}"
            failures.append(Failure(rule, message, (), "region", (i,)))
    return Check.of(rule, n, failures, summary)


def _counts(
    case: Case, is_open: np.ndarray, region: np.ndarray, n: int
) -> tuple[np.ndarray, np.ndarray]:
    count, component = components(case.edges, is_open)
    owner = np.zeros(count, np.int64)
    owner[component] = region
    parts = np.bincount(owner, minlength=n)
    euler = np.zeros(n, np.int64)
    np.add.at(euler, owner, interior_euler(case.edges, component, is_open))
    return parts, parts - euler

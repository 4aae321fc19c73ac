"""Rules about names: of regions, boundaries and embedded points, against the domain."""

from __future__ import annotations

from collections import Counter

import numpy as np

from csgmesh.measures.matching import segments_at
from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.measures.rules.case import Case
from csgmesh.spatial import Boxes

_NO_DOMAIN = "no domain to compare with"


def check_names(case: Case) -> Check:
    """The mesh has the regions and boundary names of the domain; each is told of something."""
    rule, mesh = "names", case.mesh
    failures = _named_twice(rule, "region", mesh.region_names)
    failures += _idle_markers(case)
    domain = case.domain
    if domain is not None:
        failures += _differences(rule, "region", mesh.region_names, domain.region_names)
        failures += _differences(rule, "boundary", mesh.names, domain.names)
    return Check.of(rule, len(mesh.region_names) + len(mesh.names), failures)


def check_facet_names(case: Case) -> Check:
    """Each facet is named, by the names that the domain has there."""
    rule, mesh = "facet names", case.mesh
    named = np.r_[[bool(entry) for entry in mesh.boundary_names], False].astype(bool)
    bare = np.flatnonzero(~named[case.facet_marker])
    failures = offenders(rule, "facet", bare, case.facet_places(bare), "has|have no name")
    if case.domain is None:
        return Check.of(rule, len(case.facets), failures, "without a domain: that there is a name")
    table: dict[frozenset[str], int] = {}
    ours = _sets(mesh.boundary_names, table)
    theirs = _sets(case.domain.boundary_names, table)
    at, wanted = _domain_markers(case)
    wrong = at[ours[case.facet_marker[at]] != theirs[wanted]]
    detail = ""
    if len(wrong):
        first = wrong[0]
        detail = f"{_joined(mesh.boundary_names, case.facet_marker[first])} where the domain has "
        detail += _joined(case.domain.boundary_names, wanted[at == first][0])
    complaint = "has|have another name than the domain there"
    failures += offenders(rule, "facet", wrong, case.facet_places(wrong), complaint, detail)
    failures += _spanning(case, theirs)
    return Check.of(rule, len(case.facets), failures)


def check_sides(case: Case) -> Check:
    """Each facet has the regions on its sides that the domain has there."""
    rule = "regions"
    if case.domain is None:
        return Check.skipped(rule, _NO_DOMAIN)
    at = np.flatnonzero(case.matching.segment >= 0)
    wanted = case.domain.segment_region[case.matching.segment[at]]
    turned = case.matching.is_reversed[at]
    wanted = np.where(turned[:, None], wanted[:, ::-1], wanted)
    given = case.region_of_mesh[case.facet_region[at]]
    wrong = at[(given != wanted).any(axis=1)]
    failures = offenders(
        rule,
        "facet",
        wrong,
        case.facet_places(wrong),
        "has|have other regions on the sides than the domain",
    )
    return Check.of(rule, len(at), failures)


def check_embedded_points(case: Case) -> Check:
    """The embedded points of the domain are points of the mesh, and have their names."""
    rule, mesh = "embedded points", case.mesh
    if case.domain is None:
        return Check.skipped(rule, _NO_DOMAIN)
    table: dict[frozenset[str], int] = {}
    ours = _sets(mesh.boundary_names, table)[mesh.point_marker]
    theirs = _sets(case.domain.boundary_names, table)
    wanted = np.full(mesh.n_points, theirs[-1])
    failures: list[Failure] = []
    embedded = np.flatnonzero(case.domain.point_marker >= 0)
    if len(embedded):
        places = case.domain.points[embedded]
        boxes = Boxes(places - case.tolerance, places + case.tolerance)
        point, which = boxes.overlapping(mesh.points, mesh.points).T
        wanted[point] = theirs[case.domain.point_marker[embedded[which]]]
        lost = np.setdiff1d(np.arange(len(embedded)), which)
        failures += offenders(
            rule, "embedded point", embedded[lost], places[lost], "is|are not in the mesh"
        )
    wrong = np.flatnonzero(ours != wanted)
    failures += offenders(
        rule, "point", wrong, mesh.points[wrong], "has|have another name than the domain there"
    )
    return Check.of(rule, len(embedded), failures)


def _domain_markers(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Facets that lie on a segment of the domain, and the segment's marker."""
    assert case.domain is not None
    at = np.flatnonzero(case.matching.segment >= 0)
    return at, case.domain.segment_marker[case.matching.segment[at]]


def _spanning(case: Case, sets: np.ndarray) -> list[Failure]:
    """Facets that reach from one name, or one pair of regions, into the next."""
    assert case.domain is not None
    at = np.flatnonzero((case.matching.segment >= 0) & ~case.matching.is_vertex.all(axis=1))
    middle = case.matching.segment[at]
    attributes = np.column_stack(
        [sets[case.domain.segment_marker], np.sort(case.domain.segment_region, axis=1)]
    )
    bad = np.zeros(len(at), bool)
    for share in (1e-3, 1 - 1e-3):
        t = case.matching.interval[at] @ [1 - share, share]
        end = segments_at(case.matching.track, case.matching.curve[at], t)
        bad |= (end >= 0) & (attributes[end] != attributes[middle]).any(axis=1)
    wrong = at[bad]
    return offenders(
        "facet names", "facet", wrong, case.facet_places(wrong), "spans|span two boundaries"
    )


def _idle_markers(case: Case) -> list[Failure]:
    """Names that no facet and no point has."""
    mesh = case.mesh
    used = set(case.facet_marker.tolist()) | set(mesh.point_marker.tolist())
    told = {name for i, names in enumerate(mesh.boundary_names) if i in used for name in names}
    idle = [name for name in mesh.names if name not in told]
    if not idle:
        return []
    message = f"{_listed(idle)} named in boundary_names, but no facet or point has the name"
    return [Failure("names", message, (), "name", (), len(idle))]


def _named_twice(rule: str, what: str, names: tuple[str, ...]) -> list[Failure]:
    twice = sorted(name for name, n in Counter(names).items() if n > 1)
    if not twice:
        return []
    return [Failure(rule, f"{what} {_listed(twice)} is named twice", (), what, (), len(twice))]


def _differences(
    rule: str, what: str, ours: tuple[str, ...], theirs: tuple[str, ...]
) -> list[Failure]:
    have, wanted = set(ours), set(theirs)
    lost = [name for name in theirs if name not in have]
    new = [name for name in ours if name not in wanted]
    found = []
    if lost:
        message = f"{what} {_listed(lost)} of the domain is not in the mesh"
        found.append(Failure(rule, message, (), what, (), len(lost)))
    if new:
        message = f"{what} {_listed(new)} of the mesh is not in the domain"
        found.append(Failure(rule, message, (), what, (), len(new)))
    return found


def _sets(entries: tuple[tuple[str, ...], ...], table: dict[frozenset[str], int]) -> np.ndarray:
    """Number of each entry's set of names in a shared table; the last one stands for -1."""
    numbers = [table.setdefault(frozenset(entry), len(table)) for entry in (*entries, ())]
    return np.array(numbers, np.int64)


def _joined(entries: tuple[tuple[str, ...], ...], marker: int) -> str:
    names = entries[marker] if marker >= 0 else ()
    return " and ".join(map(repr, names)) or "no name"


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - 5} more" if len(names) > 5 else ""
    return ", ".join(map(repr, names[:5])) + more

"""The rule about periodic sides."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.names import find_markers
from csgmesh.errors import NameLookupError
from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.measures.rules.case import Case
from csgmesh.mesh import PeriodicPair

RULE = "periodic sides"


def check_periodic(case: Case) -> Check:
    """Points and facets of periodic sides match under the pair's map, all of them, once."""
    mesh = case.mesh
    failures: list[Failure] = []
    for pair in mesh.periodic:
        failures += _numbers(case, pair)
        if not failures:
            failures += _points(case, pair) + _facets(case, pair) + _completeness(case, pair)
    wanted = case.domain.periodic if case.domain is not None else ()
    for sides in wanted:
        found = [pair for pair in mesh.periodic if pair.names == sides.names]
        if not found:
            failures.append(_failure(f"the mesh does not pair {_joined(sides.names)}"))
        elif not _numbers(case, found[0]) and _apart(case, found[0], sides.matrix, sides.offset):
            failures.append(
                _failure(f"the map of {_joined(sides.names)} is not that of the domain")
            )
    return Check.of(RULE, sum(len(pair.points) for pair in mesh.periodic), failures)


def _failure(message: str) -> Failure:
    return Failure(RULE, message, (), "pair", (), 1)


def _joined(names: tuple[str, str]) -> str:
    return f"{names[0]!r} with {names[1]!r}"


def _numbers(case: Case, pair: PeriodicPair) -> list[Failure]:
    """Numbers that point at nothing."""
    mesh = case.mesh
    tables = [("point", pair.points, mesh.n_points)]
    tables += [(k, rows, len(mesh.facets.get(k, ()))) for k, rows in pair.facets.items()]
    for what, rows, end in tables:
        if rows.size and (rows.min() < 0 or rows.max() >= end):
            message = f"{_joined(pair.names)} must pair {what}s 0 to {end - 1}; "
            return [_failure(message + f"it has {rows.min()} to {rows.max()}")]
    return []


def _points(case: Case, pair: PeriodicPair) -> list[Failure]:
    points = case.mesh.points
    here, there = points[pair.points[:, 0]], points[pair.points[:, 1]]
    away = np.hypot(*(here @ pair.matrix.T + pair.offset - there).T)
    # Written so that a distance which is no number fails.
    wrong = np.flatnonzero(~(away <= case.tolerance))
    detail = f"{away[wrong[0]]:.3g} away" if len(wrong) else ""
    complaint = f"is|are not where {pair.names[0]!r} has its partner"
    return offenders(RULE, "point", pair.points[wrong, 1], there[wrong], complaint, detail)


def _facets(case: Case, pair: PeriodicPair) -> list[Failure]:
    """Facets whose ends are not partners of their partner's."""
    mesh = case.mesh
    image = np.full(mesh.n_points, -1)
    image[pair.points[:, 0]] = pair.points[:, 1]
    failures: list[Failure] = []
    for kind, rows in pair.facets.items():
        ends = mesh.facets[kind][:, :2]
        wrong = rows[(image[ends[rows[:, 0]]] != ends[rows[:, 1], ::-1]).any(axis=1), 0]
        places = mesh.points[ends[wrong]].mean(axis=1)
        complaint = f"has|have other partners in {pair.names[1]!r} than the ends"
        failures += offenders(RULE, "facet", wrong, places, complaint)
    return failures


def _completeness(case: Case, pair: PeriodicPair) -> list[Failure]:
    """Facets of a side without a partner, or with several."""
    mesh = case.mesh
    failures: list[Failure] = []
    for side, name in enumerate(pair.names):
        try:
            markers = find_markers(name, mesh.boundary_names)
        except NameLookupError as error:
            failures.append(_failure(str(error)))
            continue
        for kind, marker in mesh.facet_marker.items():
            rows = pair.facets.get(kind, np.zeros((0, 2), np.int64))
            count = np.bincount(rows[:, side], minlength=len(marker))
            wrong = np.flatnonzero(count != np.isin(marker, markers))
            places = mesh.points[mesh.facets[kind][wrong, :2]].mean(axis=1)
            complaint = f"has|have no single partner in the pair of {_joined(pair.names)}"
            failures += offenders(RULE, "facet", wrong, places, complaint)
    return failures


def _apart(case: Case, pair: PeriodicPair, matrix: np.ndarray, offset: np.ndarray) -> bool:
    points = case.mesh.points[pair.points[:, 0]]
    ours, theirs = points @ pair.matrix.T + pair.offset, points @ matrix.T + offset
    return bool(not (np.abs(ours - theirs) <= case.tolerance).all())

"""Rules about facets and the domain's exact curves."""

from __future__ import annotations

import numpy as np

from csgmesh.measures.matching import SAME_PARAMETER, Spans, join, ranks, same_place
from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.measures.rules.case import Case

_NO_DOMAIN = "no domain to compare with"


def check_on_curves(case: Case) -> Check:
    """Both ends of each facet lie on one exact curve of the domain."""
    rule = "on curves"
    if case.domain is None:
        return Check.skipped(rule, _NO_DOMAIN)
    matching = case.matching
    off = np.flatnonzero(matching.curve < 0)
    failures = offenders(
        rule, "facet", off, case.facet_places(off), "lies|lie on no curve of the domain"
    )
    # Merging moves vertices of the domain off their curves, by no more than the report says.
    allowed = case.tolerance + matching.is_vertex * case.domain.report.largest_displacement
    far = np.flatnonzero((matching.distance > allowed).any(axis=1))
    detail = f"off by {matching.distance[far[0]].max():.3g}" if len(far) else ""
    failures += offenders(
        rule, "facet", far, case.facet_places(far), "has|have an end off the exact curve", detail
    )
    inner = matching.distance[~matching.is_vertex & (matching.curve >= 0)[:, None]]
    worst = float(inner.max()) if len(inner) else 0.0
    note = f"largest distance {worst:.2g}, allowed {case.tolerance:.2g}"
    return Check.of(rule, len(case.facets), failures, note)


def check_deviation(case: Case) -> Check:
    """No exact curve is further from its straight facet than the deviation promised."""
    rule = "deviation"
    if case.domain is None:
        return Check.skipped(rule, _NO_DOMAIN)
    track = case.matching.track
    is_straight = np.ones(len(case.facets), bool)
    for _, numbers, _ in case.facet_nodes:
        is_straight[numbers] = False
    at = np.flatnonzero((case.matching.curve >= 0) & is_straight)
    ends = case.mesh.points[case.facets[at]]
    chord = ends[:, 1] - ends[:, 0]
    length = np.maximum(np.hypot(*chord.T), np.finfo(float).tiny)
    worst = np.zeros(len(at))
    for share in (0.25, 0.5, 0.75):
        t = case.matching.interval[at] @ [1 - share, share]
        arm = track.curves.points(case.matching.curve[at], t) - ends[:, 0]
        away = np.abs(chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]) / length
        worst = np.maximum(worst, away)
    allowed = promised_deviation(case)
    bad = at[worst > allowed]
    detail = f"{worst.max():.4g} is more than {allowed:.4g}" if len(bad) else ""
    failures = offenders(
        rule, "facet", bad, case.facet_places(bad), "strays|stray from the exact curve", detail
    )
    note = f"largest {worst.max() if len(worst) else 0.0:.3g}, allowed {allowed:.3g}"
    return Check.of(rule, len(at), failures, note)


def promised_deviation(case: Case) -> float:
    """The chord bound of the domain; a mesh that remembers a coarser one was asked for that."""
    assert case.domain is not None
    remembered = case.domain if case.mesh.domain is None else case.mesh.domain
    bound = max(case.domain.deviation, remembered.deviation)
    return bound + case.tolerance + case.domain.report.largest_displacement


def check_intervals(case: Case) -> Check:
    """The curve and interval that a facet claims end at its points, on the domain's curve."""
    rule, mesh = "intervals", case.mesh
    if mesh.curves is None:
        return Check.skipped(rule, "the mesh has no curves")
    at = np.flatnonzero(case.facet_curve >= 0)
    curve, interval = case.facet_curve[at], case.facet_interval[at]
    gap = np.zeros(len(at))
    slack = np.full(len(at), case.tolerance)
    for end in (0, 1):
        p = mesh.points[case.facets[at, end]]
        gap = np.maximum(gap, np.hypot(*(mesh.curves.points(curve, interval[:, end]) - p).T))
    if case.domain is not None:
        moved = case.matching.is_vertex[at].any(axis=1)
        slack[moved] += case.domain.report.largest_displacement
    wrong = at[~(gap <= slack)]
    failures = offenders(
        rule, "facet", wrong, case.facet_places(wrong), "has|have an interval that ends elsewhere"
    )
    if case.domain is not None:
        failures += _other_curve(case, at, slack) + _no_curve(case)
    return Check.of(rule, len(at), failures)


def _other_curve(case: Case, at: np.ndarray, slack: np.ndarray) -> list[Failure]:
    """Facets whose claimed curve leaves the domain's between the two ends."""
    assert case.mesh.curves is not None
    track = case.matching.track
    unsure = (case.matching.curve[at] >= 0) & ~_is_same_piece(case, at)
    at, slack = at[unsure], slack[unsure]
    away = np.zeros(len(at))
    for share in (0.25, 0.5, 0.75):
        t = case.facet_interval[at] @ [1 - share, share]
        p = case.mesh.curves.points(case.facet_curve[at], t)
        lo, hi = np.sort(case.matching.interval[at], axis=1).T
        nearest = track.curves.project(case.matching.curve[at], p, lo, hi)
        q = track.curves.points(case.matching.curve[at], nearest)
        away = np.maximum(away, np.hypot(*(p - q).T))
    # Projection onto a bent curve loses a few digits of its parameter, not of its distance.
    wrong = at[~(away <= 2 * slack)]
    return offenders(
        "intervals",
        "facet",
        wrong,
        case.facet_places(wrong),
        "names|name another curve than the domain has there",
    )


def _is_same_piece(case: Case, at: np.ndarray) -> np.ndarray:
    """Facets whose claim is, number by number, what was found: most, and quick to tell."""
    ours, theirs = case.mesh.curves, case.matching.track
    assert ours is not None
    claimed, found = case.facet_curve[at], case.matching.curve[at]
    same = (ours.kind[claimed] == theirs.curves.kind[found]) & (found >= 0)
    same &= (ours.data[claimed] == theirs.curves.data[found]).all(axis=1)
    apart = np.abs(case.facet_interval[at] - case.matching.interval[at]).max(axis=1, initial=0.0)
    extent = theirs.extent[found, 1] - theirs.extent[found, 0]
    return same & (apart <= SAME_PARAMETER * extent)


def _no_curve(case: Case) -> list[Failure]:
    assert case.domain is not None
    segment = case.matching.segment
    has_curve = np.r_[case.domain.segment_curve >= 0, False][segment]
    wrong = np.flatnonzero(has_curve & (case.facet_curve < 0))
    return offenders(
        "intervals",
        "facet",
        wrong,
        case.facet_places(wrong),
        "has|have no curve where the domain has one",
    )


def check_coverage(case: Case) -> Check:
    """Every curve of the domain is covered by facets once, and nothing else is."""
    rule = "coverage"
    if case.domain is None:
        return Check.skipped(rule, _NO_DOMAIN)
    matching = case.matching
    track, tolerance = matching.track, case.tolerance
    at = np.flatnonzero(matching.curve >= 0)
    given = join(track, matching.curve[at], matching.interval[at], tolerance)
    wanted = join(track, track.curve, track.interval, tolerance)
    twice = np.sort(at[given.overlapping])
    failures = offenders(
        rule, "facet", twice, case.facet_places(twice), "covers|cover what another one covers"
    )
    bare = np.flatnonzero(~_covered(case, track.curve, track.interval, given))
    places = case.domain.points[case.domain.segments[bare]].mean(axis=1)
    names = case.domain.boundary_names
    detail = ""
    if len(bare):
        detail = _joined(names[case.domain.segment_marker[bare[0]]])
    failures += offenders(rule, "segment", bare, places, "is|are not covered by facets", detail)
    extra = at[~_covered(case, matching.curve[at], matching.interval[at], wanted)]
    failures += offenders(
        rule, "facet", extra, case.facet_places(extra), "lies|lie where the domain has no segment"
    )
    return Check.of(rule, len(track.curve), failures)


def _covered(case: Case, curve: np.ndarray, interval: np.ndarray, spans: Spans) -> np.ndarray:
    """Whether each interval lies within a span."""
    track = case.matching.track
    lo, hi = interval.min(axis=1), interval.max(axis=1)
    at = ranks(spans.curve, spans.lo, curve, interval.mean(axis=1)) - 1
    if not len(spans.curve):
        return np.zeros(len(curve), bool)
    held = (at >= 0) & (spans.curve[at] == curve)
    low, high = spans.lo[at], spans.hi[at]
    inside = (low <= lo) & (hi <= high)
    near = (low <= lo) | same_place(track, curve, low, lo, case.tolerance)
    near &= (hi <= high) | same_place(track, curve, high, hi, case.tolerance)
    return held & (inside | near)


def _joined(names: tuple[str, ...]) -> str:
    return " and ".join(map(repr, names)) or "unnamed"

"""Rules about amounts: areas against the exact curves, and samples against the tree."""

from __future__ import annotations

import numpy as np

from csgmesh.measures.results import Check, Failure, offenders
from csgmesh.measures.rules.bends import bulges, polynomial_terms
from csgmesh.measures.rules.case import Case
from csgmesh.measures.rules.curves import promised_deviation
from csgmesh.spatial import Boxes
from csgmesh.tolerance import AREA_SHARE, coordinate_ulp

#: Points tried against the tree.
N_SAMPLES = 100_000
_SEED = 20260117


def check_area(case: Case) -> Check:
    """The cells of each region, with what lies between chords and curves, have its exact area."""
    rule = "area"
    total = float(case.quality.area.sum())
    if case.domain is None:
        return Check.skipped(rule, f"no domain to compare with; the cells cover {total:.12g}")
    n = len(case.mesh.region_names)
    covered = _sums(case.quality.area, case.cell_region, n)
    bulge = _bulges(case)
    given = covered + bulge
    exact = case.domain.areas()
    ends = case.mesh.points[case.facets]
    perimeter = float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())
    slack = AREA_SHARE * case.diagonal**2 + coordinate_ulp(case.mesh.points) * perimeter
    failures = []
    for i, j in enumerate(case.region_of_mesh[:n].tolist()):
        if j >= 0 and not abs(given[i] - exact[j]) <= slack:
            message = f"region {case.mesh.region_names[i]!r} has area {exact[j]:.15g}; the mesh "
            message += f"covers {given[i]:.15g}, which is off by {given[i] - exact[j]:.3g}"
            failures.append(Failure(rule, message, (), "region", (i,)))
    off = float(given.sum() - exact.sum())
    note = f"cells {total:.12g}, with the curves {given.sum():.12g}, off by {off:.2g}"
    return Check.of(rule, case.mesh.n_cells, failures, note)


def _bulges(case: Case) -> np.ndarray:
    """Area between each region's facets and their exact curves, (n_regions,)."""
    matching = case.matching
    at = np.flatnonzero(matching.curve >= 0)
    lo, hi = case.mesh.points.min(axis=0), case.mesh.points.max(axis=0)
    origin = 0.5 * (lo + hi)
    curves = matching.track.curves
    start, end = matching.interval[at].T
    term = curves.area_terms(matching.curve[at], start, end, origin=origin)
    term -= polynomial_terms(case, at, origin)
    n = len(case.mesh.region_names)
    left, right = case.facet_region[at].T
    total = np.bincount(left[left >= 0], term[left >= 0], n)
    return total - np.bincount(right[right >= 0], term[right >= 0], n)


def _sums(values: np.ndarray, group: np.ndarray, n: int) -> np.ndarray:
    """Sum of each group, pairwise: running sums of a million areas would lose three digits."""
    order = np.argsort(group, kind="stable")
    ends = np.searchsorted(group[order], np.arange(n + 1))
    return np.array([values[order[ends[i] : ends[i + 1]]].sum() for i in range(n)])


def check_samples(case: Case) -> Check:
    """Random points lie in the same region of the mesh as of the tree, boundaries apart.

    Curved cells are located by their corners, so that what lies between their facets and the chords
    of these counts as boundary too.
    """
    rule = "samples"
    if case.contains is None or case.domain is None:
        return Check.skipped(rule, "no shape to compare with")
    lo, hi = case.domain.bounds()
    points = lo + (hi - lo) * np.random.default_rng(_SEED).random((N_SAMPLES, 2))
    cell = case.mesh.locate(points)
    given = case.region_of_mesh[np.r_[case.cell_region, -1][cell]]
    wanted = np.asarray(case.contains(points))
    differ = np.flatnonzero(given != wanted)
    bad = differ[~_near_facets(case, points[differ], promised_deviation(case) + bulges(case))]
    detail = ""
    if len(bad):
        names = (*case.domain.region_names, "outside")
        theirs = names[wanted[bad[0]]]
        ours = names[given[bad[0]]] if given[bad[0]] > -2 else "a region of another name"
        detail = f"{ours} in the mesh, {theirs} in the shape"
    failures = offenders(
        rule, "sample", bad, points[bad], "lies|lie in another region than in the shape", detail
    )
    note = f"{len(differ) - len(bad)} within the deviation of a boundary"
    return Check.of(rule, N_SAMPLES, failures, note)


def _near_facets(case: Case, points: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Which points lie within a distance (f,) of a facet's chord."""
    near = np.zeros(len(points), bool)
    if not len(points) or not len(case.facets):
        return near
    ends = case.mesh.points[case.facets]
    boxes = Boxes(ends.min(axis=1) - distance[:, None], ends.max(axis=1) + distance[:, None])
    pairs = boxes.overlapping(points, points)
    a, b = ends[pairs[:, 1], 0], ends[pairs[:, 1], 1]
    p, along = points[pairs[:, 0]] - a, b - a
    share = np.clip((p * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)
    away = np.hypot(*(p - share[:, None] * along).T)
    near[pairs[away <= distance[pairs[:, 1]], 0]] = True
    return near

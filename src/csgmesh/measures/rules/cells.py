"""Rules about single cells: orientation, smallest angle, Delaunay."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.input_angles import ANGLE_ROUNDING, input_angles
from csgmesh.measures.results import Check, offenders
from csgmesh.measures.rules.case import Case
from csgmesh.mesh import KINDS
from csgmesh.mesh.orientation import orientations
from csgmesh.spatial import Boxes
from csgmesh.tolerance import EXCUSED_ANGLE, coordinate_ulp


def check_orientation(case: Case) -> Check:
    """Every cell is counterclockwise, by an exact predicate; quads are convex."""
    rule, bad, before = "orientation", [np.zeros(0, np.int64)], 0
    for rows in case.corners.values():
        k = rows.shape[1]
        wrong = np.zeros(len(rows), bool)
        # A quad is convex when it turns left at each corner, a triangle's three turns are one.
        for j in range(1 if k == 3 else k):
            triples = rows[:, [(j - 1) % k, j, (j + 1) % k]]
            wrong |= orientations(case.mesh.points, triples) <= 0
        bad.append(np.flatnonzero(wrong) + before)
        before += len(rows)
    numbers = np.concatenate(bad)
    what = "is|are not counterclockwise"
    if _has_quads(case):
        what += " and convex"
    failures = offenders(rule, "cell", numbers, case.cell_places(numbers), what)
    return Check.of(rule, before, failures)


def check_jacobian(case: Case) -> Check:
    """The Jacobian of curved cells is positive everywhere, by its Bernstein coefficients."""
    rule, mesh = "Jacobian", case.mesh
    curved = [KINDS[kind].order > 1 and kind != "quad8" for kind in mesh.cells]
    widths = [len(rows) for rows in mesh.cells.values()]
    is_curved = np.repeat(curved, widths).astype(bool)
    if not is_curved.any():
        return Check.skipped(rule, "no curved cells")
    ratio = case.quality.scaled_jacobian
    bad = np.flatnonzero(is_curved & ~(ratio > 0))
    failures = offenders(
        rule, "cell", bad, case.cell_places(bad), "is|are turned over where the cell is bent"
    )
    note = f"smallest over largest {ratio[is_curved].min():.3g}"
    return Check.of(rule, int(is_curved.sum()), failures, note)


def _has_quads(case: Case) -> bool:
    return any(rows.shape[1] == 4 for rows in case.corners.values())


def check_angles(case: Case) -> Check:
    """No angle is below the bound, but for cells at input angles below 60 degrees."""
    rule, bound = "smallest angle", case.min_angle
    smallest = case.quality.min_angle
    if bound is None:
        found = f"; the smallest is {smallest.min():.2f}°" if len(smallest) else ""
        return Check.skipped(rule, "no bound was asked for" + found)
    # Rounded coordinates turn an edge by this much.
    shortest = np.maximum(case.quality.min_edge, np.finfo(float).tiny)
    slack = ANGLE_ROUNDING + np.degrees(coordinate_ulp(case.mesh.points) / shortest)
    low = np.flatnonzero(smallest < bound - slack)
    if case.domain is None and len(low):
        told = "1 cell is" if len(low) == 1 else f"{len(low):,} cells are"
        reason = f"{told} below {bound:g}°; without a domain no input angle can excuse them"
        return Check.skipped(rule, reason)
    excused = excused_cells(case, low)
    bad = low[~excused]
    detail = f"{smallest[bad[0]]:.4g}°" if len(bad) else ""
    complaint = f"has|have an angle below {bound:g}°"
    failures = offenders(rule, "cell", bad, case.cell_places(bad), complaint, detail)
    rest = np.ones(len(smallest), bool)
    rest[low] = False
    reached = f"{smallest[rest].min():.2f}° elsewhere, " if rest.any() else ""
    note = f"bound {bound:g}°; {reached}{int(excused.sum())} cells excused at input angles"
    return Check.of(rule, len(smallest), failures, note)


def excused_cells(case: Case, cells: np.ndarray) -> np.ndarray:
    """Which cells touch the apex of an input angle below 60 degrees or lie in its shell."""
    out = np.zeros(len(cells), bool)
    if case.domain is None or not len(cells):
        return out
    apexes, angles, radius = input_angles(case.domain)
    sharp = angles < EXCUSED_ANGLE
    apexes, radius = apexes[sharp], radius[sharp]
    if not len(apexes):
        return out
    boxes = Boxes(apexes - radius[:, None], apexes + radius[:, None])
    before = 0
    slack = case.tolerance
    for rows in case.corners.values():
        at = np.flatnonzero((cells >= before) & (cells < before + len(rows)))
        corners = case.mesh.points[rows[cells[at] - before]]
        pairs = boxes.overlapping(corners.min(axis=1), corners.max(axis=1))
        reach = np.hypot(*np.moveaxis(corners[pairs[:, 0]] - apexes[pairs[:, 1], None], 2, 0))
        near = reach.min(axis=1) <= radius[pairs[:, 1]] + slack
        out[at[pairs[near, 0]]] = True
        before += len(rows)
    return out


def check_delaunay(case: Case) -> Check:
    """How many edges are not Delaunay, facets apart; a failure where the mesh promised it.

    Where none is, facets inside included, the discrete maximum principle holds for linear elements
    with values given on the boundary (Ciarlet and Raviart 1973).
    """
    rule = "Delaunay"
    if _has_quads(case):
        return Check.skipped(rule, "only of triangles")
    edges, cot = case.edges, _opposite_cotangents(case)
    is_facet = np.zeros(len(cot), bool)
    is_facet[case.facet_edge[case.facet_edge >= 0]] = True
    inner = ~is_facet & (edges.count == 2)
    # Opposite angles that add up to 180 degrees have opposite cotangents.
    is_obtuse = cot < -_COCIRCULAR
    bad = np.flatnonzero(inner & is_obtuse)
    n, n_facets = len(bad), int((is_facet & is_obtuse & (edges.count == 2)).sum())
    told = "1 edge is" if n == 1 else f"{n:,} edges are"
    note = f"{told} not Delaunay" if n else "constrained Delaunay"
    if n + n_facets == 0:
        note = "Delaunay; the discrete maximum principle holds"
    failures = []
    if case.mesh.info.get("delaunay") is True:
        failures = offenders(rule, "edge", bad, case.edge_places(bad), "is|are not Delaunay")
    return Check.of(rule, int(inner.sum()), failures, note)


def _opposite_cotangents(case: Case) -> np.ndarray:
    """Sum of the cotangents of the angles opposite each edge, (e,)."""
    edges, points = case.edges, case.mesh.points
    rows = np.concatenate([np.zeros((0, 3), np.int64), *case.corners.values()])
    cot = np.zeros(len(edges.points))
    for k in range(3):
        apex, a, b = (points[rows[:, j % 3]] for j in (k + 2, k, k + 1))
        p, q = a - apex, b - apex
        det = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            value = (p * q).sum(axis=1) / det
        # Half-edge k of each cell lies opposite its corner k + 2.
        cot += np.bincount(edges.half_edge_edge[k::3], value, len(cot))
    return cot


#: Sums of cotangents above minus this are cocircular within rounding.
_COCIRCULAR = 1e-9

"""Rules about the nodes of curved facets."""

from __future__ import annotations

import numpy as np

from csgmesh.measures.jacobians import edge_area_terms
from csgmesh.measures.results import Check, offenders
from csgmesh.measures.rules.case import Case
from csgmesh.measures.rules.curves import promised_deviation
from csgmesh.mesh.lagrange import EQUISPACED, basis
from csgmesh.mesh.nodes import node_family

#: Places along a facet where its polynomial is compared with the exact curve.
_PLACES = np.linspace(0.0, 1.0, 13)[1:-1, None]
#: What lies between these places is further away by no more than this factor.
_BETWEEN = 1.1


def check_edge_nodes(case: Case) -> Check:
    """Curved facets: nodes on the exact curve, and what lies between them near it.

    A mesh from a file, or told by other nodes than it was made with, has its nodes on polynomials
    near the curve; these, like chords, keep to the deviation.
    """
    rule, total, worst, off = "edge nodes", 0, 0.0, 0.0
    if not case.facet_nodes:
        return Check.skipped(rule, "no curved facets")
    if case.domain is None:
        return Check.skipped(rule, "no domain to compare with")
    failures = []
    for kind, numbers, nodes in case.facet_nodes:
        known = case.matching.curve[numbers] >= 0
        numbers, nodes = numbers[known], nodes[known]
        values = basis(kind, node_family(case.mesh), _PLACES)
        stray = _distance(case, numbers, values @ nodes)
        node = _distance(case, numbers, nodes[:, 2:])
        exact = bool(case.mesh.info.get("nodes_on_curves"))
        allowed = case.tolerance if exact else promised_deviation(case)
        bad = numbers[(node > allowed) | (stray > promised_deviation(case))]
        worst, off = max(worst, stray.max(initial=0.0)), max(off, node.max(initial=0.0))
        total += len(numbers)
        failures += offenders(
            rule, "facet", bad, case.facet_places(bad), "leaves|leave the exact curve"
        )
    note = f"nodes off by {off:.2g}, polynomials by {worst:.2g}"
    return Check.of(rule, total, failures, note)


def _distance(case: Case, facets: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Largest distance of points (k, j, 2) from their facets' exact curves, (k,)."""
    j = points.shape[1]
    lo, hi = np.sort(case.matching.interval[facets], axis=1).T
    on = np.repeat(case.matching.curve[facets], j)
    curves = case.matching.track.curves
    t = curves.project(on, points.reshape(-1, 2), np.repeat(lo, j), np.repeat(hi, j))
    gap = curves.points(on, t) - points.reshape(-1, 2)
    away: np.ndarray = np.hypot(*gap.T).reshape(-1, j).max(axis=1, initial=0.0)
    return away


def polynomial_terms(case: Case, facets: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Green's terms along facets as they are, straight or curved, about a point, (k,)."""
    a, b = (case.mesh.points[case.facets[facets, k]] - origin for k in (0, 1))
    terms = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    all_terms = np.zeros(len(case.facets))
    all_terms[facets] = terms
    family = node_family(case.mesh) if case.facet_nodes else EQUISPACED
    for _, numbers, nodes in case.facet_nodes:
        all_terms[numbers] = edge_area_terms(nodes - origin, family)
    return all_terms[facets]


def bulges(case: Case) -> np.ndarray:
    """How far each facet bends away from its chord at most, (f,); 0 for straight ones."""
    away = np.zeros(len(case.facets))
    for kind, numbers, nodes in case.facet_nodes:
        values = basis(kind, node_family(case.mesh), _PLACES)
        chord = nodes[:, :1] + _PLACES * (nodes[:, 1:2] - nodes[:, :1])
        away[numbers] = np.hypot(*np.moveaxis(values @ nodes - chord, 2, 0)).max(axis=1) * _BETWEEN
    return away

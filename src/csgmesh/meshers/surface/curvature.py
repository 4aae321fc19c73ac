"""How fast exact surfaces and curves bend at the points of a `Plc`."""

from __future__ import annotations

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.meshers.surface.complexes import FeatureComplex
from csgmesh.meshers.surface.workpiece import feet_and_normals

#: Edges shorter than this share of the diagonal say nothing of curvature.
_SHORT = 1e-7


def curvatures(plc: Plc, parts: FeatureComplex) -> np.ndarray:
    """Largest curvature of the surfaces and curves at each point, seen along its edges, (n,)."""
    out = np.zeros(len(plc.points))
    short = _SHORT * plc.diagonal
    bent = np.flatnonzero(plc.surfaces.kind[plc.facet_surface] != 0)
    if len(bent):
        corners = plc.facets[bent]
        on = np.repeat(plc.facet_surface[bent], 3)
        flat = corners.ravel()
        # Beside the point itself, towards the facet's middle: apexes have no normal.
        middle = plc.points[corners].mean(axis=1)
        beside = 0.98 * plc.points[flat] + 0.02 * np.repeat(middle, 3, axis=0)
        normals = feet_and_normals(plc.surfaces, on, beside)[1].reshape(-1, 3, 3)
        for i, j in ((0, 1), (1, 2), (2, 0)):
            a, b = corners[:, i], corners[:, j]
            length = np.sqrt(((plc.points[a] - plc.points[b]) ** 2).sum(axis=1))
            turn = np.sqrt(((normals[:, i] - normals[:, j]) ** 2).sum(axis=1))
            bend = np.where(length > short, turn / np.maximum(length, short), 0.0)
            np.maximum.at(out, a, bend)
            np.maximum.at(out, b, bend)
    _add_curves(out, plc, parts, short)
    return out


def _add_curves(out: np.ndarray, plc: Plc, parts: FeatureComplex, short: float) -> None:
    """Curvature of curves, from the turn between the two pieces at each point."""
    flat = parts.segments.ravel()
    order = np.argsort(flat, kind="stable")
    along = np.flatnonzero(parts.dim == 1)
    start = np.searchsorted(flat[order], along)
    ends = [plc.points[flat[order[start + k] ^ 1]] - plc.points[along] for k in (0, 1)]
    length = [np.sqrt((e**2).sum(axis=1)) for e in ends]
    known = np.minimum(*length) > short
    unit = [e[known] / d[known, None] for e, d in zip(ends, length, strict=True)]
    turn = np.sqrt(((unit[0] + unit[1]) ** 2).sum(axis=1))
    bend = 2.0 * turn / (length[0] + length[1])[known]
    np.maximum.at(out, along[known], bend)

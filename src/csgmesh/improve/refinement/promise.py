"""What a refined mesh promises of its angles."""

from __future__ import annotations

from typing import Any

import numpy as np

from csgmesh import kernels
from csgmesh.measures.rules.case import Case
from csgmesh.measures.rules.cells import excused_cells
from csgmesh.measures.shapes import measure_cells
from csgmesh.mesh import Mesh


def refined_info(mesh: Mesh, method: str, has_green: bool) -> dict[str, Any]:
    """Facts for a mesh refined from this one; the bound on the angles is what the method keeps.

    ``macro_min_angle`` is the bound of the mesh that was refined first.
    """
    info = {**mesh.info, "refinement": method, "delaunay": False}
    macro = mesh.info.get("macro_min_angle", mesh.info.get("min_angle"))
    if mesh.info.get("refinement", method) != method:
        macro = mesh.info.get("min_angle")
    if not isinstance(macro, (int, float)):
        return info
    bound = float(macro)
    if method != "red-green":
        bound *= 0.5
    elif has_green:
        bound = float(np.degrees(np.arctan(np.tan(np.radians(bound)) / 3.0)))
    return {**info, "min_angle": bound, "macro_min_angle": float(macro)}


def corner_sines(mesh: Mesh) -> np.ndarray:
    """Smallest sine of each cell's angles, counted through all kinds, (n_cells,)."""
    out, first = np.empty(mesh.n_cells), 0
    for rows in mesh.cells.values():
        part = out[first : first + len(rows)]
        kernels.corner_sines(mesh.points.reshape(-1), rows.reshape(-1), rows.shape[1], part)
        first += len(rows)
    return out


def angle_reached(mesh: Mesh, sines: np.ndarray, bound: float) -> float:
    """The bound, or the smallest angle below it that no sharp corner of the domain excuses."""
    low = np.flatnonzero(sines < np.sin(np.radians(bound)))
    angle, first = np.full(len(low), 180.0), 0
    for rows in mesh.cells.values():
        at = np.flatnonzero((low >= first) & (low < first + len(rows)))
        angle[at] = measure_cells(mesh.points, rows[low[at] - first]).min_angle
        first += len(rows)
    low, angle = low[angle < bound], angle[angle < bound]
    angle = angle[~excused_cells(Case(mesh, mesh.domain, None, bound), low)]
    return float(min(bound, angle.min(initial=bound)))

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


def corner_sines(points: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Smallest sine of the angles of each cell, (m,)."""
    out = np.empty(len(rows))
    flat = np.ascontiguousarray(rows).reshape(-1).view()
    flat.flags.writeable = False
    kernels.corner_sines(points.reshape(-1), flat, rows.shape[1], out)
    return out


def angle_reached(mesh: Mesh, cells: np.ndarray, bound: float) -> float:
    """The bound, or the smallest angle of some cells that no sharp corner of the domain excuses."""
    low, angle, first = [], [], 0
    for rows in mesh.cells.values():
        at = cells[(cells >= first) & (cells < first + len(rows))] - first
        at = at[corner_sines(mesh.points, rows[at]) < np.sin(np.radians(bound))]
        low.append(first + at)
        angle.append(measure_cells(mesh.points, rows[at]).min_angle)
        first += len(rows)
    number, smallest = np.concatenate(low), np.concatenate(angle)
    number, smallest = number[smallest < bound], smallest[smallest < bound]
    if len(number):
        smallest = smallest[~excused_cells(Case(mesh, mesh.domain, None, bound), number)]
    return float(smallest.min(initial=bound))

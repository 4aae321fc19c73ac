"""The last step of a refinement: room beside curves, and what the angles are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from csgmesh.improve.refinement.bending import make_room
from csgmesh.improve.refinement.green import Block
from csgmesh.improve.refinement.promise import angle_reached, corner_sines
from csgmesh.mesh import Mesh

#: Cells at curves may lose this share of their smallest sine before vertices make room for them,
#: unless an angle was promised.
_LOSS = 0.1


def settled(refined: Mesh, bent: np.ndarray, mesh: Mesh, blocks: list[Block]) -> Mesh:
    """A refined mesh with room made beside curves, and the bound on its angles that was reached.

    Only cells near curves, and those whose parents are below the bound, need a look.

    Parameters
    ----------
    refined : Mesh
    bent : (k,) int64
        New vertices off their chords.
    mesh : Mesh
        Before refinement.
    blocks : list of Block
        Its cells, green ones put together.
    """
    promised = "macro_min_angle" in refined.info
    bound, macro = _number(refined, "min_angle"), _number(refined, "macro_min_angle")
    if not len(bent) and not promised:
        return refined
    sine = np.zeros(mesh.n_cells)
    for block in blocks:
        sine[block.source] = corner_sines(mesh.points, block.rows)
    parent = np.concatenate(list(refined.cell_parent.values()))
    near = _near_curves(mesh, blocks) if len(bent) else np.zeros(mesh.n_cells, bool)
    cells = np.flatnonzero(near[parent])
    if len(cells):
        share = 0.5 if refined.info["refinement"] != "red-green" else 1.0
        own = share * sine[parent[cells]]
        least = np.sin(np.radians(bound)) if promised else 0.0
        wanted = np.minimum(own, np.maximum((1.0 - _LOSS) * own, least))
        refined = make_room(refined, bent, mesh.n_points, cells, wanted)
    if not promised:
        return refined
    near |= sine < np.sin(np.radians(macro))
    reached = angle_reached(refined, np.flatnonzero(near[parent]), bound)
    return replace(refined, info={**refined.info, "min_angle": reached})


def _near_curves(mesh: Mesh, blocks: list[Block]) -> np.ndarray:
    """Cells within two cells of a facet with a bent curve, (n_cells,) bool."""
    curve = mesh.facet_curve["line"]
    assert mesh.curves is not None
    is_bent = np.where(curve >= 0, mesh.curves.kind[curve] > 0, False)
    touched = np.zeros(mesh.n_points, bool)
    touched[mesh.facets["line"][is_bent]] = True
    near = np.zeros(mesh.n_cells, bool)
    for _ in range(2):
        wider = touched.copy()
        for block in blocks:
            hit = touched[block.rows].any(axis=1)
            near[block.source[hit]] = True
            wider[block.rows[hit]] = True
        touched = wider
    return near


def _number(mesh: Mesh, fact: str) -> float:
    value = mesh.info.get(fact)
    return float(value) if isinstance(value, (int, float)) else 0.0

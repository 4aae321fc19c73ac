"""What a tetrahedralisation of a domain is made of."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True, eq=False)
class Tetrahedra:
    """Tetrahedra of which every triangle of a surface mesh is a face.

    Attributes
    ----------
    points : (n, 3) float64
        Those of the surface first, then those given inside, then any that were added.
    tets : (m, 4) int64
        Of positive volume. None if triangles are missing.
    region : (m,) int64
    triangles : (k, 3) int64
        The surface's, some of them swapped.
    face : (k,) int64
        Face of the surface mesh that each lies on.
    missing : (j,) int64
        Triangles that are no faces of tetrahedra.
    places : (j, 3) float64
        Where these are: a finer surface there will help.
    """

    points: np.ndarray
    tets: np.ndarray
    region: np.ndarray
    triangles: np.ndarray
    face: np.ndarray
    missing: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    places: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))

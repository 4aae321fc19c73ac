"""Which cells are to be refined, as the user says it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.mesh import Mesh


def marked_cells(mesh: Mesh, cells: Any) -> np.ndarray:
    """Numbers of marked cells, counted through all kinds.

    Parameters
    ----------
    mesh : Mesh
    cells : array_like or mapping of str to array_like
        A mask or numbers, of all cells or by kind.

    Examples
    --------
    >>> mesh = Mesh([[0, 0], [1, 0], [0, 1]], {"triangle": [[0, 1, 2]]})
    >>> marked_cells(mesh, [True]), marked_cells(mesh, {"triangle": [0]})
    (array([0]), array([0]))
    """
    if not isinstance(cells, Mapping):
        return _numbers(cells, mesh.n_cells, "cells")
    unknown = [kind for kind in cells if kind not in mesh.cells]
    if unknown:
        held = ", ".join(mesh.cells) or "no cells"
        raise InputError(f"cells must be of kinds in the mesh ({held}); got {unknown[0]!r}")
    found, before = [np.zeros(0, np.int64)], 0
    for kind, rows in mesh.cells.items():
        if kind in cells:
            found.append(before + _numbers(cells[kind], len(rows), f"cells[{kind!r}]"))
        before += len(rows)
    return np.concatenate(found)


def _numbers(given: Any, n: int, name: str) -> np.ndarray:
    array = np.asarray(given)
    if array.ndim != 1:
        raise InputError(f"{name} must be a mask or a list of cells; got shape {array.shape}")
    if array.dtype == bool:
        if len(array) != n:
            raise InputError(f"{name} as a mask must have {n} entries; got {len(array)}")
        return np.flatnonzero(array)
    if array.size and array.dtype.kind not in "iu":
        raise InputError(f"{name} must be a mask or cell numbers; got {array.dtype}")
    if array.size and not 0 <= array.min() <= array.max() < n:
        raise InputError(
            f"{name} must hold numbers from 0 to {n - 1}; got {array.min()} to {array.max()}"
        )
    return array.astype(np.int64)

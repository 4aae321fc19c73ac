"""The structure of a grid: its blocks, with cells and points numbered by i and j."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from csgmesh.errors import InputError
from csgmesh.mesh.fields import frozen


@dataclass(frozen=True, eq=False)
class Block:
    """A block of a structured grid.

    Attributes
    ----------
    cells : (ni, nj) int64
        Number of each quad; or (ni, nj, 2), of the two triangles it was split into.
    points : (ni + 1, nj + 1) int64
        Number of the point at each corner of the cells; i and j are right-handed. In a block that
        closes on itself the first and the last column, or row, are the same points.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0), (2, 1)), cm.Structured(), size=0.5)
    >>> x = mesh.points[mesh.blocks["domain"].points]
    >>> x.shape, x[1, 0]
    ((5, 3, 2), array([0.5, 0. ]))
    """

    cells: np.ndarray
    points: np.ndarray

    def __post_init__(self) -> None:
        shape = (None, None) if np.ndim(self.cells) == 2 else (None, None, 2)
        object.__setattr__(self, "cells", frozen("block cells", self.cells, np.int64, shape))
        object.__setattr__(
            self, "points", frozen("block points", self.points, np.int64, (None,) * 2)
        )
        ni, nj = self.cells.shape[:2]
        if self.points.shape != (ni + 1, nj + 1):
            raise InputError(
                f"a block of ({ni}, {nj}) cells has ({ni + 1}, {nj + 1}) points; "
                f"got {self.points.shape}"
            )


def frozen_blocks(value: Mapping[str, Any]) -> Mapping[str, Block]:
    """A read-only mapping of names to blocks."""
    for name, block in value.items():
        if not isinstance(block, Block):
            raise InputError(f"blocks[{name!r}] must be a Block; got {type(block).__name__}")
    return MappingProxyType(dict(value))

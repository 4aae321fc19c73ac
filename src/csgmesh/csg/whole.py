"""What can be asked of a domain that is more than a shape."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from csgmesh.csg import checks

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from csgmesh.csg.program import Program


class Whole(ABC):
    """Several materials, or a domain with something added: compiled like a shape."""

    @property
    @abstractmethod
    def dim(self) -> int:
        """2 in the plane, 3 in space."""

    @cached_property
    def _program(self) -> Program:
        from csgmesh.csg.program import compile_shape

        whole: Any = self
        return compile_shape(whole)

    def contains(self, points: ArrayLike) -> np.ndarray:
        """Which of the points, ``(n, dim)``, lie in the domain: ``(n,)`` bool."""
        return self._program.contains(checks.query_points(points, self.dim))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of a box around the domain."""
        return self._program.bounds()

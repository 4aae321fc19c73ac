"""What boundary layers are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from csgmesh.errors import InputError
from csgmesh.options import check_choice


@dataclass(frozen=True)
class Layers:
    """Thin cells along a wall, in layers that grow away from it.

    Parameters
    ----------
    first : float
        Height of the first layer, in coordinate units.
    growth : float, default 1.2
        Each layer's height over that of the one before it, at least 1.
    n : int, default 10
        Number of layers.
    cells : {"quad", "triangle"}, default "quad"
        Whether to split each quad along its shorter diagonal.

    Raises
    ------
    InputError
        If an option is out of range.

    Examples
    --------
    >>> Layers(first=1e-3, growth=2, n=3).heights()
    array([0.   , 0.001, 0.003, 0.007])
    """

    first: float
    growth: float = 1.2
    n: int = 10
    cells: Literal["quad", "triangle"] = "quad"

    def __post_init__(self) -> None:
        if not (np.isfinite(self.first) and self.first > 0):
            raise InputError(f"first must be a positive height; got {self.first!r}")
        if not (np.isfinite(self.growth) and self.growth >= 1):
            raise InputError(f"growth must be at least 1; got {self.growth!r}")
        if isinstance(self.n, bool) or int(self.n) != self.n or self.n < 1:
            raise InputError(f"n must be a positive number of layers; got {self.n!r}")
        check_choice("cells", self.cells, ("quad", "triangle"), "Layers")

    def heights(self) -> np.ndarray:
        """Distance of each layer's top from the wall, beginning with 0, (n + 1,)."""
        return self.first * np.concatenate([[0.0], np.cumsum(self.growth ** np.arange(self.n))])


def checked_layers(layers: Any) -> Mapping[str, Layers]:
    """Layers by names of boundaries.

    Raises
    ------
    InputError
        If it is no mapping of names to `Layers`, or walls differ in their number of layers.
    """
    if not isinstance(layers, Mapping):
        raise InputError(f"layers must map names of boundaries to Layers; got {layers!r}")
    for name, value in layers.items():
        if not isinstance(value, Layers):
            raise InputError(f"layers of {name!r} must be Layers(first=…); got {value!r}")
    if len({(value.n, value.cells) for value in layers.values()}) > 1:
        listed = ", ".join(f"{v.n} of {v.cells}s on {k!r}" for k, v in layers.items())
        raise InputError(f"all walls have equally many layers of one kind of cells; got {listed}")
    return layers

"""Sides of a domain that are to be meshed alike, so that a solver can join them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from csgmesh.csg.embed import Embed
from csgmesh.csg.nodes import Shape
from csgmesh.csg.regions import Regions
from csgmesh.csg.whole import Whole
from csgmesh.errors import ShapeError


@dataclass(frozen=True, repr=False, init=False)
class Periodic(Whole):
    """A domain with pairs of sides whose vertices must match.

    The two sides of a pair must be congruent: a translation or a rotation takes the first to the
    second, and the domain beside the first to the outside of the second, as for opposite sides of a
    cell or the two radial sides of a sector. The map is found from the sides. Both sides get the
    same vertices; `csgmesh.Mesh.periodic` says which belong together.

    Parameters
    ----------
    shape : Shape, Regions or Embed
    pairs : sequence of (str, str)
        Names of boundaries: each an exact name, a prefix or a glob, so that a side may consist of
        several parts. It may have gaps, if both sides of the pair have the same ones.

    Raises
    ------
    ShapeError
        If an argument is of another kind. Whether the names exist and the sides are congruent is
        seen when the domain is evaluated (`NameLookupError`, `EvaluationError`).

    Examples
    --------
    >>> import csgmesh as cm
    >>> cell = cm.Box((0, 0), (1, 1), name="cell") - cm.Disk((0.5, 0.5), 0.3, name="hole")
    >>> both = [("cell.left", "cell.right"), ("cell.bottom", "cell.top")]
    >>> mesh = cm.generate(cm.Periodic(cell, both), size=0.1)
    >>> [pair.names for pair in mesh.periodic]
    [('cell.left', 'cell.right'), ('cell.bottom', 'cell.top')]
    >>> left, right = mesh.points[mesh.periodic[0].points].swapaxes(0, 1)
    >>> bool((right - left == [1, 0]).all())
    True
    """

    shape: Shape | Regions | Embed
    pairs: tuple[tuple[str, str], ...]

    def __init__(self, shape: Shape | Regions | Embed, pairs: Iterable[tuple[str, str]]) -> None:
        if not isinstance(shape, Shape | Regions | Embed):
            raise ShapeError(f"Periodic: a shape, Regions or Embed is needed; got {shape!r}")
        if shape.dim != 2:
            raise ShapeError(
                f"Periodic: only plane domains have periodic sides; the shape has dim {shape.dim}"
            )
        if isinstance(pairs, str) or not isinstance(pairs, Iterable):
            raise ShapeError(f"Periodic: pairs must be a sequence of two names each; got {pairs!r}")
        object.__setattr__(self, "shape", shape)
        object.__setattr__(self, "pairs", tuple(_pair(k, p) for k, p in enumerate(pairs)))

    @property
    def dim(self) -> int:
        """2."""
        return self.shape.dim

    def __repr__(self) -> str:
        return f"Periodic({self.shape!r}, {list(self.pairs)!r})"

    def __str__(self) -> str:
        return f"{self.shape}, periodic in {len(self.pairs)}"

    def __reduce__(self) -> tuple[type[Periodic], tuple[Any, ...]]:
        return Periodic, (self.shape, self.pairs)

    def to_dict(self) -> dict[str, Any]:
        """The domain as lists, numbers and strings, ready for JSON; `from_dict` reads it back."""
        return {"periodic": self.shape.to_dict(), "pairs": [list(pair) for pair in self.pairs]}

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Periodic:
        """The domain that `to_dict` wrote."""
        inner = data.get("periodic") if isinstance(data, dict) else None
        if not isinstance(inner, dict) or not isinstance(data.get("pairs"), list):
            raise ShapeError("from_dict: a dictionary with a domain and a list of pairs is needed")
        shape: Shape | Regions | Embed
        if "embed" in inner:
            shape = Embed.from_dict(inner)
        elif "regions" in inner:
            shape = Regions.from_dict(inner)
        else:
            shape = Shape.from_dict(inner)
        return Periodic(shape, data["pairs"])


def _pair(number: int, pair: Any) -> tuple[str, str]:
    is_pair = isinstance(pair, list | tuple) and len(pair) == 2
    if not is_pair or not all(isinstance(name, str) and name for name in pair):
        raise ShapeError(
            f"Periodic: pairs must be of two names each, such as ('box.left', 'box.right'); "
            f"pair {number} is {pair!r}"
        )
    first, second = pair
    if first == second:
        raise ShapeError(f"Periodic: pairs must be of two sides; pair {number} is {first!r} twice")
    return first, second

"""Several materials in one domain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from csgmesh.csg import checks
from csgmesh.csg.nodes import LARGEST_TREE, Shape
from csgmesh.csg.whole import Whole
from csgmesh.errors import ShapeError


@dataclass(frozen=True, repr=False, init=False)
class Regions(Whole):
    """Several materials: a mapping from region names to shapes.

    Later entries cover earlier ones; the meshes of neighbours conform at their interface.

    Parameters
    ----------
    shapes : mapping of str to Shape
        In order; at least one.

    Attributes
    ----------
    entries : tuple of (str, Shape)

    Raises
    ------
    ShapeError
        If there is no entry, a name is unusable, a value is no shape or dimensions differ.

    Examples
    --------
    >>> import csgmesh as cm
    >>> ground = cm.Regions({"rock": cm.Box((0, 0), (4, 2)), "core": cm.Disk((2, 1), 0.5)})
    >>> ground.contains([(1, 1), (5, 1)])
    array([ True, False])
    """

    entries: tuple[tuple[str, Shape], ...]

    def __init__(self, shapes: Mapping[str, Shape]) -> None:
        if not isinstance(shapes, Mapping):
            raise ShapeError(f"Regions: a mapping of names to shapes is needed; got {shapes!r}")
        if not shapes:
            raise ShapeError("Regions: at least one region is needed; got an empty mapping")
        entries = tuple((checks.name(key, "Regions"), shape) for key, shape in shapes.items())
        for key, shape in entries:
            if not isinstance(shape, Shape):
                raise ShapeError(f"Regions: region {key!r} must be a shape; got {shape!r}")
            if shape.dim != entries[0][1].dim:
                raise ShapeError(
                    f"Regions: all regions must have the same dimension; {key!r} has {shape.dim}, "
                    f"{entries[0][0]!r} has {entries[0][1].dim}"
                )
        total = sum(shape.n_nodes for _, shape in entries)
        if total > LARGEST_TREE:
            raise ShapeError(
                f"Regions: all regions together may hold at most {LARGEST_TREE:,} leaves and "
                f"operations; these would hold {total:,}"
            )
        object.__setattr__(self, "entries", entries)

    @property
    def dim(self) -> int:
        """2 in the plane, 3 in space."""
        return self.entries[0][1].dim

    def __repr__(self) -> str:
        return f"Regions({{{', '.join(f'{name!r}: {shape!r}' for name, shape in self.entries)}}})"

    def __str__(self) -> str:
        return f"regions {', '.join(repr(name) for name, _ in self.entries)}"

    def __reduce__(self) -> tuple[type[Regions], tuple[dict[str, Shape]]]:
        return Regions, (dict(self.entries),)

    def to_dict(self) -> dict[str, Any]:
        """The regions as lists, numbers and strings, ready for JSON."""
        return {"regions": [[name, shape.to_dict()] for name, shape in self.entries]}

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Regions:
        """The regions that `to_dict` wrote."""
        entries = data.get("regions") if isinstance(data, dict) else None
        if not isinstance(entries, list) or not all(
            isinstance(entry, list | tuple) and len(entry) == 2 for entry in entries
        ):
            raise ShapeError("from_dict: a dictionary with a list of regions is needed")
        return Regions({name: Shape.from_dict(shape) for name, shape in entries})

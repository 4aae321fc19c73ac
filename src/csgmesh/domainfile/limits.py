"""What a domain file may cost: it comes from strangers, and a few lines can ask for anything."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from csgmesh.errors import InputError
from csgmesh.options import check_options


@dataclass(frozen=True)
class Limits:
    """Largest file, document and mesh that a domain file may ask for.

    Attributes
    ----------
    file_size : int
        Bytes of the file.
    nesting : int
        Levels of mappings and lists, and of shapes inside shapes.
    values : int
        Values in the document, an alias counting for all it stands for.
    expression_length : int
        Characters of one arithmetic expression.
    leaves : int
        Primitives in the tree, a shape counting wherever it is referred to.
    cells : int
        Cells of the mesh.

    Examples
    --------
    >>> Limits().raised(cells=5_000_000).cells
    5000000
    """

    file_size: int = 1_000_000
    nesting: int = 50
    values: int = 200_000
    expression_length: int = 1_000
    leaves: int = 20_000
    cells: int = 2_000_000

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise InputError(f"limit {field.name} must be a positive whole number, not {value}")
        # The reading of nested values recurses; beyond this Python's own stack would decide.
        if self.nesting > 100:
            raise InputError(f"limit nesting may be at most 100, not {self.nesting}")

    def raised(self, **limits: int) -> Limits:
        """A copy with other limits.

        Raises
        ------
        InputError
            A limit that does not exist, or is not a positive whole number.
        """
        check_options(limits, [field.name for field in fields(self)], "Limits")
        return replace(self, **limits)

"""Every error csgmesh raises on purpose.

::

    CsgmeshError
    ├── InputError (ValueError)         what the user gave cannot be used; exit code 2
    │   ├── ShapeError                  an argument of a shape or of an operation on shapes
    │   ├── NameLookupError (KeyError)  a name, prefix or glob that matches nothing
    │   ├── DomainFileError             a YAML domain file; carries file, line and column
    │   ├── ExpressionError             arithmetic in a domain file; carries the offset in its text
    │   ├── FileFormatError             a mesh or picture file that cannot be read or written
    │   └── SizeError                   a size that is not positive and finite; carries the point
    ├── EvaluationError                 the tree has no usable boundary; exit code 3
    │   ├── UnboundedDomainError
    │   └── EmptyDomainError
    └── MeshingError                    the mesher could not do it; exit code 3
        └── BudgetError                 the budget of points ran out; carries the mesh so far

A message states the rule, the value given and where. Unfinished work is returned on the error.
"""

from __future__ import annotations

from typing import Any


class CsgmeshError(Exception):
    """Base of all errors of csgmesh."""

    exit_code = 3


class InputError(CsgmeshError, ValueError):
    """What the user gave cannot be used."""

    exit_code = 2


class ShapeError(InputError):
    """An argument of a shape, or of an operation on shapes, breaks a rule."""


class NameLookupError(InputError, KeyError):
    """A name, prefix or glob matches nothing."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class DomainFileError(InputError):
    """A domain file is wrong; the message starts with ``file:line:column``."""

    def __init__(self, message: str, *, file: str = "", line: int = 0, column: int = 0) -> None:
        place = ":".join(str(p) for p in (file, line, column) if p)
        super().__init__(f"{place}: {message}" if place else message)
        self.file, self.line, self.column = file, line, column


class ExpressionError(InputError):
    """An arithmetic expression is wrong; `offset` counts characters from the start of its text."""

    def __init__(self, message: str, *, offset: int = 0) -> None:
        super().__init__(message)
        self.offset = offset


class FileFormatError(InputError):
    """A file cannot be read or written in the wanted format."""


class SizeError(InputError):
    """A size is not positive and finite, or a size callable misbehaves."""


class EvaluationError(CsgmeshError):
    """The tree has no boundary that could be meshed; the message names the leaves and the place."""


class UnboundedDomainError(EvaluationError):
    """The domain reaches to infinity."""


class EmptyDomainError(EvaluationError):
    """The domain has no interior."""


class MeshingError(CsgmeshError):
    """The mesher could not do it; the message names the place."""


class BudgetError(MeshingError):
    """The budget of points ran out.

    Attributes
    ----------
    mesh : csgmesh.Mesh or None
        The conforming mesh so far; it may break the angle or size bound.
    """

    def __init__(self, message: str, mesh: Any = None) -> None:
        super().__init__(message)
        self.mesh = mesh

"""Domain files: YAML → a shape, a mesher, sizes and expectations."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from csgmesh.csg.program import compile_shape
from csgmesh.domain.curves import LINE
from csgmesh.domainfile.document import Document, KeyPath, read_document
from csgmesh.domainfile.expect import Expect, Mismatch, mismatches
from csgmesh.domainfile.expressions import Expression
from csgmesh.domainfile.fields import ValidationContext
from csgmesh.domainfile.limits import Limits
from csgmesh.domainfile.methods import as_written, mesher_of, option_named_in
from csgmesh.domainfile.outputs import check_suffix
from csgmesh.domainfile.parameters import described, resolve_parameters
from csgmesh.domainfile.parts import Problem, problems_of
from csgmesh.domainfile.schema import file_model
from csgmesh.domainfile.shapes import Builder, build_shapes, placed
from csgmesh.domainfile.size_fields import build as build_size
from csgmesh.domainfile.size_fields import place_in
from csgmesh.domainfile.sizes import ExpressionSize, constant_or_size
from csgmesh.domainfile.vocabulary import mesher_classes
from csgmesh.errors import (
    BudgetError,
    DomainFileError,
    EvaluationError,
    ExpressionError,
    FileFormatError,
    InputError,
)

if TYPE_CHECKING:
    from csgmesh.comparison import Comparison
    from csgmesh.mesh import Mesh

_MOST_PROBLEMS = 10


@dataclass(frozen=True, eq=False)
class DomainFile:
    """What a domain file says.

    Attributes
    ----------
    path : Path
        The file.
    shape : Shape, Regions, Embed or Periodic
        What to mesh.
    mesher : mesher or None
        How; None for the default mesher.
    size : float, mapping, callable or None
        Wanted edge length, as `csgmesh.generate` takes it.
    deviation, snap : float or None
        As `csgmesh.generate` takes them.
    output : tuple of Path
        Files to write, beside the domain file.
    expect : Expect or None
        What the mesh must be like.
    parameters : mapping of str to float
        Values of the parameters.
    limits : Limits
        What the file may cost.
    """

    path: Path
    shape: Any
    mesher: Any
    size: Any
    deviation: float | None
    snap: float | None
    output: tuple[Path, ...]
    expect: Expect | None
    parameters: Mapping[str, float]
    limits: Limits
    document: Document = field(repr=False)

    def generate(self, progress: Callable[[str, int, int], None] | None = None) -> Mesh:
        """The mesh.

        Parameters
        ----------
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Raises
        ------
        DomainFileError
            A size for a name that the domain does not have, or that is not positive somewhere.
        EvaluationError
            The domain is empty or unbounded.
        BudgetError
            The mesh would have more than ``limits.cells`` cells.
        MeshingError
            The mesher could not do it.
        """
        from csgmesh import pipeline

        try:
            mesh = pipeline.generate(
                self.shape,
                self._bounded_mesher(),
                self.size,
                deviation=self.deviation,
                snap=self.snap,
                progress=progress,
            )
        except BudgetError as error:
            raise BudgetError(f"{error}; a domain file may {self._allowance}", error.mesh) from None
        except InputError as error:
            raise self._placed(error) from None
        except EvaluationError as error:
            line, column = self.document.place(self._domain_path, key=True)
            place = f"{self.document.file}:{line}:{column}"
            raise type(error)(f"{place}: {error}") from None
        if mesh.n_cells > self.limits.cells:
            raise BudgetError(
                f"the mesh has {mesh.n_cells} cells; a domain file may {self._allowance}", mesh
            )
        return mesh

    def compare(self, progress: Callable[[str, int, int], None] | None = None) -> Comparison:
        """The domain through every mesher that can take it, that of the file first.

        Raises
        ------
        DomainFileError
            A size for a name that the domain does not have, or that is not positive somewhere.
        EvaluationError
            The domain is empty or unbounded.
        """
        from csgmesh.comparison import compare, meshers_of

        meshers = {} if self.mesher is None else {"as the file says": self.mesher}
        try:
            return compare(
                self.shape,
                self.size,
                meshers | meshers_of(getattr(self.shape, "dim", 2)),
                deviation=self.deviation,
                snap=self.snap,
                max_points=max(16, self.limits.cells // 2),
                progress=progress,
            )
        except InputError as error:
            raise self._placed(error) from None

    def mismatches(self, mesh: Mesh) -> list[tuple[Mismatch, str]]:
        """What a mesh has against the ``expect`` block, each with its ``file:line:column``."""
        if self.expect is None:
            return []
        found = []
        for mismatch in mismatches(mesh, self.expect):
            line, column = self.document.place(("expect", *mismatch.path))
            found.append((mismatch, f"{self.document.file}:{line}:{column}"))
        return found

    @property
    def _allowance(self) -> str:
        return f"ask for {self.limits.cells} cells (limit cells)"

    def _bounded_mesher(self) -> Any:
        """The mesher with a budget of points that keeps the cells within their limit."""
        mesher, is_solid = self.mesher, getattr(self.shape, "dim", 2) == 3
        if mesher is None:
            mesher = mesher_classes()["octree" if is_solid else "delaunay_refinement"]()
        if "max_points" not in {option.name for option in fields(mesher)}:
            return mesher
        # A triangulation has at most two triangles a point; of tetrahedra there are five to six.
        most = max(4, self.limits.cells // (5 if is_solid else 2))
        return replace(mesher, max_points=min(mesher.max_points, most))

    def _placed(self, error: InputError) -> DomainFileError:
        """An error of the pipeline at the size, the option or the shape that it is about."""
        message = str(error)
        sizes = self.size if isinstance(self.size, Mapping) else {"": self.size}
        for name, size in sizes.items():
            text = size.expression.text if isinstance(size, ExpressionSize) else name
            if name and (repr(name) in message or repr(text) in message):
                return self.document.error(message, ("mesh", "size", name), key=True)
        inside = option_named_in(self.document, message)
        if inside is not None:
            return self.document.error(message, inside, key=True)
        for quoted in re.findall(r"'([^']+)'", message):
            inside = place_in(self.document.data, ("mesh", "size"), quoted)
            if inside is not None:
                return self.document.error(message, inside)
        option = re.match(r"(deviation|snap|size)\b", message)
        if option is not None:
            return self.document.error(message, ("mesh", option.group()), key=True)
        for quoted in re.findall(r"'([^']+)'", message):
            for name in reversed(quoted.split(".")):
                if self.document.has(("shapes", name)):
                    return self.document.error(message, ("shapes", name), key=True)
        return self.document.error(message, self._domain_path, key=True)

    @property
    def _domain_path(self) -> KeyPath:
        return ("domain",) if self.document.has(("domain",)) else ("regions",)


def load(
    path: str | os.PathLike[str],
    *,
    parameters: Mapping[str, float | str] | None = None,
    limits: Limits | None = None,
) -> DomainFile:
    """Read a domain file.

    Parameters
    ----------
    path : path-like
        A YAML file.
    parameters : mapping of str to float or str, optional
        Values that replace those of the file's parameters.
    limits : Limits, optional
        What the file may cost: its size, nesting, number of values, leaves and cells.

    Returns
    -------
    DomainFile
        With `shape`, `mesher`, `size`, `expect`, `output` and `generate()`.

    Raises
    ------
    DomainFileError
        Anything wrong with the file, as ``file:line:column: message``.
    InputError
        A parameter that the file does not have.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> text = "{csgmesh: 1, parameters: {r: 1}, domain: {disk: {center: [0, 0], radius: $r}}}"
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "disk.yaml")
    ...     _ = path.write_text(text)
    ...     load(path, parameters={"r": 2}).shape
    Disk((0, 0), 2)
    """
    path = Path(path)
    bounds = limits if limits is not None else Limits()
    document = read_document(path, bounds)
    if not isinstance(document.data, dict):
        raise document.error(
            "a domain file is a mapping with the keys csgmesh, shapes, domain, …, "
            f"not {described(document.data)}"
        )
    values = resolve_parameters(document, parameters or {}, bounds)
    context = ValidationContext(values, bounds)
    try:
        part = file_model().model_validate(document.data, context=context)
    except ValidationError as error:
        raise _joined(document, list(problems_of(error))) from None
    builder = build_shapes(document, part.shapes, bounds)
    shape = _domain(part, builder)
    mesh = part.mesh
    _check_chords(document, shape, mesh.deviation, bounds)
    return DomainFile(
        path=path,
        shape=shape,
        mesher=mesher_of(document, mesh),
        size=_size(document, mesh.size, shape.dim, values),
        deviation=mesh.deviation,
        snap=mesh.snap,
        output=tuple(_output(document, path, i, name) for i, name in enumerate(part.output)),
        expect=part.expect,
        parameters=values,
        limits=bounds,
        document=document,
    )


def _joined(document: Document, problems: list[Problem]) -> DomainFileError:
    """One error for all that is wrong: the first place in the file leads."""
    errors = [
        document.error(p.message, as_written(document, p.path), key=p.is_key, offset=p.offset)
        for p in problems
    ]
    errors.sort(key=lambda error: (error.line, error.column))
    first, *others = errors[:_MOST_PROBLEMS]
    if not others:
        return first
    message = str(first).split(": ", 1)[1]
    listed = "\n".join([message, *map(str, others)])
    if len(errors) > _MOST_PROBLEMS:
        listed += f"\n… and {len(errors) - _MOST_PROBLEMS} more"
    return DomainFileError(listed, file=document.file, line=first.line, column=first.column)


def _domain(part: Any, builder: Builder) -> Any:
    if part.regions is None:
        return builder.shape(part.domain, ("domain",))
    shapes = {n: builder.shape(s, ("regions", n)) for n, s in part.regions.items()}
    return builder.regions(shapes, ("regions",))


def _size(document: Document, size: Any, dim: int, parameters: Mapping[str, float]) -> Any:
    def resolved(value: Any, path: KeyPath) -> Any:
        if not isinstance(value, Expression):
            return value
        try:
            return constant_or_size(value, dim, parameters)
        except ExpressionError as error:
            raise document.error(str(error), path, offset=error.offset) from None

    def at(path: KeyPath, make: Callable[[], Any]) -> Any:
        return placed(document, path, make)

    if isinstance(size, dict):
        return {n: build_size(v, resolved, at, ("mesh", "size", n)) for n, v in size.items()}
    return build_size(size, resolved, at, ("mesh", "size"))


def _output(document: Document, path: Path, number: int, name: str) -> Path:
    given = Path(name)
    # A file from strangers writes beside itself and nowhere else.
    if given.is_absolute() or ".." in given.parts or not given.name:
        raise document.error(
            f"output must be a file in the folder of the domain file, not {name!r}",
            ("output", number),
        )
    try:
        check_suffix(given)
    except FileFormatError as error:
        raise document.error(str(error), ("output", number)) from None
    return path.parent / given


def _check_chords(document: Document, shape: Any, deviation: float | None, limits: Limits) -> None:
    """Refuse a deviation that needs more chords than the mesh may have cells."""
    if deviation is None:
        return
    chords = 0.0
    for leaf in compile_shape(shape).leaves:
        lo, hi = leaf.box
        in_space = len(lo) == 3
        if np.isfinite([lo, hi]).all() and (in_space or (leaf.curves()[0].kind != LINE).any()):
            radius = 0.5 * float(np.sqrt(((hi - lo) ** 2).sum()))
            # A chord over the angle a of a circle deviates by r (1 - cos(a/2)), about r a²/8.
            around = np.pi * np.sqrt(0.5 * radius / deviation)
            chords += around**2 if in_space else around
    if chords > limits.cells:
        raise document.error(
            f"deviation {deviation:g} needs about {chords:.1g} chords; a domain file may ask "
            f"for {limits.cells} cells (limit cells)",
            ("mesh", "deviation"),
        )

"""``csgmesh draw``: a picture of a mesh or of a domain."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from csgmesh.cli.sources import (
    AnyPath,
    LimitOptions,
    MaxCells,
    Parameters,
    is_domain_file,
    is_shape_file,
    load_domain_file,
    mesh_of,
)
from csgmesh.errors import InputError

if TYPE_CHECKING:
    from csgmesh.domainfile import DomainFile


def draw(
    file: AnyPath,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="The picture: .png, .svg or .pdf. Default: FILE with .png in this folder.",
        ),
    ] = None,
    domain: Annotated[
        bool, typer.Option("--domain", help="Draw the exact domain instead of its mesh.")
    ] = False,
    view: Annotated[
        str | None,
        typer.Option(
            metavar="A,B", help="In space: degrees around z and above it; default -60,25."
        ),
    ] = None,
    cut: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,Z,U,V,W",
            help="In space: leave out the cells in front of a plane, by its point and normal.",
        ),
    ] = None,
    param: Parameters = None,
    max_cells: MaxCells = None,
    limit: LimitOptions = None,
) -> None:
    """Draw a mesh file, a shape's file, or the mesh or domain of a domain file.

    A solid whose domain file names no mesher is drawn itself.
    """
    from csgmesh.viz import draw as picture

    options: dict[str, Any] = {}
    if view is not None:
        options["view"] = _numbers(view, "--view", 2)
    if cut is not None:
        numbers = _numbers(cut, "--cut", 6)
        options["cut"] = (numbers[:3], numbers[3:])
    target = out or Path(file.with_suffix(".png").name)
    if is_shape_file(file):
        from csgmesh.io import read_shape

        thing: Any = read_shape(file)
    elif is_domain_file(file):
        thing = _of_domain_file(load_domain_file(file, param, max_cells, limit), domain)
    elif domain:
        raise InputError(f"{file}: --domain needs a domain file (.yaml)")
    else:
        thing = mesh_of(file, param, max_cells, limit)
    picture(thing, target, **options)
    typer.echo(target)


def _of_domain_file(file: DomainFile, domain: bool) -> Any:
    """The shape, or its mesh."""
    from csgmesh.cli.progress import TerminalProgress

    if domain or (file.mesher is None and file.shape.dim == 3):
        return file.shape
    with TerminalProgress() as progress:
        return file.generate(progress)


def _numbers(text: str, option: str, count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(float(word) for word in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != count:
        raise InputError(f"{option} takes {count} numbers between commas, not {text!r}")
    return numbers

"""``csgmesh draw``: a picture of a mesh or of a domain."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from csgmesh.cli.sources import (
    AnyPath,
    LimitOptions,
    MaxCells,
    Parameters,
    is_domain_file,
    load_domain_file,
    mesh_of,
)
from csgmesh.errors import InputError


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
    param: Parameters = None,
    max_cells: MaxCells = None,
    limit: LimitOptions = None,
) -> None:
    """Draw a mesh file, or the mesh or domain of a domain file."""
    from csgmesh.viz import draw as picture

    if domain and not is_domain_file(file):
        raise InputError(f"{file}: --domain needs a domain file (.yaml)")
    target = out or Path(file.with_suffix(".png").name)
    if domain:
        thing = load_domain_file(file, param, max_cells, limit).shape
    else:
        thing = mesh_of(file, param, max_cells, limit)
    picture(thing, target)
    typer.echo(target)

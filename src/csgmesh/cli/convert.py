"""``csgmesh convert``: a mesh file into another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from csgmesh.cli.sources import is_domain_file
from csgmesh.errors import InputError


def convert(
    source: Annotated[Path, typer.Argument(metavar="IN", help="A mesh file.")],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="The mesh file to write.")],
) -> None:
    """Convert a mesh file, names and regions included."""
    from csgmesh.io import read, write

    if is_domain_file(source):
        raise InputError(f"{source} is a domain file; mesh it: csgmesh mesh {source} -o {target}")
    mesh = read(source)
    write(target, mesh)
    typer.echo(f"{target}: {mesh.n_points:,} points, {mesh.n_cells:,} cells")

"""The commands, each in a file of its own."""

from __future__ import annotations

from typing import Annotated

import typer

from csgmesh import __version__
from csgmesh.cli.check import check
from csgmesh.cli.compare import compare
from csgmesh.cli.convert import convert
from csgmesh.cli.draw import draw
from csgmesh.cli.failures import reported
from csgmesh.cli.mesh import mesh
from csgmesh.cli.quality import quality
from csgmesh.cli.schema import schema

app = typer.Typer(
    name="csgmesh",
    help="Constructive solid geometry to meshes that a solver can trust.",
    epilog="Exit codes: 0 done, 1 the check failed, 2 bad input, 3 the mesher could not do it.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"csgmesh {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Options before the command."""


for command in (mesh, draw, check, quality, convert, compare, schema):
    app.command(command.__name__)(reported(command))

"""``csgmesh quality``: a table of the cells' measures."""

from __future__ import annotations

from typing import Annotated

import typer

from csgmesh.cli.sources import AnyPath, LimitOptions, MaxCells, Parameters, mesh_of


def quality(
    file: AnyPath,
    worst: Annotated[
        int,
        typer.Option("--worst", "-w", min=0, metavar="N", help="List the N worst cells and why."),
    ] = 0,
    param: Parameters = None,
    max_cells: MaxCells = None,
    limit: LimitOptions = None,
) -> None:
    """Print how good the cells of a mesh are."""
    from csgmesh.measures import quality as measure

    mesh = mesh_of(file, param, max_cells, limit)
    typer.echo(measure(mesh))
    if worst:
        from csgmesh.meshers.worst import describe, worst_cells

        for cell in worst_cells(mesh, worst):
            typer.echo(describe(cell))

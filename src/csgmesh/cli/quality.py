"""``csgmesh quality``: a table of the cells' measures."""

from __future__ import annotations

import typer

from csgmesh.cli.sources import AnyPath, LimitOptions, MaxCells, Parameters, mesh_of


def quality(
    file: AnyPath,
    param: Parameters = None,
    max_cells: MaxCells = None,
    limit: LimitOptions = None,
) -> None:
    """Print how good the cells of a mesh are."""
    from csgmesh.measures import quality as measure

    typer.echo(measure(mesh_of(file, param, max_cells, limit)))

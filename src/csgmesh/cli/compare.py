"""``csgmesh compare``: a domain file through every mesher that can take it."""

from __future__ import annotations

import typer

from csgmesh.cli.progress import TerminalProgress
from csgmesh.cli.sources import DomainPath, LimitOptions, MaxCells, Parameters, load_domain_file


def compare(
    file: DomainPath,
    param: Parameters = None,
    max_cells: MaxCells = None,
    limit: LimitOptions = None,
) -> None:
    """Mesh a domain file by every mesher, and print cells, quality, time and memory.

    The mesher that the file asks for comes first. Those that cannot mesh it say why.
    """
    with TerminalProgress() as progress:
        table = load_domain_file(file, param, max_cells, limit).compare(progress)
    typer.echo(str(table))

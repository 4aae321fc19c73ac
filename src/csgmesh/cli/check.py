"""``csgmesh check``: domain files against their expectations, meshes against the rules."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from csgmesh.cli.failures import report
from csgmesh.cli.progress import TerminalProgress
from csgmesh.cli.sources import (
    LimitOptions,
    MaxCells,
    Parameters,
    is_domain_file,
    load_domain_file,
)
from csgmesh.errors import CsgmeshError

if TYPE_CHECKING:
    from csgmesh.measures import Certificate

FAILED = 1


def check(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Domain files and mesh files.")
    ],
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print every rule, not failures only.")
    ] = False,
    param: Parameters = None,
    max_cells: MaxCells = None,
    limit: LimitOptions = None,
) -> None:
    """Check files: exit code 0 if all pass, 1 if one fails.

    A domain file is meshed; the mesh must be valid, match the shape evaluated anew, and meet the
    file's expectations. A mesh file must hold a valid mesh.
    """
    worst = 0
    for file in files:
        try:
            certificate, broken = _checked(file, param, max_cells, limit)
        except CsgmeshError as error:
            report(error, file)
            worst = max(worst, error.exit_code)
            continue
        problems = [f"{file}: {failure}" for failure in certificate.failures] + broken
        if verbose:
            typer.echo(f"{file}:\n{certificate}")
        for problem in problems:
            typer.echo(problem)
        if problems:
            worst = max(worst, FAILED)
        elif not verbose:
            typer.echo(f"{file}: ok, {_counted(certificate)}")
    raise typer.Exit(worst)


def _counted(certificate: Certificate) -> str:
    passed = sum(rule.status == "passed" for rule in certificate.checks)
    skipped = sum(rule.status == "skipped" for rule in certificate.checks)
    return f"{passed} rules passed" + (f", {skipped} skipped" if skipped else "")


def _checked(
    file: Path, param: list[str] | None, max_cells: int | None, limit: list[str] | None
) -> tuple[Certificate, list[str]]:
    """The certificate, and the expectations that are not met, each with its place."""
    from csgmesh.pipeline import check as verify

    if not is_domain_file(file):
        from csgmesh.io import read

        return verify(read(file)), []
    domain_file = load_domain_file(file, param, max_cells, limit)
    with TerminalProgress() as progress:
        mesh = domain_file.generate(progress)
        certificate = verify(mesh, domain_file.shape)
    return certificate, [f"{place}: {m}" for m, place in domain_file.mismatches(mesh)]

"""``csgmesh mesh``: a domain file into mesh files and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from csgmesh.cli.progress import TerminalProgress
from csgmesh.cli.sources import DomainPath, LimitOptions, MaxCells, Parameters, load_domain_file
from csgmesh.errors import InputError

if TYPE_CHECKING:
    from csgmesh.mesh import Mesh


def mesh(
    file: DomainPath,
    out: Annotated[
        list[Path] | None,
        typer.Option(
            "-o",
            "--output",
            metavar="OUT",
            help="A mesh file or a picture, by its suffix; instead of the file's output.",
        ),
    ] = None,
    param: Parameters = None,
    max_cells: MaxCells = None,
    limit: LimitOptions = None,
) -> None:
    """Mesh a domain file and write the mesh.

    Without -o the files that it lists under `output` are written, beside it.
    """
    domain_file = load_domain_file(file, param, max_cells, limit)
    targets = out or list(domain_file.output)
    if not targets:
        raise InputError(f"{file} lists no output; say where to write by -o, such as -o out.msh")
    check_targets(targets)
    with TerminalProgress() as progress:
        result = domain_file.generate(progress)
    for target in targets:
        write_target(target, result)
        typer.echo(f"{target}: {result.n_points:,} points, {result.n_cells:,} cells")


def check_targets(targets: list[Path]) -> None:
    """Refuse files that could not be written, before the work.

    Raises
    ------
    InputError
        An unknown suffix, or a folder that does not exist.
    """
    from csgmesh.domainfile.outputs import check_suffix

    for target in targets:
        check_suffix(target)
        if not target.parent.is_dir():
            raise InputError(f"{target} cannot be written: there is no folder {target.parent}")


def write_target(target: Path, result: Mesh) -> None:
    """Write a mesh file or a picture."""
    from csgmesh.domainfile.outputs import is_picture
    from csgmesh.io import write
    from csgmesh.viz import draw

    if is_picture(target):
        draw(result, target)
    else:
        write(target, result)

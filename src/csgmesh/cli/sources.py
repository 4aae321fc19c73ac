"""Files that commands read, and the options that go with domain files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from csgmesh.errors import InputError

if TYPE_CHECKING:
    from csgmesh.domainfile import DomainFile
    from csgmesh.mesh import Mesh

DomainPath = Annotated[Path, typer.Argument(metavar="FILE.yaml", help="A domain file.")]
AnyPath = Annotated[Path, typer.Argument(metavar="FILE", help="A domain file or a mesh file.")]
Parameters = Annotated[
    list[str] | None,
    typer.Option("--param", "-p", metavar="NAME=VALUE", help="Replace a parameter of the file."),
]
MaxCells = Annotated[
    int | None, typer.Option(metavar="N", help="Most cells that the mesh may have.")
]
LimitOptions = Annotated[
    list[str] | None,
    typer.Option(
        "--limit",
        metavar="NAME=N",
        help="Set a limit: file_size, nesting, values, expression_length, leaves, cells.",
    ),
]


def is_domain_file(path: Path) -> bool:
    """Whether a path is a domain file by its suffix."""
    return path.suffix.lower() in (".yaml", ".yml")


def is_shape_file(path: Path) -> bool:
    """Whether a file holds a shape and never a mesh, by its suffix."""
    return path.suffix.lower() in (".csg", ".3mf")


def load_domain_file(
    path: Path,
    parameters: list[str] | None,
    max_cells: int | None,
    limits: list[str] | None,
) -> DomainFile:
    """The domain file, with the options of the command line.

    Raises
    ------
    InputError
        Anything wrong with the file or the options.
    """
    from csgmesh.domainfile import Limits, load

    raised: dict[str, Any] = dict(_pair(text, "--limit") for text in limits or ())
    for name, text in raised.items():
        if not text.isascii() or not text.isdigit():
            raise InputError(f"--limit {name} must be a whole number, not {text!r}")
        raised[name] = int(text)
    if max_cells is not None:
        raised["cells"] = max_cells
    given = dict(_pair(text, "--param") for text in parameters or ())
    return load(path, parameters=given, limits=Limits().raised(**raised))


def mesh_of(
    path: Path,
    parameters: list[str] | None,
    max_cells: int | None,
    limits: list[str] | None,
) -> Mesh:
    """The mesh in a mesh file, or that of a domain file."""
    from csgmesh.cli.progress import TerminalProgress

    if is_domain_file(path):
        file = load_domain_file(path, parameters, max_cells, limits)
        with TerminalProgress() as progress:
            return file.generate(progress)
    if parameters or limits or max_cells is not None:
        raise InputError(f"{path}: --param, --limit and --max-cells are for domain files (.yaml)")
    from csgmesh.io import read

    return read(path)


def _pair(text: str, option: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise InputError(f"{option} takes NAME=VALUE, not {text!r}")
    return name.strip(), value.strip()

"""Errors of a command: a message on stderr and an exit code, never a traceback."""

from __future__ import annotations

import functools
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec, TypeVar

import typer

from csgmesh.errors import CsgmeshError, DomainFileError, FileFormatError

P = ParamSpec("P")
T = TypeVar("T")

#: The shell's code of a program that was stopped by Ctrl-C.
INTERRUPTED = 130

_LONGEST_LINE = 200


def reported(command: Callable[P, T]) -> Callable[P, T]:
    """The command with its errors turned into messages and exit codes."""

    @functools.wraps(command)
    def guarded(*args: P.args, **kwargs: P.kwargs) -> T:
        try:
            result = command(*args, **kwargs)
            sys.stdout.flush()
        except CsgmeshError as error:
            report(error)
            raise typer.Exit(error.exit_code) from None
        except BrokenPipeError:
            # Whoever reads our output has read enough, as in ``csgmesh schema | head``. Python
            # flushes stdout once more at exit, which must find somebody to write to.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(0) from None
        except OSError as error:
            named = f"{error.filename}: " if error.filename else ""
            message = f"csgmesh: {named}{error.strerror or error}"
            typer.echo(message, err=True)
            raise typer.Exit(FileFormatError.exit_code) from None
        except KeyboardInterrupt:
            typer.echo("csgmesh: interrupted", err=True)
            raise typer.Exit(INTERRUPTED) from None
        return result

    return guarded


def report(error: CsgmeshError, file: Path | None = None) -> None:
    """Print an error on stderr; one with a place in a file with the line and a caret below it."""
    if isinstance(error, DomainFileError):
        first, *others = str(error).split("\n")
        typer.echo("\n".join([first, *_excerpt(error), *others]), err=True)
    else:
        # Some messages begin with their file:line:column already.
        is_placed = re.match(r".+?:\d+:\d+: ", str(error))
        typer.echo(str(error) if is_placed else f"{file or 'csgmesh'}: {error}", err=True)
    limit = re.search(r"\(limit (\w+)\)", str(error))
    if limit is not None:
        typer.echo(f"    raise it by --limit {limit.group(1)}=N", err=True)


def _excerpt(error: DomainFileError) -> list[str]:
    """The line of the file that an error is about, and a caret below the column."""
    if not error.line:
        return []
    try:
        with open(error.file, encoding="utf-8-sig", errors="replace") as lines:
            line = next((text for k, text in enumerate(lines, 1) if k == error.line), "")
    except OSError:
        return []
    line = line.rstrip("\n")
    if not line.isprintable() or len(line) > _LONGEST_LINE:
        return []
    margin = f"{error.line:>5} | "
    return [margin + line, " " * (len(margin) + error.column - 1) + "^"]

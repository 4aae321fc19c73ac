"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from csgmesh.errors import FileFormatError


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """A temporary path beside `path` (same suffix) that replaces it when the block ends well.

    A reader never sees half a file, and a failure leaves an older file as it was.

    Raises
    ------
    FileFormatError
        If the directory does not exist or cannot be written to.
    """
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise FileFormatError(f"{path} cannot be written: there is no directory {target.parent}")
    if target.is_dir():
        raise FileFormatError(f"{path} cannot be written: it is a directory")
    tag = f"{os.getpid()}-{threading.get_ident()}"
    temporary = target.with_name(f".{target.stem[:100]}.{tag}{target.suffix}")
    try:
        # Created here, and not by tempfile, so that the file gets the permissions of the umask.
        os.close(os.open(temporary, os.O_CREAT | os.O_WRONLY | os.O_TRUNC, 0o666))
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        raise FileFormatError(f"{path} cannot be written: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)

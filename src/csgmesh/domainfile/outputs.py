"""What kind of file an output is, by its suffix."""

from __future__ import annotations

from pathlib import Path

from csgmesh.errors import FileFormatError
from csgmesh.io import FORMATS, SOLID_FORMATS
from csgmesh.options import near

PICTURES = (".png", ".svg", ".pdf")


def is_picture(path: Path) -> bool:
    """Whether a file is drawn rather than written.

    Examples
    --------
    >>> is_picture(Path("plate.svg")), is_picture(Path("plate.msh"))
    (True, False)
    """
    return path.suffix.lower() in PICTURES


def check_suffix(path: Path) -> None:
    """Refuse a file that is neither a mesh nor a picture.

    Raises
    ------
    FileFormatError
        An unknown suffix.

    Examples
    --------
    >>> check_suffix(Path("plate.msh"))
    """
    known = [*FORMATS, *SOLID_FORMATS, *PICTURES]
    if path.suffix.lower() not in known:
        hint = near(path.suffix.lower(), known)
        raise FileFormatError(f"{path}: unknown suffix {path.suffix!r}; {hint}")

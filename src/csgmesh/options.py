"""Keyword options that arrive as a mapping: an unknown one is an error, never ignored."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from csgmesh.errors import InputError


def near(value: str, known: Iterable[str]) -> str:
    """A sentence that suggests what was meant, or lists what there is.

    Examples
    --------
    >>> near("comprss", ["compress", "encoding"])
    "did you mean 'compress'?"
    >>> near("x", ["compress", "encoding"])
    "there are 'compress', 'encoding'"
    """
    names = list(known)
    # difflib takes time in proportion to the product of all lengths.
    close = difflib.get_close_matches(value[:50], names[:1000], n=3, cutoff=0.5)
    if close:
        return f"did you mean {' or '.join(map(repr, close))}?"
    listed = ", ".join(map(repr, names[:20])) + (", …" if len(names) > 20 else "")
    return f"there are {listed}" if names else "there are none"


def check_options(given: Iterable[str], known: Iterable[str], where: str) -> None:
    """Refuse options that `where` does not know.

    Raises
    ------
    InputError
        Naming the option, with suggestions.

    Examples
    --------
    >>> check_options({"binary": True}, ["binary"], "an .msh file")
    """
    names = list(known)
    for option in given:
        if option not in names:
            raise InputError(f"{where} has no option {option!r}; {near(option, names)}")


def check_choice(option: str, value: object, choices: Iterable[object], where: str) -> None:
    """Refuse a value that is not one of `choices`.

    Examples
    --------
    >>> check_choice("encoding", "raw", ["raw", "base64"], "a .vtu file")
    """
    allowed = list(choices)
    if value not in allowed:
        listed = ", ".join(map(repr, allowed))
        raise InputError(f"{where}: {option} must be one of {listed}; got {value!r}")

"""Looking names up: an exact name, a prefix or a glob."""

from __future__ import annotations

import difflib
import fnmatch
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from csgmesh.errors import NameLookupError

_GLOB = frozenset("*?[")

#: What a name must not hold: lookups read ``* ? [ ]`` as a glob, mesh files quote names with ``"``.
_FORBIDDEN = frozenset('*?[]"')


def name_flaw(value: Any) -> str | None:
    """The rule that a name breaks and the name; None for a usable name.

    A name has components between dots, none of them empty or blank-padded.

    Examples
    --------
    >>> name_flaw("plate.left")
    >>> name_flaw(5)
    'a name must be a string; got 5'
    """
    if not isinstance(value, str):
        return f"a name must be a string; got {value!r}"
    bad = sorted(_FORBIDDEN.intersection(value))
    if bad or not value.isprintable():
        found = " ".join(bad) if bad else "a control character"
        return (
            'a name must not contain * ? [ ] " or control characters, which lookups and mesh files '
            f"need; got {value!r} with {found}"
        )
    if any(not part or part != part.strip() for part in value.split(".")):
        return (
            "a name must not be empty, nor have empty or blank-padded components between its dots; "
            f"got {value!r}"
        )
    return None


def find_names(pattern: str, names: Iterable[str], *, what: str = "name") -> tuple[str, ...]:
    """The names that a pattern means, in the order given.

    A pattern is an exact name, a prefix (``plate`` means ``plate`` and all of ``plate.*``), or a
    glob. A number that tells automatic names apart starts a new name, not a part: ``disk`` does not
    mean ``disk.2``, but ``disk*`` does.

    Raises
    ------
    NameLookupError
        If nothing matches; the message suggests near names.

    Examples
    --------
    >>> find_names("plate", ["plate.left", "plate.top", "hole"])
    ('plate.left', 'plate.top')
    >>> find_names("*.top", ["plate.left", "plate.top", "hole"])
    ('plate.top',)
    """
    unique = list(dict.fromkeys(names))
    if _GLOB & set(pattern):
        found = tuple(n for n in unique if fnmatch.fnmatchcase(n, pattern))
    else:
        found = tuple(n for n in unique if n == pattern or _is_part(n, pattern))
    if not found:
        raise NameLookupError(_nothing(pattern, unique, what))
    return found


def find_markers(pattern: str, boundary_names: Sequence[tuple[str, ...]]) -> np.ndarray:
    """Marker numbers any of whose names match a pattern, as (k,) int64 in increasing order.

    Examples
    --------
    >>> find_markers("hole", [("plate.left",), ("plate.top", "hole"), ("hole",)])
    array([1, 2])
    """
    wanted = set(
        find_names(pattern, (n for names in boundary_names for n in names), what="boundary")
    )
    hits = [k for k, names in enumerate(boundary_names) if wanted.intersection(names)]
    return np.array(hits, np.int64)


def _is_part(name: str, prefix: str) -> bool:
    if not name.startswith(prefix + "."):
        return False
    return not name[len(prefix) + 1 :].split(".", 1)[0].isdigit()


def _nothing(pattern: str, names: list[str], what: str) -> str:
    if not names:
        return f"no {what} matches {pattern!r}: there are none"
    near = difflib.get_close_matches(pattern, names, n=3, cutoff=0.5)
    if near:
        return f"no {what} matches {pattern!r}; did you mean {', '.join(map(repr, near))}?"
    shown = ", ".join(map(repr, names[:8])) + (", …" if len(names) > 8 else "")
    return f"no {what} matches {pattern!r}; there are {shown}"

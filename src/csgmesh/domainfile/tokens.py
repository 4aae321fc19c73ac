"""Text of an arithmetic expression → tokens."""

from __future__ import annotations

import re
from dataclasses import dataclass

from csgmesh.errors import ExpressionError

_TOKEN = re.compile(
    r"""(?P<space>[ \t\r\n]+|\$(?=\())
    | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)
    | (?P<name>\$?[A-Za-z_][A-Za-z0-9_]*)
    | (?P<operator>\*\*|//|[-+*/%(),])""",
    re.VERBOSE,
)


@dataclass(frozen=True)
class Token:
    """One piece of an expression.

    Attributes
    ----------
    kind : str
        ``"number"``, ``"name"``, ``"operator"`` or ``"end"``.
    text : str
        As written; a name loses its ``$``.
    offset : int
        Characters from the start of the expression.
    """

    kind: str
    text: str
    offset: int


def tokenize(text: str) -> list[Token]:
    """Split an expression; the last token is of kind ``"end"``.

    Raises
    ------
    ExpressionError
        A character that belongs to no token.

    Examples
    --------
    >>> [token.text for token in tokenize("$(2*$r)")]
    ['(', '2', '*', 'r', ')', '']
    """
    tokens = []
    offset = 0
    while offset < len(text):
        match = _TOKEN.match(text, offset)
        if match is None:
            raise ExpressionError(_unexpected(text, offset), offset=offset)
        kind = str(match.lastgroup)
        if kind != "space":
            tokens.append(Token(kind, match.group().removeprefix("$"), offset))
        offset = match.end()
    tokens.append(Token("end", "", len(text)))
    return tokens


def _unexpected(text: str, offset: int) -> str:
    character = text[offset]
    message = f"unexpected {character!r} in {text!r}"
    if character == "^":
        return f"{message}; a power is written **"
    return message

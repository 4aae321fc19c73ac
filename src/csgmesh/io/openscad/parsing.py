"""The text of a ``.csg`` file → calls with arguments and children.

The language is small: ``name(key = value, …)`` followed by ``;`` or by children in braces. A value
is a number, true, false, undef, a text or a list of values.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from csgmesh.errors import FileFormatError

_TOKEN = re.compile(
    r"""(?P<space>\s+|//[^\n]*|/\*.*?\*/)
      | (?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)
      | (?P<word>\$?[A-Za-z_]\w*)
      | (?P<text>"(?:[^"\\]|\\.)*")
      | (?P<sign>[-+(){}\[\],;=%#*!<>])
    """,
    re.VERBOSE | re.DOTALL,
)
_WORDS: dict[str, Any] = {"true": True, "false": False, "undef": None}
#: Lists in lists, and calls in calls: each level of the latter is one of a shape's tree.
_DEEPEST_LIST, _DEEPEST = 8, 5_000


@dataclass
class Call:
    """A node of the tree: ``name(arguments) { children }``."""

    name: str
    line: int
    arguments: dict[str, Any] = field(default_factory=dict)
    children: list[Call] = field(default_factory=list)
    modifiers: str = ""


Token = tuple[str, str, int]


def parse(text: str, where: str) -> list[Call]:
    """The calls of a file, in order.

    Raises
    ------
    FileFormatError
        With the line, where the text is not of this language.
    """
    return _Parser(text, where).calls()


def _tokens(text: str, where: str) -> Iterator[Token]:
    at, line = 0, 1
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise FileFormatError(f"{where}:{line}: unexpected {text[at : at + 20]!r}")
        kind = str(match.lastgroup)
        if kind != "space":
            yield kind, match.group(), line
        line += match.group().count("\n")
        at = match.end()
    yield "end", "the end of the file", line


class _Parser:
    def __init__(self, text: str, where: str) -> None:
        self.where = where
        self.tokens = _tokens(text, where)
        self.token = next(self.tokens)

    def calls(self) -> list[Call]:
        roots: list[Call] = []
        open_calls: list[Call] = []
        while True:
            kind, text, _ = self.token
            if kind == "end":
                if open_calls:
                    last = open_calls[-1]
                    raise self._error(f"{last.name} of line {last.line} is not closed")
                return roots
            if text == "}":
                if not open_calls:
                    raise self._error("a closing brace without an opening one")
                open_calls.pop()
                self._next()
            elif text == ";":
                self._next()
            else:
                call = self._call()
                (open_calls[-1].children if open_calls else roots).append(call)
                if self.token[1] == "{":
                    self._next()
                    open_calls.append(call)
                    if len(open_calls) > _DEEPEST:
                        raise self._error(f"calls may nest at most {_DEEPEST:,} deep")
                else:
                    self._take(";")

    def _call(self) -> Call:
        modifiers = ""
        while self.token[1] in ("%", "#", "*", "!"):
            modifiers += self._next()[1]
        kind, name, line = self.token
        if kind != "word":
            raise self._error(f"expected a name, found {name!r}")
        self._next()
        call = Call(name, line, modifiers=modifiers)
        self._take("(")
        while self.token[1] != ")":
            self._argument(call)
            if self.token[1] != ")":
                self._take(",")
        self._next()
        return call

    def _argument(self, call: Call) -> None:
        if self.token[0] == "word" and self.token[1] not in _WORDS:
            key = self._next()[1]
            self._take("=")
            call.arguments[key] = self._value(0)
            return
        call.arguments[f"#{len(call.arguments)}"] = self._value(0)

    def _value(self, depth: int) -> Any:
        kind, text, _ = self._next()
        if text == "[":
            if depth >= _DEEPEST_LIST:
                raise self._error(f"lists may nest at most {_DEEPEST_LIST} deep")
            items = []
            while self.token[1] != "]":
                items.append(self._value(depth + 1))
                if self.token[1] != "]":
                    self._take(",")
            self._next()
            return items
        if kind == "number":
            number = float(text)
            if number - number != 0.0:
                raise self._error(f"numbers must be finite; found {text}")
            return number
        if kind == "text":
            return text[1:-1]
        if kind == "word" and text in _WORDS:
            return _WORDS[text]
        if text in ("inf", "nan"):
            raise self._error(f"numbers must be finite; found {text}")
        raise self._error(f"expected a value, found {text!r}")

    def _next(self) -> Token:
        token = self.token
        self.token = next(self.tokens, ("end", "the end of the file", token[2]))
        return token

    def _take(self, sign: str) -> None:
        if self.token[1] != sign or self.token[0] == "text":
            raise self._error(f"expected {sign!r}, found {self.token[1]!r}")
        self._next()

    def _error(self, message: str) -> FileFormatError:
        return FileFormatError(f"{self.where}:{self.token[2]}: {message}")

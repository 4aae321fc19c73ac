"""YAML text → plain values, with the line and column of every key and value.

The text is untrusted: it is read event by event, so that nesting, the number of values and what
aliases expand to are bounded before anything is built. Tags are refused; scalars follow the core
schema of YAML 1.2 (``no`` and ``on`` are words, ``1e-3`` is a number).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from csgmesh.domainfile.limits import Limits
from csgmesh.errors import DomainFileError

if TYPE_CHECKING:
    from ruamel.yaml.events import Event

#: Keys and list positions from the document's root to a value.
KeyPath = tuple[str | int, ...]

_WORDS = {
    "": None, "~": None, "null": None, "Null": None, "NULL": None,
    "true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False,
}  # fmt: skip
_INTEGER = re.compile(r"[-+]?[0-9]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_LONGEST_NUMBER = 400  # no finite float needs more digits, and Python's int() is quadratic in them


@dataclass
class _Node:
    """A value, where it stands, and how many values it expands to."""

    line: int
    column: int
    value: Any = None  # scalar, list of _Node, or dict of str to (key's _Node, value's _Node)
    weight: int = 1
    # Column of the first character of a scalar written on one line, quotes excluded.
    text_column: int | None = None


@dataclass(frozen=True)
class Document:
    """A parsed YAML document.

    Attributes
    ----------
    file : str
        Name of the file for messages.
    data : Any
        Plain dictionaries, lists and scalars.
    """

    file: str
    data: Any
    _root: _Node = field(repr=False)

    def error(
        self, message: str, path: KeyPath = (), *, key: bool = False, offset: int = 0
    ) -> DomainFileError:
        """An error at the value (or the `key`) at `path`, `offset` characters into its text."""
        line, column = self.place(path, key=key, offset=offset)
        return DomainFileError(message, file=self.file, line=line, column=column)

    def has(self, path: KeyPath) -> bool:
        """Whether there is a value at `path`."""
        return sum(1 for _ in self._along(path)) == len(path)

    def place(self, path: KeyPath, *, key: bool = False, offset: int = 0) -> tuple[int, int]:
        """Line and column, from 1, of the deepest part of `path` that the document has."""
        place = self._root
        for key_node, node in self._along(path):
            place = key_node if key and key_node is not None else node
        if place.text_column is not None and offset:
            return place.line, place.text_column + offset
        return place.line, place.column

    def _along(self, path: KeyPath) -> Iterator[tuple[_Node | None, _Node]]:
        """Key and value of each step of `path` that the document has."""
        node = self._root
        for step in path:
            if isinstance(node.value, dict) and step in node.value:
                key, node = node.value[step]
                yield key, node
            elif isinstance(node.value, list) and isinstance(step, int) and step < len(node.value):
                node = node.value[step]
                yield None, node
            elif isinstance(node.value, list) and isinstance(step, str):
                # A list that stands for the sole argument, whose name the path has.
                yield None, node
            else:
                return


def read_document(path: Path, limits: Limits) -> Document:
    """Read and parse a file of at most ``limits.file_size`` bytes.

    Raises
    ------
    DomainFileError
        The file cannot be read, is too long, is no UTF-8 or no valid YAML, or exceeds another
        limit.
    """
    try:
        with path.open("rb") as stream:
            content = stream.read(limits.file_size + 1)
    except OSError as error:
        reason = error.strerror or str(error)
        raise DomainFileError(f"cannot be read: {reason}", file=str(path)) from None
    if len(content) > limits.file_size:
        raise DomainFileError(
            f"a domain file may have at most {limits.file_size} bytes (limit file_size)",
            file=str(path), line=1, column=1,
        )  # fmt: skip
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        column = error.start - content.rfind(b"\n", 0, error.start)
        raise DomainFileError(
            "a domain file must be UTF-8 text", file=str(path), line=line, column=column
        ) from None
    return parse_document(text, str(path), limits)


def parse_document(text: str, file: str, limits: Limits) -> Document:
    """Parse one YAML document.

    Raises
    ------
    DomainFileError
        No valid YAML, a repeated key, a tag, several documents, or a limit exceeded.

    Examples
    --------
    >>> document = parse_document("size: {hole: 0.1}", "plate.yaml", Limits())
    >>> document.data, document.place(("size", "hole"))
    ({'size': {'hole': 0.1}}, (1, 14))
    """
    root = _Composer(file, limits).compose(text)
    return Document(file, _plain(root), root)


def _plain(node: _Node) -> Any:
    """The bare value; recursion is bounded by the limit on nesting."""
    if isinstance(node.value, dict):
        return {key: _plain(value) for key, (_, value) in node.value.items()}
    if isinstance(node.value, list):
        return [_plain(value) for value in node.value]
    return node.value


class _Composer:
    """Builds nodes from the parser's events."""

    def __init__(self, file: str, limits: Limits) -> None:
        self.file = file
        self.limits = limits
        self.open: list[_Node] = []
        self.keys: list[_Node | None] = []  # for each open mapping, the key that awaits its value
        self.anchors: dict[str, _Node] = {}
        self.levels: dict[int, int] = {}  # levels of containers in an anchored node, by its id
        self.root: _Node | None = None
        self.total = 0

    def compose(self, text: str) -> _Node:
        documents = 0
        for event in self._events(text):
            kind = type(event).__name__
            if kind == "DocumentStartEvent":
                documents += 1
                if documents > 1:
                    self._fail(event, "a domain file holds one YAML document, not several")
            elif kind == "AliasEvent":
                self._add(self._alias(event), event)
            elif kind == "ScalarEvent":
                self._add(self._scalar(event), event)
            elif kind in ("MappingStartEvent", "SequenceStartEvent"):
                self._start(event, {} if kind == "MappingStartEvent" else [])
            elif kind in ("MappingEndEvent", "SequenceEndEvent"):
                self._end()
        return self.root if self.root is not None else _Node(1, 1)

    def _events(self, text: str) -> Iterator[Event]:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import MarkedYAMLError
        from ruamel.yaml.reader import ReaderError

        try:
            yield from YAML(typ="safe", pure=True).parse(text)
        except MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            context = f" {error.context}" if error.context else ""
            raise DomainFileError(
                f"no valid YAML: {error.problem}{context}",
                file=self.file, line=mark.line + 1, column=mark.column + 1,
            ) from None  # fmt: skip
        except ReaderError as error:
            before = text[: error.position]
            raise DomainFileError(
                f"no valid YAML: character U+{error.character:04X} is not allowed",
                file=self.file, line=before.count("\n") + 1,
                column=error.position - before.rfind("\n"),
            ) from None  # fmt: skip

    def _fail(self, event: Event, message: str) -> NoReturn:
        mark = event.start_mark
        raise DomainFileError(message, file=self.file, line=mark.line + 1, column=mark.column + 1)

    def _start(self, event: Any, value: Any) -> None:
        if event.tag not in (None, "!"):
            self._fail(event, f"tags are not allowed, found {event.tag!r}")
        if len(self.open) >= self.limits.nesting:
            self._fail(
                event,
                f"values may nest at most {self.limits.nesting} levels (limit nesting)",
            )
        node = _Node(event.start_mark.line + 1, event.start_mark.column + 1, value)
        self._add(node, event)
        self.open.append(node)
        self.keys.append(None)

    def _end(self) -> None:
        node = self.open.pop()
        self.keys.pop()
        children = node.value
        if isinstance(children, dict):
            children = [value for _, value in children.values()]
        node.weight = 1 + sum(child.weight for child in children)
        self.levels[id(node)] = 1 + max((self.levels.get(id(c), 0) for c in children), default=0)

    def _add(self, node: _Node, event: Any) -> None:
        self.total += node.weight
        if self.total > self.limits.values:
            self._fail(
                event,
                f"a document may hold at most {self.limits.values} values, "
                "aliases expanded (limit values)",
            )
        if type(event).__name__ != "AliasEvent" and event.anchor is not None:
            self.anchors[event.anchor] = node
        if not self.open:
            self.root = node
        elif isinstance(self.open[-1].value, list):
            self.open[-1].value.append(node)
        elif self.keys[-1] is None:
            self.keys[-1] = self._key(node, event)
        else:
            key, self.keys[-1] = self.keys[-1], None
            if node.value is None and getattr(event, "value", None) == "":
                # The parser notices a value left out only where the next text stands.
                node.line, node.column = key.line, key.column
            self.open[-1].value[key.value] = (key, node)

    def _key(self, node: _Node, event: Any) -> _Node:
        if isinstance(node.value, dict | list):
            self._fail(event, "a key must be a word, not a mapping or list")
        text = event.value if type(event).__name__ == "ScalarEvent" else str(node.value)
        if text == "<<":
            self._fail(event, "merge keys (<<) are not allowed; an alias stands for a whole value")
        seen = self.open[-1].value.get(text)
        if seen is not None:
            self._fail(event, f"key {text!r} stands twice; first in line {seen[0].line}")
        return _Node(node.line, node.column, text, text_column=node.text_column)

    def _alias(self, event: Any) -> _Node:
        node = self.anchors.get(event.anchor)
        if node is None:
            self._fail(event, f"alias *{event.anchor} has no anchor before it")
        if any(node is parent for parent in self.open):
            self._fail(event, f"alias *{event.anchor} stands inside its own value")
        if len(self.open) + self.levels.get(id(node), 0) > self.limits.nesting:
            self._fail(
                event, f"values may nest at most {self.limits.nesting} levels (limit nesting)"
            )
        return node

    def _scalar(self, event: Any) -> _Node:
        if event.tag not in (None, "!", "tag:yaml.org,2002:str"):
            self._fail(event, f"tags are not allowed, found {event.tag!r}")
        start, end = event.start_mark, event.end_mark
        node = _Node(start.line + 1, start.column + 1, event.value)
        quotes = 0 if event.style is None else 1
        if start.line == end.line and end.column - start.column == len(event.value) + 2 * quotes:
            node.text_column = start.column + 1 + quotes
        if event.style is None and event.tag is None:
            node.value = self._resolve(event)
        return node

    def _resolve(self, event: Any) -> Any:
        text = event.value
        if text in _WORDS:
            return _WORDS[text]
        if _NOT_FINITE.fullmatch(text):
            self._fail(event, f"a number must be finite, not {text}")
        if not _FLOAT.fullmatch(text):
            return text
        if len(text) > _LONGEST_NUMBER:
            self._fail(event, f"a number may have at most {_LONGEST_NUMBER} digits")
        if _INTEGER.fullmatch(text):
            return int(text)
        value = float(text)
        if not math.isfinite(value):
            self._fail(event, f"a number must be finite, not {text}")
        return value

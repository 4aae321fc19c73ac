"""Meshers of domain files: made from their options, with places for what is wrong with them."""

from __future__ import annotations

import re
from typing import Any

from csgmesh.domainfile.document import Document, KeyPath
from csgmesh.domainfile.parts import Part
from csgmesh.domainfile.schema import MeshPart
from csgmesh.domainfile.shapes import placed
from csgmesh.domainfile.vocabulary import Arguments, mesher_classes


def mesher_of(document: Document, mesh: MeshPart) -> Any:
    """The mesher that a file asks for, None for the default one."""
    key = mesh.mesher
    if key is None:
        return None
    return _made(document, ("mesh", key), getattr(mesh, key))


def _made(document: Document, path: KeyPath, value: Any) -> Any:
    """What arguments in a file make: a mesher, layers; values of other types stay."""
    if isinstance(value, Arguments):
        options = {k: _made(document, (*path, k), v) for k, v in value.given().items()}
        make = value.builds
        assert make is not None
        return placed(document, path, lambda: make(**options))
    if isinstance(value, Part):
        key = value.keys_written[0]
        return _made(document, (*path, key), getattr(value, key))
    if isinstance(value, dict):
        within = path if document.has(path) else path[:-1]
        return {k: _made(document, (*within, k), v) for k, v in value.items()}
    return value


def as_written(document: Document, path: KeyPath) -> KeyPath:
    """A path without the key that a shorter way of writing leaves out."""
    for k, step in enumerate(path):
        if step == "meshers" and not document.has(path[: k + 1]):
            return path[:k] + path[k + 1 :]
    return path


def option_named_in(document: Document, message: str) -> KeyPath | None:
    """Place of the mesher's option, or of the name within it, that a message is about."""
    given = document.data.get("mesh") or {}
    key = next((str(key) for key in given if key in mesher_classes()), "")
    options = given[key] if isinstance(given.get(key), dict) else {}
    first = sorted(options.items(), key=lambda item: not message.startswith(item[0]))
    for option, value in first:
        if repr(option) in message:
            return ("mesh", key, option)
        names = value if isinstance(value, dict) else {}
        for name in names:
            if repr(name) in message and not message.startswith("size"):
                return ("mesh", key, option, name)
        if re.match(rf"{option}\b", message):
            return ("mesh", key, option)
    return None

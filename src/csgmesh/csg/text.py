"""Shapes as text: expressions, summaries, and the flat form behind dictionaries and pickles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from csgmesh.csg import matrices
from csgmesh.csg.nodes import (
    SYMBOLS,
    Affine,
    Boolean,
    Complement,
    Named,
    Primitive,
    Shape,
    combined,
)
from csgmesh.csg.traversal import postorder
from csgmesh.errors import ShapeError

#: Levels up to which `repr` is an expression that evaluates back; Python's own parser gives up on
#: some two hundred nested parentheses.
DEEPEST_EXPRESSION = 100

#: Leaves, and points of a leaf, beyond which `repr` only says how many there are.
WIDEST_EXPRESSION = 1000

#: Operands beyond which a boolean is written as a function: Python parses ``a | b`` recursively.
_WIDEST_CHAIN = 8


def expression(root: Shape) -> str:
    """``repr``: an expression that evaluates back, or in angle brackets what it would be."""
    if root.depth > DEEPEST_EXPRESSION or root.n_leaves > WIDEST_EXPRESSION:
        return f"<{summary(root)}, {root.n_leaves:,} leaves, {root.depth:,} levels>"
    texts: dict[int, str] = {}
    for node in postorder(root):
        texts[id(node)] = _expression(node, [texts[id(child)] for child in node.children])
    return texts[id(root)]


def _expression(node: Shape, parts: Sequence[str]) -> str:
    if isinstance(node, Primitive):
        return _call(node)
    if isinstance(node, Boolean):
        if len(parts) > _WIDEST_CHAIN:
            return f"{node.operation}({', '.join(parts)})"
        written = [
            f"({text})" if _is_chain(child) else text
            for child, text in zip(node.children, parts, strict=True)
        ]
        return f" {SYMBOLS[node.operation]} ".join(written)
    (part,) = parts
    child = node.children[0]
    if isinstance(node, Complement):
        return f"~({part})" if _is_chain(child) else f"~{part}"
    held = f"({part})" if _is_chain(child) or isinstance(child, Complement) else part
    if isinstance(node, Named):
        return f"{held}.named({node.name!r})"
    assert isinstance(node, Affine)
    if node.matrix == matrices.identity(node.dim):
        return f"{held}.translate({literal(node.offset)})"
    factors = tuple(row[i] for i, row in enumerate(node.matrix))
    if node.matrix == matrices.diagonal(factors) and not any(node.offset):
        return f"{held}.scale({literal(factors)})"
    return f"{held}.transform({literal(node.matrix)}, {literal(node.offset)})"


def _is_chain(node: Shape) -> bool:
    """Whether a node is written with operators, and needs parentheses inside another."""
    return isinstance(node, Boolean) and len(node.run) <= _WIDEST_CHAIN


def _call(leaf: Primitive) -> str:
    arguments = leaf.arguments()
    required = list(arguments)[: len(arguments) - ("name" in arguments)]
    written = [literal(arguments[key]) for key in required]
    # Optional arguments follow the required ones in order, so they may stand by position too.
    if "name" in arguments:
        written.append(f"name={arguments['name']!r}")
    return f"{type(leaf).__name__}({', '.join(written)})"


def literal(value: Any) -> str:
    """A number, string, tuple or array as Python writes it; whole floats without their point."""
    if isinstance(value, np.ndarray):
        if len(value) > WIDEST_EXPRESSION:
            return f"<{len(value):,} points>"
        rows = (tuple(row) if isinstance(row, list) else row for row in value.tolist())
        return f"[{', '.join(map(literal, rows))}]"
    if isinstance(value, tuple):
        inner = ", ".join(map(literal, value))
        return f"({inner},)" if len(value) == 1 else f"({inner})"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return repr(value)


def summary(node: Shape) -> str:
    """``str``: a few words."""
    suffix = ""
    while isinstance(node, Affine | Named | Complement):
        suffix = f" {node.name!r}" if isinstance(node, Named) else suffix
        if isinstance(node, Complement):
            return f"complement of {summary(node.shape)}"
        node = node.shape
    if isinstance(node, Primitive):
        return node.kind.replace("_", " ") + (f" {node.name!r}" if node.name else "")
    assert isinstance(node, Boolean)
    return f"{node.operation.replace('_', ' ')}{suffix} of {len(node.run):,}"


def flattened(root: Shape) -> list[tuple[tuple[Any, ...] | None, Any]]:
    """The nodes, children first, as (numbers of children or None for a leaf, what they hold)."""
    numbers: dict[int, int] = {}
    out: list[tuple[tuple[Any, ...] | None, Any]] = []
    for node in postorder(root):
        numbers[id(node)] = len(out)
        if isinstance(node, Primitive):
            out.append((None, (node.kind, node.arguments())))
        else:
            out.append((tuple([numbers[id(child)] for child in node.children]), node.content))
    return out


def from_flat(entries: Sequence[tuple[tuple[int, ...] | None, Any]]) -> Shape:
    """The shape of `flattened` entries."""
    nodes: list[Shape] = []
    for children, content in entries:
        if children is None:
            kind, arguments = content
            nodes.append(_leaf(kind, arguments))
        else:
            nodes.append(_node(content[0], content[1:], [nodes[k] for k in children]))
    return nodes[-1]


def _leaf(kind: str, arguments: dict[str, Any]) -> Shape:
    if kind not in Primitive.kinds:
        raise ShapeError(f"from_dict: unknown kind of node {kind!r}")
    if not isinstance(arguments, dict):
        raise ShapeError(f"from_dict: {kind} needs a dictionary of arguments; got {arguments!r}")
    if isinstance(arguments.get("shape"), dict):
        arguments = arguments | {"shape": from_dict(arguments["shape"])}
    if isinstance(arguments.get("shapes"), list):
        members = [from_dict(s) if isinstance(s, dict) else s for s in arguments["shapes"]]
        arguments = arguments | {"shapes": members}
    try:
        return Primitive.kinds[kind](**arguments)
    except TypeError as problem:
        raise ShapeError(f"from_dict: {kind} has wrong arguments: {problem}") from None


def _node(kind: str, rest: Sequence[Any], children: list[Shape]) -> Shape:
    if kind in SYMBOLS:
        return combined(kind, children)
    (shape,) = children
    if kind == "complement":
        return ~shape
    if kind == "named":
        return shape.named(rest[0])
    return shape.transform(*rest)


def to_dict(root: Shape) -> dict[str, Any]:
    """The flat form in lists, numbers and strings."""
    nodes: list[dict[str, Any]] = []
    for children, content in flattened(root):
        if children is None:
            kind, arguments = content
            nodes.append({kind: {key: _plain(value) for key, value in arguments.items()}})
        elif content[0] in SYMBOLS:
            nodes.append({content[0]: list(children)})
        elif content[0] == "complement":
            nodes.append({"complement": children[0]})
        elif content[0] == "named":
            nodes.append({"named": {"shape": children[0], "name": content[1]}})
        else:
            matrix, offset = map(_plain, content[1:])
            nodes.append({"transform": {"shape": children[0], "matrix": matrix, "offset": offset}})
    return {"nodes": nodes}


def from_dict(data: dict[str, Any]) -> Shape:
    """The shape that `to_dict` wrote."""
    nodes = data.get("nodes") if isinstance(data, dict) else None
    if not isinstance(nodes, list) or not nodes:
        raise ShapeError("from_dict: a dictionary with a non-empty list of nodes is needed")
    built: list[Shape] = []
    for number, entry in enumerate(nodes):
        if not isinstance(entry, dict) or len(entry) != 1:
            raise ShapeError(f"from_dict: node {number} must have one key; got {entry!r}")
        ((kind, value),) = entry.items()
        if kind in _OPERATIONS:
            children, rest = _read_operation(kind, value, number)
            built.append(_node(kind, rest, [built[child] for child in children]))
        else:
            built.append(_leaf(kind, value))
    return built[-1]


#: Keys of nodes that are not leaves, and what their values hold beside ``shape``.
_OPERATIONS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(SYMBOLS, ()),
    "complement": (),
    "named": ("name",),
    "transform": ("matrix", "offset"),
}


def _read_operation(kind: str, value: Any, number: int) -> tuple[list[int], list[Any]]:
    """Numbers of the children, and the other arguments."""
    keys = _OPERATIONS[kind]
    if keys:
        if not isinstance(value, dict) or set(value) != {"shape", *keys}:
            raise ShapeError(
                f"from_dict: node {number} ({kind}) must have the keys shape, {', '.join(keys)}; "
                f"got {value!r}"
            )
        children, rest = [value["shape"]], [value[key] for key in keys]
    else:
        children, rest = ([value] if kind == "complement" else value), []
    if not isinstance(children, list) or not all(
        type(child) is int and 0 <= child < number for child in children
    ):
        raise ShapeError(
            f"from_dict: node {number} ({kind}) must refer to earlier nodes; got {children!r}"
        )
    return children, rest


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Shape):
        return to_dict(value)
    return [_plain(v) for v in value] if isinstance(value, tuple) else value

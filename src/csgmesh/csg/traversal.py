"""Walking trees of any depth without recursion, and what every value needs: hash and equality."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from csgmesh.csg.nodes import Primitive, Shape


def postorder(root: Shape, known: Callable[[Shape], bool] | None = None) -> Iterator[Shape]:
    """Every node object once, children before parents; nodes already `known` are not entered.

    Examples
    --------
    >>> import csgmesh as cm
    >>> [node.content[0] for node in postorder(cm.Disk((0, 0), 1) | ~cm.Disk((0, 0), 2))]
    ['disk', 'disk', 'complement', 'union']
    """
    seen: set[int] = set()
    stack: list[tuple[Shape, bool]] = [(root, False)]
    while stack:
        node, entered = stack.pop()
        if entered:
            yield node
            continue
        if id(node) in seen or (known is not None and known(node)):
            continue
        seen.add(id(node))
        stack.append((node, True))
        stack.extend((child, False) for child in reversed(node.children))


def structural_hash(root: Shape) -> int:
    """Hash of the expression; every node on the way keeps its own."""
    result = 0
    for node in postorder(root, known=lambda n: "_hash" in n.__dict__):
        result = hash((node.content, tuple([child._hash for child in node.children])))
        node.__dict__["_hash"] = result
    return result


def structurally_equal(a: Shape, b: Shape) -> bool:
    """Whether two trees are the same expression, operand by operand."""
    if a is b:
        return True
    if a.n_nodes != b.n_nodes or a.depth != b.depth or hash(a) != hash(b):
        return False
    compared: set[tuple[int, int]] = set()
    stack = [(a, b)]
    while stack:
        x, y = stack.pop()
        if x is y or (id(x), id(y)) in compared:
            continue
        compared.add((id(x), id(y)))
        if x._hash != y._hash or x.content != y.content:
            return False
        if not isinstance(x, Primitive):
            mine, theirs = x.children, y.children
            if len(mine) != len(theirs):
                return False
            stack.extend(zip(mine, theirs, strict=True))
    return True

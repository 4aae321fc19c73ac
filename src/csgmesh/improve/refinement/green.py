"""Green closures, undone before a mesh is refined again.

The children of a green cell stand together, in the order of their template, with one number in
``mesh.cell_green``: so their parent's corners can be read off their rows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.mesh import Mesh

#: Kind and number of the children: the kind of the parent; for each of its corners, and for each
#: middle of its edges (-1: not halved), the child and its local corner where it is found.
_PARENTS = {
    ("triangle", 2): ("triangle", ((0, 1), (1, 0), (0, 0)), ((0, 2), None, None)),
    ("triangle", 3): ("quad", ((0, 0), (1, 1), (1, 2), (0, 2)), ((0, 1), None, None, None)),
    ("triangle", 4): ("quad", ((1, 0), (0, 1), (3, 1), (1, 2)), ((0, 0), (0, 2), None, None)),
    ("quad", 2): ("quad", ((0, 0), (1, 1), (1, 2), (0, 3)), ((0, 1), None, (0, 2), None)),
}
#: Corners of children that must be the same vertex: (child, corner) pairs.
_SAME = {
    ("triangle", 2): (((0, 2), (1, 2)), ((0, 0), (1, 1))),
    ("triangle", 3): (((0, 1), (1, 0)), ((0, 1), (2, 0)), ((1, 2), (2, 1)), ((0, 2), (2, 2))),
    ("triangle", 4): (((0, 0), (1, 1)), ((0, 0), (2, 0)), ((0, 2), (2, 1)), ((0, 2), (3, 0))),
    ("quad", 2): (((0, 1), (1, 0)), ((0, 2), (1, 3))),
}


@dataclass(frozen=True, eq=False)
class Block:
    """Cells of one kind, and what they came from.

    Attributes
    ----------
    rows : (m, w) int64
    region : (m,) int64
    source : (m,) int64
        Number of the mesh's cell that each is, or begins with.
    middle : (m, w) int64 or None
        Vertices in the middle of edges that are halved already; -1 for others. None: no such edge.
    """

    rows: np.ndarray
    region: np.ndarray
    source: np.ndarray
    middle: np.ndarray | None


def undo_green(mesh: Mesh) -> tuple[dict[str, Block], np.ndarray]:
    """The cells of a mesh, the parents of green ones in place of these.

    Returns
    -------
    blocks : dict of str to Block
        By kind: the cells that stay, then the parents.
    place : (n_cells,) int64
        Where each cell of the mesh, or its parent, is among the cells of all blocks.
    """
    parts: dict[str, list[Block]] = {kind: [] for kind in ("triangle", "quad")}
    parents: list[tuple[str, Block, np.ndarray]] = []
    before = 0
    for kind, rows in mesh.cells.items():
        number = before + np.arange(len(rows))
        region, green = mesh.cell_region[kind], mesh.cell_green.get(kind, np.zeros(0, np.int64))
        stays = np.ones(len(rows), bool)
        for size in (2, 3, 4) if kind == "triangle" else (2,):
            children = _families(green, size)
            children = children[_is_family(rows[children], kind, size)]
            stays[children] = False
            block = _parents(rows, region, number, children, kind, size)
            parents.append((_PARENTS[kind, size][0], block, number[children]))
        if not stays.all():
            rows, region, number = rows[stays], region[stays], number[stays]
        parts[kind].append(Block(rows, region, number, None))
        before += len(stays)
    for kind, block, _ in parents:
        if len(block.rows):
            parts[kind].append(block)
    blocks = {kind: _joined(found) for kind, found in parts.items() if found}
    place = np.empty(before, np.int64)
    source = np.concatenate([np.zeros(0, np.int64), *(block.source for block in blocks.values())])
    place[source] = np.arange(len(source))
    for _, block, children in parents:
        place[children] = place[block.source][:, None]
    return blocks, place


def _joined(parts: list[Block]) -> Block:
    if len(parts) == 1:
        return parts[0]
    middles = [np.full(p.rows.shape, -1) if p.middle is None else p.middle for p in parts]
    return Block(
        np.concatenate([part.rows for part in parts]),
        np.concatenate([part.region for part in parts]),
        np.concatenate([part.source for part in parts]),
        np.concatenate(middles),
    )


def _families(green: np.ndarray, size: int) -> np.ndarray:
    """Cells of the groups with `size` members, (g, size), in their order."""
    at = np.flatnonzero(green >= 0)
    order = at[np.argsort(green[at], kind="stable")]
    _, first, count = np.unique(green[order], return_index=True, return_counts=True)
    return order[first[count == size][:, None] + np.arange(size)]


def _is_family(rows: np.ndarray, kind: str, size: int) -> np.ndarray:
    """Which groups of rows (g, size, w) still fit together as their template left them."""
    fits = np.ones(len(rows), bool)
    for (i, j), (k, m) in _SAME[kind, size]:
        fits &= rows[:, i, j] == rows[:, k, m]
    return fits


def _parents(
    rows: np.ndarray,
    region: np.ndarray,
    number: np.ndarray,
    children: np.ndarray,
    kind: str,
    size: int,
) -> Block:
    _, corners, middles = _PARENTS[kind, size]
    family = rows[children]
    nothing = np.full(len(children), -1)
    return Block(
        np.stack([family[:, i, j] for i, j in corners], axis=1),
        region[children[:, 0]],
        number[children[:, 0]],
        np.stack([nothing if m is None else family[:, m[0], m[1]] for m in middles], axis=1),
    )

"""Divide blocks of cells by their templates and gather the children."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from csgmesh import kernels
from csgmesh.improve.refinement.green import Block
from csgmesh.improve.refinement.templates import RED_GREEN, Template


@dataclass(eq=False)
class Children:
    """New cells by kind, as they are gathered.

    Attributes
    ----------
    rows, source, region, green : dict of str to list of arrays
        Corners; cell of the coarser mesh; region; number of the green parent, -1 for none.
    n_groups : int
        Green parents so far.
    """

    rows: dict[str, list[np.ndarray]] = field(default_factory=dict)
    source: dict[str, list[np.ndarray]] = field(default_factory=dict)
    region: dict[str, list[np.ndarray]] = field(default_factory=dict)
    green: dict[str, list[np.ndarray]] = field(default_factory=dict)
    n_groups: int = 0

    def add(
        self,
        block: Block,
        edge: np.ndarray,
        middle: np.ndarray,
        centre: np.ndarray,
        code: np.ndarray,
        template: Template,
        is_green: np.ndarray | None,
    ) -> None:
        """Divide the cells of a block.

        Parameters
        ----------
        block : Block
        edge : (m, w) int64
            Edge of each side, into `middle`.
        middle : (e,) int64
            Vertex in the middle of each edge.
        centre : (m,) int64
            Vertex in the middle of each cell that has one; may be shorter where no template has.
        code : (m,) int64
        template : Template
        is_green : (m,) bool, optional
            Whose children are to be undone before the next refinement.
        """
        group = None
        if is_green is not None:
            group = np.where(is_green, self.n_groups + np.cumsum(is_green) - 1, -1)
            self.n_groups += int(is_green.sum())
        for kind, k in (("triangle", 3), ("quad", 4)):
            count = template.counts(kind)[code]
            begin = np.cumsum(count) - count
            n = int(count.sum())
            if not n:
                continue
            out = np.empty((n, k), np.int64)
            kernels.write_children(
                _flat(block.rows),
                _flat(edge),
                _flat(middle),
                _flat(centre),
                _flat(code),
                *(_flat(part) for part in template.rows(kind)),
                template.width,
                k,
                _flat(begin),
                out.reshape(-1),
            )
            self._put(kind, out, block.source, block.region, group, count)

    def _put(
        self,
        kind: str,
        rows: np.ndarray,
        source: np.ndarray,
        region: np.ndarray,
        group: np.ndarray | None,
        count: np.ndarray,
    ) -> None:
        self.rows.setdefault(kind, []).append(rows)
        self.source.setdefault(kind, []).append(np.repeat(source, count))
        self.region.setdefault(kind, []).append(np.repeat(region, count))
        # A single -1 stands for none: most blocks have no green cells.
        green = np.full(1, -1) if group is None else np.repeat(group, count)
        self.green.setdefault(kind, []).append(green)

    def greens(self) -> dict[str, np.ndarray]:
        """Green parents by kind; empty where there are none."""
        if not self.n_groups:
            return {}
        for kind, parts in self.green.items():
            sizes = [len(rows) for rows in self.rows[kind]]
            self.green[kind] = [np.broadcast_to(p, n) for p, n in zip(parts, sizes, strict=True)]
        return self.joined(self.green)

    def joined(self, what: dict[str, list[np.ndarray]]) -> dict[str, np.ndarray]:
        """One read-only array a kind."""
        out = {}
        for kind, parts in what.items():
            array = parts[0] if len(parts) == 1 else np.concatenate(parts)
            out[kind] = np.ascontiguousarray(array)
            out[kind].flags.writeable = False
        return out

    def close(self, kind: str, start: int, halved: np.ndarray, middles: np.ndarray) -> None:
        """Divide cells added last whose edges are halved on the other side already.

        Parameters
        ----------
        kind : str
        start : int
            First of the cells, in the last array of this kind.
        halved : (k, 2) int64
            Ends of the halved edges, the lower first.
        middles : (k,) int64
            Their middles.
        """
        rows = self.rows[kind][-1][start:]
        n = int(rows.max()) + 1
        keys = halved[:, 0] * n + halved[:, 1]
        order = np.argsort(keys)
        keys, middles = keys[order], middles[order]
        ends = np.stack([rows, np.roll(rows, -1, axis=1)], axis=2)
        wanted = ends.min(axis=2) * n + ends.max(axis=2)
        edge = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        hangs = keys[edge] == wanted
        code = hangs @ (1 << np.arange(rows.shape[1]))
        hit = np.flatnonzero(code)
        if not len(hit):
            return
        at = start + hit
        block = Block(rows[hit], self.region[kind][-1][at], self.source[kind][-1][at], None)
        self.green[kind][-1] = np.broadcast_to(self.green[kind][-1], len(self.rows[kind][-1]))
        for part in (self.rows, self.source, self.region, self.green):
            part[kind][-1] = np.delete(part[kind][-1], at, axis=0)
        centre = np.zeros(0, np.int64)
        whole = np.ones(len(hit), bool)
        self.add(block, edge[hit], middles, centre, code[hit], RED_GREEN[kind], whole)


def _flat(array: np.ndarray) -> np.ndarray:
    """A flat read-only view of integers: the kernels are compiled for one type only."""
    flat: np.ndarray = np.ascontiguousarray(array, np.int64).reshape(-1).view()
    flat.flags.writeable = False
    return flat

"""A few triangles of patches that may slide a vertex, contract or flip an edge."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

Row = tuple[int, ...]


class Patchwork:
    """Triangles of patches on different surfaces, found by their vertices.

    Edges between two triangles of one patch are inner ones; all others belong to curves, and so do
    their vertices. Nothing here looks at coordinates.

    Parameters
    ----------
    triangles : (m, 3) int64
    patch : (m,) int64
        Two triangles beside an edge are of one patch if their numbers are the same.
    is_whole : (n,) bool
        Vertices all of whose triangles are here; what has others stays as it is.

    Examples
    --------
    >>> fan = Patchwork(np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]]), np.zeros(3), np.ones(4, bool))
    >>> fan.is_inside(0), fan.is_inside(1), fan.neighbours(1)
    (True, False, [0, 2, 3])
    """

    def __init__(self, triangles: np.ndarray, patch: np.ndarray, is_whole: np.ndarray) -> None:
        self.rows: dict[int, Row] = dict(enumerate(map(tuple, triangles.tolist())))
        self.patch = patch.tolist()
        self.is_whole = is_whole.tolist()
        self._star: list[set[int]] = [set() for _ in self.is_whole]
        for t, row in self.rows.items():
            for v in row:
                self._star[v].add(t)

    def star(self, v: int) -> list[int]:
        """Triangles around a vertex, in increasing order."""
        return sorted(self._star[v])

    def beside(self, v: int, w: int) -> list[int]:
        """Triangles beside an edge, in increasing order."""
        return sorted(self._star[v] & self._star[w])

    def neighbours(self, v: int) -> list[int]:
        """Vertices with edges to a vertex, in increasing order."""
        found = {w for t in self._star[v] for w in self.rows[t]}
        found.discard(v)
        return sorted(found)

    def is_flat(self, v: int, w: int) -> bool:
        """Whether an edge is an inner one of a patch."""
        beside = self.beside(v, w)
        return len(beside) == 2 and self.patch[beside[0]] == self.patch[beside[1]]

    def is_inside(self, v: int) -> bool:
        """Whether a vertex lies inside a patch, its triangles known."""
        return self.is_whole[v] and all(self.is_flat(v, w) for w in self.neighbours(v))

    def contracted(self, v: int, w: int) -> list[tuple[int, Row]] | None:
        """Triangles that stay when `v` becomes `w`, as they are then; None where it may not.

        Only a vertex inside a patch goes, or one of a curve along it, and none whose contraction
        would make anything but a surface of its neighbourhood (Dey, Edelsbrunner, Guha, Nekhayev
        1999).
        """
        if not (self.is_whole[v] and self.is_whole[w]):
            return None
        around = self.neighbours(v)
        beside = self.beside(v, w)
        curve = [x for x in around if not self.is_flat(v, x)]
        if curve:
            if len(curve) != 2 or w not in curve:
                return None
            other = self.beside(v, curve[curve[0] == w])
            if sorted(self.patch[t] for t in beside) != sorted(self.patch[t] for t in other):
                return None
        tips = {x for t in beside for x in self.rows[t]} - {v, w}
        if set(around).intersection(self.neighbours(w)) != tips:
            return None
        stay = [t for t in self.star(v) if t not in beside]
        rows = [tuple(w if x == v else x for x in self.rows[t]) for t in stay]
        there = {tuple(sorted(self.rows[t])) for t in self._star[w]}
        if not rows or any(tuple(sorted(row)) in there for row in rows):
            return None
        return list(zip(stay, rows, strict=True))

    def flipped(self, v: int, w: int) -> list[tuple[int, Row]] | None:
        """The two triangles beside an inner edge with the other diagonal; None where it is there.

        The first triangle has the first tip and `v`, or what comes after it.
        """
        if not (self.is_whole[v] and self.is_whole[w] and self.is_flat(v, w)):
            return None
        s, t = self.beside(v, w)
        row = self.rows[s]
        (p,), (q,) = (set(self.rows[k]) - {v, w} for k in (s, t))
        if p == q or self.beside(p, q):
            return None
        k = row.index(p)
        a, b = row[(k + 1) % 3], row[(k + 2) % 3]
        return [(s, (p, a, q)), (t, (p, q, b))]

    def replace(self, gone: Collection[int], new: Sequence[tuple[int, Row]]) -> None:
        """Take triangles away, and write others in the place of those of the same numbers."""
        for t in (*gone, *(t for t, _ in new)):
            for v in self.rows.pop(t):
                self._star[v].discard(t)
        for t, row in new:
            self.rows[t] = row
            for v in row:
                self._star[v].add(t)

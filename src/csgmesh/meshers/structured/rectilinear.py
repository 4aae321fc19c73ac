"""Domains of axis-parallel sides, in a frame of any direction, with round holes or inclusions."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from csgmesh.domain.curves import LINE
from csgmesh.domain.rays import UpwardRays
from csgmesh.errors import MeshingError
from csgmesh.meshers.structured.layout import Layout, Side
from csgmesh.meshers.structured.outline import Loop, Outline, Part
from csgmesh.meshers.structured.recognition import Recognition, ccw, round_loop

#: Sides may be off a direction of the frame by this share.
PARALLEL = 1e-9
#: A cell around a round hole is cut down where one of its margins is this many times the smallest
#: one, or the hole's radius if that is larger.
WIDE = 2.0

Box = tuple[np.ndarray, np.ndarray]


def frame_of(outline: Outline) -> np.ndarray | None:
    """Directions (2, 2) that every loop with corners is parallel to; None if there are none."""
    parts = [p for f in outline.faces for loop in (f.outer, *f.holes) if not round_loop(loop)
             for p in loop.parts]  # fmt: skip
    if not parts or any(outline.curves.kind[p.curve] != LINE for p in parts):
        return None
    arms = np.array([outline.point(p.curve, p.t1) - outline.point(p.curve, p.t0) for p in parts])
    length = np.hypot(*arms.T)
    u = arms[int(np.argmax(length))] / length.max()
    # The first direction is the one nearest to the x axis.
    u = u if abs(u[0]) >= abs(u[1]) else np.array([u[1], -u[0]])
    u = u if u[0] > 0 else -u
    frame = np.array([u, [-u[1], u[0]]])
    along = np.abs(arms @ frame.T) / length[:, None]
    return frame if (along.min(axis=1) <= PARALLEL).all() else None


class Grid:
    """Grid lines through all corners and between round holes."""

    def __init__(self, recognition: Recognition, frame: np.ndarray) -> None:
        self.recognition = recognition
        self.layout: Layout = recognition.layout
        self.outline = recognition.outline
        self.frame = frame
        self.loops = self._outermost_round_loops()
        self.boxes = [self._box(loop) for loop in self.loops]
        self.straight = {
            (p.curve, *sorted((p.t0, p.t1))): p
            for f in self.outline.faces
            for loop in (f.outer, *f.holes)
            if not round_loop(loop)
            for p in loop.parts
        }
        self.lines = self._lines()
        self.region = self._regions()
        self.at: dict[tuple[int, int], int] = {}
        self.on: dict[tuple[tuple[int, int], tuple[int, int]], Part] = {}
        self._trace()

    def _outermost_round_loops(self) -> list[Loop]:
        found: dict[object, Loop] = {}
        for face in self.outline.faces:
            for hole in face.holes:
                if round_loop(hole) and not round_loop(face.outer):
                    found[hole.key] = ccw(hole)
        return list(found.values())

    def _box(self, loop: Loop) -> Box:
        q = loop.polygon @ self.frame.T
        return q.min(axis=0), q.max(axis=0)

    def _lines(self) -> list[np.ndarray]:
        ends = np.array([self.outline.point(p.curve, t) for p in self.straight.values()
                         for t in (p.t0, p.t1)]) @ self.frame.T  # fmt: skip
        reach = 1e-9 * self.outline.domain.diagonal
        lines = []
        for axis in (0, 1):
            values = np.sort(ends[:, axis])
            lines.append(values[np.r_[True, np.diff(values) > reach]])
        for axis in (0, 1):
            for lo, hi in self.boxes:
                hit = (lines[axis] > lo[axis] - reach) & (lines[axis] < hi[axis] + reach)
                if hit.any():
                    raise self._blocked(0.5 * (lo + hi))
        self._separate(lines)
        self._trim(lines)
        return lines

    def _blocked(self, centre: np.ndarray) -> MeshingError:
        x, y = centre @ self.frame
        return MeshingError(
            "a box minus disks is split into blocks by straight lines between the disks and "
            f"through all corners; the one around ({x:.6g}, {y:.6g}) is in their way; use "
            "QuadPairing"
        )

    def _separate(self, lines: list[np.ndarray]) -> None:
        """Lines between holes that share a cell: in one direction if that does, else in both."""
        gaps = [self._gaps(axis) for axis in (0, 1)]
        width = [min((b - a for a, b in gap), default=-1.0) for gap in gaps]
        first = int(width[1] > width[0])
        for axes in ((first,), (1 - first,), (0, 1)):
            tried = [np.array(line) for line in lines]
            for axis in axes:
                for a, b in gaps[axis]:
                    if self._crowded(tried):
                        tried[axis] = np.sort(np.append(tried[axis], 0.5 * (a + b)))
            if not self._crowded(tried):
                lines[:] = tried
                return
        lo, hi = self.boxes[self._crowded(lines)[0]]
        raise self._blocked(0.5 * (lo + hi))

    def _gaps(self, axis: int) -> list[tuple[float, float]]:
        """Intervals between the holes' shadows on an axis."""
        spans = sorted((float(lo[axis]), float(hi[axis])) for lo, hi in self.boxes)
        gaps, until = [], -np.inf
        for lo, hi in spans:
            if lo > until and np.isfinite(until):
                gaps.append((until, lo))
            until = max(until, hi)
        return gaps

    def _crowded(self, lines: list[np.ndarray]) -> list[int]:
        """Holes that share their cell with one before them."""
        cells = [tuple(int(np.searchsorted(lines[k], lo[k])) for k in (0, 1))
                 for lo, _ in self.boxes]  # fmt: skip
        return [k for k, cell in enumerate(cells) if cell in cells[:k]]

    def _trim(self, lines: list[np.ndarray]) -> None:
        """Lines that give holes cells of their own shape, where they cross no other hole."""
        for lo, hi in self.boxes:
            margins = {}
            for axis in (0, 1):
                k = int(np.searchsorted(lines[axis], lo[axis]))
                margins[axis, -1] = float(lo[axis] - lines[axis][k - 1])
                margins[axis, 1] = float(lines[axis][k] - hi[axis])
            wanted = max(min(margins.values()), 0.5 * float((hi - lo).max()))
            for (axis, sign), margin in margins.items():
                # Halfway to the next hole at most.
                beyond = [float(a[axis] - hi[axis] if sign > 0 else lo[axis] - b[axis])
                          for a, b in self.boxes]  # fmt: skip
                step = min([wanted, *(0.5 * gap for gap in beyond if gap > 0)])
                line = float((hi if sign > 0 else lo)[axis]) + sign * step
                free = all(line < a[axis] or line > b[axis] for a, b in self.boxes)
                if margin > WIDE * wanted and free:
                    lines[axis] = np.sort(np.append(lines[axis], line))

    def _regions(self) -> np.ndarray:
        """Region of each cell of the grid at its lower left corner, -1 outside."""
        x, y = self.lines
        reach = [np.diff(line) for line in (x, y)]
        px, py = np.meshgrid(x[:-1] + 1e-6 * reach[0], y[:-1] + 1e-6 * reach[1], indexing="ij")
        points = np.stack([px.ravel(), py.ravel()], axis=1) @ self.frame
        domain = self.outline.domain
        above = UpwardRays(domain.points, domain.segments).first(points)
        ends = domain.points[domain.segments[above], 0]
        below = np.where(ends[:, 0] < ends[:, 1], *domain.segment_region[above, ::-1].T)
        return np.where(above < 0, -1, below).reshape(px.shape)

    def _trace(self) -> None:
        """Note which domain part lies along each edge of the grid, and the corners on it."""
        for part in self.straight.values():
            p, q = (self.frame @ self.outline.point(part.curve, t) for t in (part.t0, part.t1))
            axis = int(abs(q[1] - p[1]) > abs(q[0] - p[0]))
            other = self._index(1 - axis, float(0.5 * (p + q)[1 - axis]))
            k0, k1 = self._index(axis, float(p[axis])), self._index(axis, float(q[axis]))
            step = 1 if k1 > k0 else -1
            t = [part.t0]
            for k in range(k0 + step, k1, step):
                share = (self.lines[axis][k] - p[axis]) / (q[axis] - p[axis])
                t.append(part.t0 + float(share) * (part.t1 - part.t0))
            t.append(part.t1)
            row = [(k, other) if axis == 0 else (other, k) for k in range(k0, k1 + step, step)]
            for (a, b), (t0, t1) in zip(pairwise(row), pairwise(t), strict=True):
                self.on[a, b] = part.cut(t0, t1)
                self.on[b, a] = part.cut(t0, t1).reversed()
            for place, at in zip(row, t, strict=True):
                self.at[place] = self.layout.corner(self.outline.point(part.curve, at))

    def _index(self, axis: int, value: float) -> int:
        return int(np.argmin(np.abs(self.lines[axis] - value)))

    def lay_out(self) -> None:
        """All blocks."""
        held = {self._cell(lo): loop for loop, (lo, _) in zip(self.loops, self.boxes, strict=True)}
        for i, j in np.argwhere(self.region >= 0).tolist():
            region = int(self.region[i, j])
            bottom = self._edge((i, j), (i + 1, j))
            right = self._edge((i + 1, j), (i + 1, j + 1))
            top = self._edge((i, j + 1), (i + 1, j + 1))
            left = self._edge((i, j), (i, j + 1))
            if (i, j) not in held:
                self.layout.block(region, bottom, right, top, left)
                continue
            outside = [bottom, right, (top[0], not top[1]), (left[0], not left[1])]
            loop = held[i, j]
            inside = self.recognition.facing(loop, loop.corners(), outside)
            self.recognition.join(region, inside, outside)

    def _cell(self, lo: np.ndarray) -> tuple[int, int]:
        i, j = (int(np.searchsorted(self.lines[axis], lo[axis])) - 1 for axis in (0, 1))
        return i, j

    def _edge(self, a: tuple[int, int], b: tuple[int, int]) -> Side:
        part = self.on.get((a, b))
        if part is not None:
            return self.layout.edge([part])
        return self.layout.line(self._corner(a), self._corner(b))

    def _corner(self, place: tuple[int, int]) -> int:
        if place not in self.at:
            local = np.array([self.lines[0][place[0]], self.lines[1][place[1]]])
            self.at[place] = self.layout.corner(local @ self.frame)
        return self.at[place]

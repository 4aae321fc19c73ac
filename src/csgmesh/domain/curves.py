"""Exact planar curve pieces as one flat table.

Lines, elliptic arcs and Bézier curves are closed under every affine map, so circles, ellipses and
sheared disks are one kind and no transformation ever has to approximate.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

LINE, ARC, QUADRATIC, CUBIC = 0, 1, 2, 3

#: Numbers of `Curves.data` that a kind uses.
WIDTH = {LINE: 4, ARC: 6, QUADRATIC: 6, CUBIC: 8}

#: Which of the four pairs of `Curves.data` are points, a row a kind.
_MOVES = np.array([[1, 1, 0, 0], [1, 0, 0, 0], [1, 1, 1, 0], [1, 1, 1, 1]], float)

_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(12)
_PANELS = 8
_SAMPLES = 17
#: Steps after which a projection must have settled.
_NEWTON_STEPS = 60


@dataclass(frozen=True, eq=False)
class Curves:
    """A table of exact planar curve pieces.

    Attributes
    ----------
    kind : (n,) int8
        `LINE`, `ARC`, `QUADRATIC` or `CUBIC`.
    data : (n, 8) float64
        ``p0 p1`` for a line, ``c u v`` for the elliptic arc ``c + cos(t) u + sin(t) v``, the
        control points for a Bézier curve; the rest is zero.
    interval : (n, 2) float64
        Parameters at the piece's start and end; radians for arcs, within [0, 1] otherwise. The
        direction of travel is from the first to the second, so an arc's may decrease.

    Examples
    --------
    >>> arc = Curves.arcs([[0, 0]], [[1, 0]], [[0, 1]], [0.0], [np.pi / 2])
    >>> arc.points(np.array([0]), np.array([0.0]))
    array([[1., 0.]])
    """

    kind: np.ndarray
    data: np.ndarray
    interval: np.ndarray

    def __len__(self) -> int:
        return len(self.kind)

    def __getitem__(self, which: np.ndarray | slice) -> Curves:
        return Curves(self.kind[which], self.data[which], self.interval[which])

    @staticmethod
    def empty() -> Curves:
        """A table without curves."""
        return Curves(np.zeros(0, np.int8), np.zeros((0, 8)), np.zeros((0, 2)))

    @staticmethod
    def lines(p0: np.ndarray, p1: np.ndarray) -> Curves:
        """Straight pieces from `p0` to `p1`, each (n, 2)."""
        return _table(LINE, (p0, p1), 0.0, 1.0)

    @staticmethod
    def arcs(c: np.ndarray, u: np.ndarray, v: np.ndarray, t0: np.ndarray, t1: np.ndarray) -> Curves:
        """Elliptic arcs ``c + cos(t) u + sin(t) v`` from `t0` to `t1` (radians)."""
        return _table(ARC, (c, u, v), t0, t1)

    @staticmethod
    def quadratics(p0: np.ndarray, p1: np.ndarray, p2: np.ndarray) -> Curves:
        """Quadratic Bézier curves."""
        return _table(QUADRATIC, (p0, p1, p2), 0.0, 1.0)

    @staticmethod
    def cubics(p0: np.ndarray, p1: np.ndarray, p2: np.ndarray, p3: np.ndarray) -> Curves:
        """Cubic Bézier curves."""
        return _table(CUBIC, (p0, p1, p2, p3), 0.0, 1.0)

    @staticmethod
    def concatenate(tables: Iterable[Curves]) -> Curves:
        """The tables one after the other."""
        parts = [Curves.empty(), *tables]
        return Curves(
            np.concatenate([p.kind for p in parts]),
            np.concatenate([p.data for p in parts]),
            np.concatenate([p.interval for p in parts]),
        )

    def reversed(self) -> Curves:
        """The same pieces, travelled the other way."""
        return Curves(self.kind, self.data, np.ascontiguousarray(self.interval[:, ::-1]))

    def transformed(self, matrix: np.ndarray, offset: np.ndarray) -> Curves:
        """The image under ``x -> matrix @ x + offset``; parameters stay what they are."""
        blocks = self.data.reshape(-1, 4, 2) @ np.asarray(matrix, float).T
        # The axes u and v of an arc are vectors, not points: they do not move.
        blocks += _MOVES[self.kind][:, :, None] * np.asarray(offset, float)
        return Curves(self.kind, blocks.reshape(-1, 8), self.interval)

    def points(self, i: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Points of curves `i` (k,) at parameters `t` (k,), as (k, 2)."""
        return self._evaluate(i, t, 0)

    def derivatives(self, i: np.ndarray, t: np.ndarray) -> np.ndarray:
        """First derivatives with respect to the parameter, as (k, 2)."""
        return self._evaluate(i, t, 1)

    def second_derivatives(self, i: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Second derivatives with respect to the parameter, as (k, 2)."""
        return self._evaluate(i, t, 2)

    def starts(self) -> np.ndarray:
        """Start points of all pieces, (n, 2)."""
        return self.points(np.arange(len(self)), self.interval[:, 0])

    def ends(self) -> np.ndarray:
        """End points of all pieces, (n, 2)."""
        return self.points(np.arange(len(self)), self.interval[:, 1])

    def _evaluate(self, i: np.ndarray, t: np.ndarray, order: int) -> np.ndarray:
        kind = self.kind[i]
        if len(kind) == 0:
            return np.empty((0, 2))
        data, t = self.data[i], np.asarray(t, float)[:, None]
        if (kind == kind[0]).all():
            return _FORMULA[int(kind[0])](data, t, order)
        out = np.empty((len(kind), 2))
        for k in WIDTH:
            at = np.flatnonzero(kind == k)
            if len(at):
                out[at] = _FORMULA[k](data[at], t[at], order)
        return out

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Boxes that contain the pieces: tight for lines and arcs, control polygons for Béziers.

        Returns
        -------
        lo, hi : (n, 2) float64
        """
        ends = np.stack([self.starts(), self.ends()], axis=1)
        lo, hi = ends.min(axis=1), ends.max(axis=1)
        for kind in (QUADRATIC, CUBIC):
            at = self.kind == kind
            control = self.data[at, : WIDTH[kind]].reshape(-1, WIDTH[kind] // 2, 2)
            lo[at] = np.minimum(lo[at], control.min(axis=1))
            hi[at] = np.maximum(hi[at], control.max(axis=1))
        arcs = np.flatnonzero(self.kind == ARC)
        if len(arcs):
            t0, t1 = np.sort(self.interval[arcs], axis=1).T
            for axis in (0, 1):
                extreme = np.arctan2(self.data[arcs, 4 + axis], self.data[arcs, 2 + axis])
                for shift in (0.0, np.pi):
                    t = extreme + shift
                    t = t + 2 * np.pi * np.ceil((t0 - t) / (2 * np.pi))
                    inside = t <= t1
                    p = self.points(arcs[inside], t[inside])
                    np.minimum.at(lo, arcs[inside], p)
                    np.maximum.at(hi, arcs[inside], p)
        return lo, hi

    def second_derivative_bounds(self) -> np.ndarray:
        """Upper bounds of the second derivative's length over each whole curve, (n,).

        A chord over a parameter step s is nowhere further than ``s**2 / 8`` times this from it.
        """
        out = np.zeros(len(self))
        arc = self.kind == ARC
        if arc.any():
            axes = self.data[arc, 2:6].reshape(-1, 2, 2)
            out[arc] = np.linalg.norm(axes, ord=2, axis=(1, 2))
        for kind, factor in ((QUADRATIC, 2.0), (CUBIC, 6.0)):
            at = self.kind == kind
            if at.any():
                control = self.data[at, : WIDTH[kind]].reshape(-1, WIDTH[kind] // 2, 2)
                bend = np.hypot(*np.moveaxis(np.diff(control, n=2, axis=1), 2, 0))
                out[at] = factor * bend.max(axis=1)
        return out

    def lengths(self, i: np.ndarray, t0: np.ndarray, t1: np.ndarray) -> np.ndarray:
        """Arc lengths of curves `i` between parameters `t0` and `t1`, (k,), never negative."""
        i, t0, t1 = np.asarray(i, np.int64), np.asarray(t0, float), np.asarray(t1, float)
        speed = np.hypot(*self.derivatives(i, t0).T)
        out = speed * np.abs(t1 - t0)
        bent = np.flatnonzero((self.kind[i] != LINE) & ~self.is_circular()[i])
        if len(bent):
            edges = np.linspace(0.0, 1.0, _PANELS + 1)
            nodes = (edges[:-1, None] + (_GAUSS_X + 1) / (2 * _PANELS)).ravel()
            weights = np.tile(_GAUSS_W / (2 * _PANELS), _PANELS)
            t = t0[bent, None] + (t1 - t0)[bent, None] * nodes
            d = self.derivatives(np.repeat(i[bent], len(nodes)), t.ravel())
            out[bent] = np.hypot(*d.T).reshape(t.shape) @ weights * np.abs(t1 - t0)[bent]
        return out

    def is_circular(self) -> np.ndarray:
        """Which curves are arcs of circles, (n,) bool."""
        u, v = self.data[:, 2:4], self.data[:, 4:6]
        uu, vv, uv = (u * u).sum(1), (v * v).sum(1), (u * v).sum(1)
        rounding = 8 * np.finfo(float).eps * (uu + vv)
        return (self.kind == ARC) & (np.abs(uu - vv) <= rounding) & (np.abs(uv) <= rounding)

    def area_terms(
        self, i: np.ndarray, t0: np.ndarray, t1: np.ndarray, origin: np.ndarray | None = None
    ) -> np.ndarray:
        """Green's terms ``1/2 ∫ (x dy - y dx)`` along the exact curves, (k,).

        Parameters
        ----------
        i, t0, t1 : (k,)
            Curve numbers and the parameters between which to integrate.
        origin : (2,), optional
            Point about which x and y are taken; one near the domain keeps the digits.

        Examples
        --------
        >>> half = Curves.arcs([[0, 0]], [[2, 0]], [[0, 2]], [0.0], [np.pi])
        >>> round(float(half.area_terms([0], [0.0], [np.pi])[0] - 2 * np.pi), 12)
        0.0
        """
        i, t0, t1 = np.asarray(i, np.int64), np.asarray(t0, float), np.asarray(t1, float)
        shift = np.zeros(2) if origin is None else np.asarray(origin, float)
        a, b = self.points(i, t0) - shift, self.points(i, t1) - shift
        out = 0.5 * cross(a, b)
        arc = np.flatnonzero(self.kind[i] == ARC)
        if len(arc):
            d = self.data[i[arc]]
            sweep = cross(d[:, 2:4], d[:, 4:6]) * (t1 - t0)[arc]
            out[arc] = 0.5 * (cross(d[:, :2] - shift, (b - a)[arc]) + sweep)
        bezier = np.flatnonzero(self.kind[i] >= QUADRATIC)
        if len(bezier):
            # The integrand has degree 5 at most, which three Gauss points integrate exactly.
            x, w = np.polynomial.legendre.leggauss(3)
            half = 0.5 * (t1 - t0)[bezier]
            total = np.zeros(len(bezier))
            for xk, wk in zip(x, w, strict=True):
                t = t0[bezier] + half * (xk + 1)
                p = self.points(i[bezier], t) - shift
                total += wk * cross(p, self.derivatives(i[bezier], t))
            out[bezier] = 0.5 * half * total
        return out

    def project(
        self, i: np.ndarray, points: np.ndarray, t0: np.ndarray, t1: np.ndarray
    ) -> np.ndarray:
        """Parameters of the nearest points on curves `i` between `t0` and `t1`, (k,)."""
        i, points = np.asarray(i, np.int64), np.asarray(points, float)
        t0, t1 = np.asarray(t0, float), np.asarray(t1, float)
        lo, hi = np.minimum(t0, t1), np.maximum(t0, t1)
        t = lo.copy()
        straight = self.kind[i] == LINE
        if straight.any():
            d = self.data[i[straight]]
            along = d[:, 2:4] - d[:, :2]
            t[straight] = ((points[straight] - d[:, :2]) * along).sum(1) / (along * along).sum(1)
        bent = np.flatnonzero(~straight)
        if len(bent):
            t[bent] = self._project_bent(i[bent], points[bent], lo[bent], hi[bent])
        return np.clip(t, lo, hi)

    def _project_bent(
        self, i: np.ndarray, points: np.ndarray, lo: np.ndarray, hi: np.ndarray
    ) -> np.ndarray:
        grid = lo[:, None] + (hi - lo)[:, None] * np.linspace(0.0, 1.0, _SAMPLES)
        p = self.points(np.repeat(i, _SAMPLES), grid.ravel()).reshape(len(i), _SAMPLES, 2)
        nearest = ((p - points[:, None]) ** 2).sum(2).argmin(1)
        t = self._descend(i, points, grid[np.arange(len(i)), nearest], lo, hi)
        # Where a closed curve begins it also ends, and the nearest point may lie on either side.
        last = _SAMPLES - 1
        closed = (p[:, 0] == p[:, last]).all(1) | (np.abs(hi - lo) >= 2 * np.pi)
        seam = np.flatnonzero(closed & ((nearest == 0) | (nearest == last)))
        if len(seam):
            other = np.where(nearest[seam] == 0, hi[seam], lo[seam])
            s = self._descend(i[seam], points[seam], other, lo[seam], hi[seam])
            off_t = ((self.points(i[seam], t[seam]) - points[seam]) ** 2).sum(1)
            off_s = ((self.points(i[seam], s) - points[seam]) ** 2).sum(1)
            t[seam] = np.where(off_s < off_t, s, t[seam])
        return t

    def _descend(
        self, i: np.ndarray, points: np.ndarray, t: np.ndarray, lo: np.ndarray, hi: np.ndarray
    ) -> np.ndarray:
        """Newton's method for the nearest point, within one sample of the start."""
        step = (hi - lo) / (_SAMPLES - 1)
        low, high = np.maximum(t - step, lo), np.minimum(t + step, hi)
        t, going = t.copy(), np.arange(len(t))
        # Five steps do as a rule; at the tip of a hairpin Newton's method begins slowly.
        for _ in range(_NEWTON_STEPS):
            if not len(going):
                break
            on, at = i[going], t[going]
            r = self.points(on, at) - points[going]
            d1, d2 = self.derivatives(on, at), self.second_derivatives(on, at)
            slope = (d1 * d1).sum(1) + (r * d2).sum(1)
            # Away from convexity fall back on Gauss-Newton, which always descends.
            slope = np.where(slope > 0, slope, (d1 * d1).sum(1))
            with np.errstate(divide="ignore", invalid="ignore"):
                change = np.where(slope > 0, (r * d1).sum(1) / slope, 0.0)
            t[going] = np.clip(at - change, low[going], high[going])
            going = going[np.abs(t[going] - at) > np.spacing(np.abs(at))]
        return t


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross products of rows, (k,)."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _table(
    kind: int, columns: tuple[np.ndarray, ...], t0: np.ndarray | float, t1: np.ndarray | float
) -> Curves:
    blocks = [np.asarray(c, float).reshape(-1, 2) for c in columns]
    n = len(blocks[0])
    data = np.zeros((n, 8))
    for k, block in enumerate(blocks):
        data[:, 2 * k : 2 * k + 2] = block
    interval = np.empty((n, 2))
    interval[:, 0], interval[:, 1] = t0, t1
    return Curves(np.full(n, kind, np.int8), data, interval)


def _line(d: np.ndarray, t: np.ndarray, order: int) -> np.ndarray:
    along = d[:, 2:4] - d[:, 0:2]
    if order == 0:
        # From the nearer end: exact at both, and axis-parallel lines keep their coordinate.
        return np.where(t < 0.5, d[:, 0:2] + t * along, d[:, 2:4] - (1 - t) * along)
    return along if order == 1 else np.zeros((len(d), 2))


def _arc(d: np.ndarray, t: np.ndarray, order: int) -> np.ndarray:
    if order == 1:
        return -np.sin(t) * d[:, 2:4] + np.cos(t) * d[:, 4:6]
    bend = np.cos(t) * d[:, 2:4] + np.sin(t) * d[:, 4:6]
    return d[:, 0:2] + bend if order == 0 else -bend


def _quadratic(d: np.ndarray, t: np.ndarray, order: int) -> np.ndarray:
    p0, p1, p2 = d[:, 0:2], d[:, 2:4], d[:, 4:6]
    if order == 0:
        return (1 - t) ** 2 * p0 + 2 * (1 - t) * t * p1 + t**2 * p2
    if order == 1:
        return 2 * ((1 - t) * (p1 - p0) + t * (p2 - p1))
    return 2 * (p2 - 2 * p1 + p0)


def _cubic(d: np.ndarray, t: np.ndarray, order: int) -> np.ndarray:
    p0, p1, p2, p3 = d[:, 0:2], d[:, 2:4], d[:, 4:6], d[:, 6:8]
    s = 1 - t
    if order == 0:
        return s**3 * p0 + 3 * s**2 * t * p1 + 3 * s * t**2 * p2 + t**3 * p3
    if order == 1:
        return 3 * (s**2 * (p1 - p0) + 2 * s * t * (p2 - p1) + t**2 * (p3 - p2))
    return 6 * (s * (p2 - 2 * p1 + p0) + t * (p3 - 2 * p2 + p1))


_FORMULA = {LINE: _line, ARC: _arc, QUADRATIC: _quadratic, CUBIC: _cubic}

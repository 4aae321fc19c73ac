"""Exact surfaces in space as one flat table.

Every surface is the affine image of one of three kinds: the plane z = 0, a planar curve extruded
along z, a planar curve in (r, z) turned about the z axis. So spheres, ellipsoids, cylinders, cones
and tori are no kinds of their own, and no transformation ever has to approximate.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from csgmesh.domain.curves import Curves

PLANE, EXTRUDED, REVOLVED = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Surfaces:
    """A table of exact surfaces, oriented: their normals point out of the leaf they belong to.

    Attributes
    ----------
    kind : (n,) int8
        `PLANE`, `EXTRUDED` or `REVOLVED`.
    matrix, offset : (n, 3, 3), (n, 3) float64
        The placement ``x = matrix @ q + offset`` of the canonical surface.
    profile : Curves
        A row a surface: in (x, y) for extruded, in (r, z) for revolved ones, interior on the left;
        any line for planes, whose canonical normal is +z.

    Examples
    --------
    >>> arc = Curves.arcs([[0, 0]], [[2, 0]], [[0, 2]], [-np.pi / 2], [np.pi / 2])
    >>> sphere = Surfaces.placed(REVOLVED, arc, np.eye(3), np.zeros(3))
    >>> sphere.project(np.array([0]), np.array([[3.0, 0.0, 0.0]])).tolist()
    [[2.0, 0.0, 0.0]]
    """

    kind: np.ndarray
    matrix: np.ndarray
    offset: np.ndarray
    profile: Curves

    def __len__(self) -> int:
        return len(self.kind)

    def __getitem__(self, which: np.ndarray | slice) -> Surfaces:
        return Surfaces(
            self.kind[which], self.matrix[which], self.offset[which], self.profile[which]
        )

    @staticmethod
    def empty() -> Surfaces:
        """A table without surfaces."""
        return Surfaces(np.zeros(0, np.int8), np.zeros((0, 3, 3)), np.zeros((0, 3)), Curves.empty())

    @staticmethod
    def placed(kind: int, profile: Curves, matrix: np.ndarray, offset: np.ndarray) -> Surfaces:
        """Surfaces of one kind, a row a curve, all placed alike."""
        n = len(profile)
        return Surfaces(
            np.full(n, kind, np.int8),
            np.tile(np.asarray(matrix, float), (n, 1, 1)),
            np.tile(np.asarray(offset, float), (n, 1)),
            profile,
        )

    @staticmethod
    def planes(points: np.ndarray, normals: np.ndarray) -> Surfaces:
        """Planes through points (n, 3) with outward normals (n, 3)."""
        unit = normals / np.sqrt((normals**2).sum(axis=1))[:, None]
        least = np.argmin(np.abs(unit), axis=1)
        first = np.eye(3)[least]
        first -= (first * unit).sum(axis=1)[:, None] * unit
        first /= np.sqrt((first**2).sum(axis=1))[:, None]
        frames = np.stack([first, np.cross(unit, first), unit], axis=2)
        n = len(points)
        line = Curves.lines(np.zeros((n, 2)), np.tile([1.0, 0.0], (n, 1)))
        return Surfaces(np.zeros(n, np.int8), frames, np.asarray(points, float), line)

    @staticmethod
    def concatenate(tables: Iterable[Surfaces]) -> Surfaces:
        """The tables one after the other."""
        parts = [Surfaces.empty(), *tables]
        return Surfaces(
            np.concatenate([p.kind for p in parts]),
            np.concatenate([p.matrix for p in parts]),
            np.concatenate([p.offset for p in parts]),
            Curves.concatenate([p.profile for p in parts]),
        )

    def transformed(self, matrix: np.ndarray, offset: np.ndarray) -> Surfaces:
        """The image under ``x -> matrix @ x + offset``."""
        return Surfaces(
            self.kind,
            matrix @ self.matrix,
            self.offset @ np.transpose(matrix) + offset,
            self.profile,
        )

    @cached_property
    def inverse(self) -> np.ndarray:
        """Inverse matrices, (n, 3, 3)."""
        return np.linalg.inv(self.matrix) if len(self) else np.zeros((0, 3, 3))

    @cached_property
    def plane_normals(self) -> np.ndarray:
        """Unit normals of the images of the planes z = 0, (n, 3); of use for planes."""
        normals = self.inverse[:, 2, :]
        return normals / np.sqrt((normals**2).sum(axis=1))[:, None]

    def project(self, i: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Points on surfaces `i` (k,) near `points` (k, 3): the nearest, in canonical coordinates.

        The nearest ones in space, too, unless a surface is sheared or stretched.
        """
        out = np.array(points, dtype=float)
        kind = self.kind[i]
        flat = np.flatnonzero(kind == PLANE)
        normal = self.plane_normals[i[flat]]
        height = ((out[flat] - self.offset[i[flat]]) * normal).sum(axis=1)
        out[flat] -= height[:, None] * normal
        bent = np.flatnonzero(kind != PLANE)
        if len(bent):
            on = i[bent]
            q = self._canonical(on, out[bent])
            is_prism = kind[bent] == EXTRUDED
            for own, put in ((is_prism, self._on_prism), (~is_prism, self._on_turn)):
                if own.any():
                    q[own] = put(on[own], q[own])
            out[bent] = np.einsum("kij,kj->ki", self.matrix[on], q) + self.offset[on]
        return out

    def normals(self, i: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Outward unit normals of surfaces `i` (k,) at points near them, (k, 3)."""
        out = self.plane_normals[i]
        bent = np.flatnonzero(self.kind[i] != PLANE)
        if len(bent):
            out[bent] = self._bent_normals(i[bent], np.asarray(points, float)[bent])
        return out

    def _bent_normals(self, i: np.ndarray, points: np.ndarray) -> np.ndarray:
        kind = self.kind[i]
        q = self._canonical(i, points)
        canonical = np.zeros((len(i), 3))
        at = np.flatnonzero(kind == EXTRUDED)
        canonical[at, :2] = self._outward(i[at], q[at, :2])
        at = np.flatnonzero(kind == REVOLVED)
        radius = np.hypot(q[at, 0], q[at, 1])
        across = self._outward(i[at], np.column_stack([radius, q[at, 2]]))
        with np.errstate(divide="ignore", invalid="ignore"):
            spoke = np.where(radius[:, None] > 0.0, q[at, :2] / radius[:, None], 0.0)
        canonical[at] = np.column_stack([across[:, :1] * spoke, across[:, 1]])
        out = np.einsum("kji,kj->ki", self.inverse[i], canonical)
        length = np.sqrt((out**2).sum(axis=1))
        return np.asarray(out / np.where(length > 0.0, length, 1.0)[:, None])

    def parameters(self, i: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Parameters on the profiles of curved surfaces `i` (k,) nearest to points near them."""
        q = self._canonical(i, np.asarray(points, float))
        turned = np.column_stack([np.hypot(q[:, 0], q[:, 1]), q[:, 2]])
        return self._parameter(i, np.where((self.kind[i] == REVOLVED)[:, None], turned, q[:, :2]))

    def distance(self, i: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Distance of points from their projections, (k,)."""
        return np.sqrt(((self.project(i, points) - points) ** 2).sum(axis=1))

    def _canonical(self, i: np.ndarray, points: np.ndarray) -> np.ndarray:
        return np.einsum("kij,kj->ki", self.inverse[i], points - self.offset[i])

    def _parameter(self, i: np.ndarray, flat: np.ndarray) -> np.ndarray:
        out = np.empty(len(i))
        at = self._circular[i]
        out[at] = self._angle(i[at], flat[at])
        if not at.all():
            on = i[~at]
            out[~at] = self.profile.project(on, flat[~at], *self.profile.interval[on].T)
        return out

    @cached_property
    def _circular(self) -> np.ndarray:
        return self.profile.is_circular()

    def _angle(self, i: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Parameters of the nearest points on circular arcs, (k,)."""
        data = self.profile.data[i]
        spoke = flat - data[:, :2]
        low, high = np.sort(self.profile.interval[i], axis=1).T
        along, across = (spoke * data[:, 2:4]).sum(axis=1), (spoke * data[:, 4:6]).sum(axis=1)
        angle = np.arctan2(across, along)
        middle = 0.5 * (low + high)
        angle += 2.0 * np.pi * np.round((middle - angle) / (2.0 * np.pi))
        return np.clip(angle, low, high)

    def _outward(self, i: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Right-hand normals of the profiles, travelled from start to end, (k, 2)."""
        along = self.profile.derivatives(i, self._parameter(i, flat))
        along = along * np.sign(self.profile.interval[i, 1] - self.profile.interval[i, 0])[:, None]
        return np.column_stack([along[:, 1], -along[:, 0]])

    def _on_prism(self, i: np.ndarray, q: np.ndarray) -> np.ndarray:
        on = self.profile.points(i, self._parameter(i, q[:, :2]))
        return np.column_stack([on, q[:, 2]])

    def _on_turn(self, i: np.ndarray, q: np.ndarray) -> np.ndarray:
        radius = np.hypot(q[:, 0], q[:, 1])
        flat = np.column_stack([radius, q[:, 2]])
        on = self.profile.points(i, self._parameter(i, flat))
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(radius > 0.0, on[:, 0] / radius, 0.0)
        return np.column_stack([q[:, :2] * share[:, None], on[:, 1]])

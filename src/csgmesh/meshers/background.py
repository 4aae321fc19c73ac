"""Sizes known all over a domain from a coarse mesh, and its segments cut accordingly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh import kernels
from csgmesh.domain.pslg import Pslg
from csgmesh.meshers.workspace import Workspace

#: Sizes at the two ends that differ by less than this share count as equal.
LEVEL = 1e-6


@dataclass(frozen=True, eq=False)
class Background:
    """A coarse triangulation of a domain and the size at each of its vertices."""

    points: np.ndarray
    origin: np.ndarray
    twin: np.ndarray
    size: np.ndarray
    n_triangles: int

    @classmethod
    def of(cls, work: Workspace, size: np.ndarray) -> Background:
        """What a workspace holds, with its sizes."""
        return cls(work.points, work.origin, work.twin, size, work.n_triangles)

    def triangles(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of the domain's triangles, (n, 3), and edges with the domain on their left."""
        corners, sides = (
            a[: 4 * self.n_triangles].reshape(-1, 4) for a in (self.origin, self.twin)
        )
        inside = sides[:, 3] >= 0
        corners, sides = corners[inside, :3], sides[inside, :3]
        t, e = np.nonzero(~inside[sides >> 2])
        return corners, np.column_stack([corners[t, e], corners[t, (e + 1) % 3]])

    def at(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sizes at flat points, and the triangles (numbered by half-edge) that hold them."""
        n = len(points) // 2
        size, home = np.empty(n), np.empty(n, np.int32)
        kernels.look_up(self.points, self.origin, self.twin, self.size, points, size, home)
        return size, home


class Spacing:
    """How many edges of the wanted size fit along each segment, and where their ends are.

    Sizes are linear along each subsegment of the coarse mesh; the integral of 1 / h is then a
    logarithm.
    """

    def __init__(
        self,
        domain: Pslg,
        segment: np.ndarray,
        interval: np.ndarray,
        length: np.ndarray,
        size: np.ndarray,
    ) -> None:
        curved = domain.segment_curve[segment] >= 0
        start = np.where(curved, domain.segment_interval[segment, 0], 0.0)
        end = np.where(curved, domain.segment_interval[segment, 1], 1.0)
        share = (interval - start[:, None]) / (end - start)[:, None]
        order = np.lexsort((share[:, 0], segment))
        self.share, self.growth = share[order], size[order, 1] / size[order, 0]
        edges = length[order] / size[order, 0] / _mean_growth(self.growth)
        self.until = np.cumsum(edges)
        last = np.searchsorted(segment[order], np.arange(len(domain.segments)), side="right")
        total = np.concatenate([[0.0], self.until])
        self.first = total[np.concatenate([[0], last[:-1]])]
        self.edges = total[last] - self.first
        self.even = np.zeros(len(domain.segments), bool)

    def __call__(self, segment: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Where a share of a segment's edges ends, as a share of the segment."""
        wanted = self.first[segment] + share * self.edges[segment]
        at = np.minimum(np.searchsorted(self.until, wanted), len(self.until) - 1)
        before = np.where(at > 0, self.until[at - 1], 0.0)
        part = np.clip((wanted - before) / (self.until[at] - before), 0.0, 1.0)
        growth = self.growth[at]
        flat = np.abs(growth - 1.0) < LEVEL
        bent = np.where(flat, 2.0, growth)
        part = np.where(flat, part, (bent**part - 1.0) / (bent - 1.0))
        s0, s1 = self.share[at].T
        return np.where(self.even[segment], share, s0 + part * (s1 - s0))


def _mean_growth(growth: np.ndarray) -> np.ndarray:
    """Logarithmic mean of 1 and growth."""
    flat = np.abs(growth - 1.0) < LEVEL
    bent = np.where(flat, 2.0, growth)
    return np.where(flat, 0.5 * (1.0 + growth), (bent - 1.0) / np.log(bent))

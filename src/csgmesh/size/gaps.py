"""Gaps of a domain: the largest disks between two features of its boundary that face each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.size.features import Corners, corners
from csgmesh.size.outline import Outline
from csgmesh.size.sources import GradedSources

#: A disk that meets its own boundary again below this angle, seen from its centre, has met a bend,
#: not another feature: cos 60°.
OPPOSITE = 0.5
#: Two features that meet in a corner face each other where they open by less than this share of
#: their angle there: those of a crescent do in its middle, those of a wedge do nowhere.
PARALLEL = 0.5
#: Pieces longer than their gap are cut, in at most so many at a time, so many times.
CUTS = 8
ROUNDS = 16
#: Nothing is cut to pieces below this share of the diagonal.
FINEST = 1e-7
#: A disk is settled when nothing reaches into it by more than this share of its radius.
SETTLED = 1e-6
_SHRINKINGS = 60


def gaps(domain: Pslg) -> tuple[np.ndarray, np.ndarray]:
    """Disks that touch two features of a domain's boundary, and lie inside it.

    From each of many points of the boundary, on each side that belongs to the domain, a disk
    tangent there is shrunk until nothing reaches into it (Ma, Bae, Choi 2012): a search for the
    nearest piece at each step, never all pairs. Where the gap is narrower than the distance of the
    points, there are more points.

    Returns
    -------
    bridges : (k, 2, 2) float64
        The points on both features at which each disk touches them.
    widths : (k,) float64
        Diameters. Every point of a gap is within half its width of a bridge.
    """
    at_corners = corners(domain)
    outline = Outline.of(domain)
    new = np.arange(len(outline.segment))
    disks = _Disks.none()
    for _ in range(ROUNDS):
        nearest = GradedSources(outline.ends, np.zeros(len(outline.ends)), 0.0, 1.0)
        found = _disks(nearest, outline, new, at_corners, domain)
        disks = _Disks.joined(disks, found)
        narrowest = np.full(len(outline.segment), np.inf)
        other = nearest.lowest(disks.bridge[:, 1])[1]
        for piece in (disks.piece, other):
            np.minimum.at(narrowest, piece, 2 * disks.radius)
        wanted = outline.lengths() / np.maximum(narrowest, FINEST * domain.diagonal)
        parts = np.clip(np.ceil(wanted), 1, CUTS).astype(np.int64)
        if not (parts > 1).any():
            break
        outline = outline.cut(domain, parts)
        new = np.flatnonzero(np.repeat(parts, parts) > 1)
        disks = disks.of_whole(parts)
    tips = domain.points[at_corners.vertex]
    return (
        np.concatenate([disks.bridge, np.stack([tips, tips], axis=1)]),
        np.concatenate([2 * disks.radius, at_corners.shortest]),
    )


@dataclass(frozen=True, eq=False)
class _Disks:
    """Disks between features: the piece that each started from, where it touches, its radius.

    A disk that started in a corner is found anew each round.
    """

    piece: np.ndarray
    bridge: np.ndarray
    radius: np.ndarray
    in_corner: np.ndarray

    @staticmethod
    def none() -> _Disks:
        return _Disks(np.zeros(0, np.int64), np.zeros((0, 2, 2)), np.zeros(0), np.zeros(0, bool))

    @staticmethod
    def joined(a: _Disks, b: _Disks) -> _Disks:
        return _Disks(
            np.concatenate([a.piece, b.piece]),
            np.concatenate([a.bridge, b.bridge]),
            np.concatenate([a.radius, b.radius]),
            np.concatenate([a.in_corner, b.in_corner]),
        )

    def of_whole(self, parts: np.ndarray) -> _Disks:
        """Those of pieces that are not cut, with the numbers that these have afterwards."""
        keep = (parts[self.piece] == 1) & ~self.in_corner
        number = (np.cumsum(parts) - parts)[self.piece[keep]]
        return _Disks(number, self.bridge[keep], self.radius[keep], self.in_corner[keep])


def _disks(
    nearest: GradedSources, outline: Outline, new: np.ndarray, at_corners: Corners, domain: Pslg
) -> _Disks:
    """Disks from the new pieces of an outline, and from corners."""
    start, normal, own = _starts(outline, new, at_corners, domain)
    in_corner = np.arange(len(own)) >= len(own) - len(at_corners.outward[0])
    radius, met = _shrink(nearest, outline.ends, start, normal, domain.diagonal)
    found = met >= 0
    start, normal, own, met, radius, in_corner = (
        x[found] for x in (start, normal, own, met, radius, in_corner)
    )
    touched = _nearest_points(outline.ends[met], start + radius[:, None] * normal)
    across = np.hypot(*(touched - start).T)
    opening = np.pi - 2 * np.arcsin(np.clip(0.5 * across / radius, 0.0, 1.0))
    chain = at_corners.chain[outline.segment]
    facing = opening < PARALLEL * at_corners.angles(chain[own], chain[met])
    bridge = np.stack([start, touched], axis=1)
    return _Disks(own[facing], bridge[facing], radius[facing], in_corner[facing])


def _starts(
    outline: Outline, new: np.ndarray, at_corners: Corners, domain: Pslg
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the boundary, directions into the domain, the piece of each; corners last."""
    ends = outline.ends[new]
    along = ends[:, 1] - ends[:, 0]
    left = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    middle = ends.mean(axis=1)
    sides = domain.segment_region[outline.segment[new]] >= 0
    point, normal, own = at_corners.outward
    # Any piece of one of its chains stands for a corner.
    piece = outline.first_of(own)
    return (
        np.concatenate([middle[sides[:, 0]], middle[sides[:, 1]], point]),
        np.concatenate([left[sides[:, 0]], -left[sides[:, 1]], normal]),
        np.concatenate([new[sides[:, 0]], new[sides[:, 1]], piece]),
    )


def _shrink(
    nearest: GradedSources,
    pieces: np.ndarray,
    start: np.ndarray,
    normal: np.ndarray,
    largest: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Radii of the largest disks tangent at each start; the piece each touches, -1 for none.

    What a disk met on its way counts, not the bend of the start's own boundary that may stop it.
    """
    radius = np.full(len(start), largest)
    settled = radius.copy()
    met = np.full(len(start), -1)
    going = np.arange(len(start))
    for _ in range(_SHRINKINGS):
        if not len(going):
            break
        centre = start[going] + radius[going, None] * normal[going]
        distance, piece = nearest.lowest(centre)
        inside = distance < radius[going] * (1 - SETTLED)
        going, piece, centre = going[inside], piece[inside], centre[inside]
        reach = _nearest_points(pieces[piece], centre) - start[going]
        ahead = (reach * normal[going]).sum(axis=1)
        away2 = (reach * reach).sum(axis=1)
        keep = ahead > 0
        going, piece, ahead, away2 = going[keep], piece[keep], ahead[keep], away2[keep]
        radius[going] = np.minimum(0.5 * away2 / ahead, radius[going])
        # Twice the sine of half the angle at the centre is the distance over the radius.
        opposite = away2 >= 2 * (1 - OPPOSITE) * radius[going] ** 2
        settled[going[opposite]] = radius[going[opposite]]
        met[going[opposite]] = piece[opposite]
    return settled, met


def _nearest_points(pieces: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Nearest point of each piece to a point of its own, (k, 2)."""
    a = pieces[:, 0]
    along = pieces[:, 1] - a
    share = ((points - a) * along).sum(axis=1) / np.maximum((along * along).sum(axis=1), 1e-300)
    return a + np.clip(share, 0.0, 1.0)[:, None] * along

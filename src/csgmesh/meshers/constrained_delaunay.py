"""Constrained Delaunay triangulation: the domain's points and no others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError, MeshingError
from csgmesh.mesh import Mesh
from csgmesh.meshers.assembly import assemble
from csgmesh.meshers.lattice import Blocks
from csgmesh.meshers.pairing import paired_pieces, paired_spacing
from csgmesh.meshers.subdivision import Spaced, Subdivision, subdivide
from csgmesh.meshers.workspace import CROSSING, ON_SEGMENT, Progress, Workspace

#: A curve's chords are halved this often before a crossing of two of them is taken for an error.
HALVINGS = 12


@dataclass(frozen=True)
class ConstrainedDelaunay:
    """Constrained Delaunay triangulation of a domain's points, without Steiner points.

    Guarantees
    ----------
    Every segment of the domain is an edge. Every other edge is locally Delaunay by exact
    arithmetic, so the smallest angle is the largest that a triangulation of these points and
    segments can have.

    Exceptions
    ----------
    Where chords of two curves cross although the curves do not, they are refined, which adds points
    on the curves. A point that lies exactly on a straight segment splits it.

    Termination
    -----------
    Always. Insertion takes O(n log n) expected; recovering a segment that crosses k edges takes
    O(k²) at worst, O(k) as a rule.

    References
    ----------
    .. [1] L. P. Chew, "Constrained Delaunay triangulations", Algorithmica 4 (1989).
    .. [2] N. Amenta, S. Choi, G. Rote, "Incremental constructions con BRIO", SoCG (2003).

    Examples
    --------
    >>> from csgmesh.domain import Pslg
    >>> square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    >>> ConstrainedDelaunay().generate(square).n_cells
    2
    """

    def generate(self, domain: Pslg, size: None = None, progress: Progress | None = None) -> Mesh:
        """Triangulate a domain.

        Parameters
        ----------
        domain : Pslg
            What to triangulate.
        size : None
            Nothing is inserted, so there is no size to choose.
        progress : callable, optional
            Called as ``progress(stage, done, total)``.

        Raises
        ------
        InputError
            If a size is given.
        MeshingError
            If points coincide, segments cross or a region is not closed; with the place.
        """
        if size is not None:
            raise InputError(
                f"ConstrainedDelaunay inserts no points and so takes no size; size={size!r} given"
            )
        work = triangulated(domain, np.ones(len(domain.segments), np.int64), progress)
        return assemble(work, {"method": "ConstrainedDelaunay", "options": {}})


def triangulated(
    domain: Pslg,
    pieces: np.ndarray,
    progress: Progress | None,
    spacing: Spaced | None = None,
    lay: Callable[[Subdivision], Blocks | None] | None = None,
) -> Workspace:
    """Triangulate a domain whose segments are cut into `pieces` (m,) parts, regions flooded.

    `lay` may put blocks of ready triangles between the pieces.
    """
    spacing = paired_spacing(domain, spacing)
    for _ in range(HALVINGS):
        pieces = paired_pieces(domain, pieces)
        cut = subdivide(domain, pieces, spacing)
        blocks = lay(cut) if lay is not None else None
        known = cut if blocks is None else cut.with_points(blocks.outline)
        work = Workspace(domain, known, progress)
        work.triangulate()
        conflict = _recover(work)
        if conflict is None:
            work.flood()
            if blocks is not None:
                blocks.weave_into(work, len(cut.points))
            return work
        finer = [s for s in conflict if is_bent(domain, s)]
        if not finer:
            break
        pieces = pieces.copy()
        pieces[finer] *= 2
    assert conflict is not None
    first, second = (segment_text(domain, s) for s in (conflict + conflict)[:2])
    raise MeshingError(f"segments must meet at common points only: {first} meets {second}")


def is_bent(domain: Pslg, segment: int) -> bool:
    """Whether a segment stands for a piece of a true curve."""
    curve = domain.segment_curve[segment]
    return bool(curve >= 0 and domain.curves.kind[curve] > 0)


def segment_text(domain: Pslg, segment: int) -> str:
    """A segment with its names and place, for messages."""
    names = domain.boundary_names[domain.segment_marker[segment]]
    (ax, ay), (bx, by) = domain.points[domain.segments[segment]]
    return f"{' = '.join(names)} from ({ax:.12g}, {ay:.12g}) to ({bx:.12g}, {by:.12g})"


def _recover(work: Workspace) -> list[int] | None:
    """Recover all subsegments; None, or the segments that are in each other's way."""
    while True:
        status, k, met = work.recover()
        if status == CROSSING:
            return sorted({int(work.pieces.segment[k]), int(work.pieces.segment[met])})
        if status != ON_SEGMENT:
            return None
        segment = int(work.pieces.segment[k])
        if is_bent(work.domain, segment):
            return [segment]
        work.cut(k, met)

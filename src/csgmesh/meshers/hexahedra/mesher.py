"""Hexahedral meshes of solids from a grid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.errors import BudgetError, MeshingError, SizeError
from csgmesh.graphs import components
from csgmesh.mesh import Mesh
from csgmesh.meshers.hexahedra.blocks import Blocks, with_sheet
from csgmesh.meshers.hexahedra.core import Core, core_of, require_manifold
from csgmesh.meshers.hexahedra.grid import Grid
from csgmesh.meshers.hexahedra.judging import lost_corners, require_likeness, require_positive
from csgmesh.meshers.hexahedra.labels import labelled
from csgmesh.meshers.hexahedra.patches import stepped_faces, with_pillow
from csgmesh.meshers.hexahedra.placing import FREE, places_of, put, spread
from csgmesh.meshers.hexahedra.relaxation import Relaxation
from csgmesh.meshers.hexahedra.skin import Skin
from csgmesh.meshers.hexahedra.strata import JOINED, Strata
from csgmesh.meshers.workspace import Progress

#: What is tried, in turn: cells this much smaller than asked for, and how deep the core's cells
#: lie, in cells.
_ATTEMPTS = ((1.0, 0.5), (1.0, 0.2), (0.7, 0.5), (0.5, 0.5), (0.5, 0.2))

#: With a smallest scaled Jacobian above this the first attempt is good enough.
_GOOD = 0.15


def hexahedral_mesh(
    domain: Plc,
    sizes: Callable[[np.ndarray], np.ndarray],
    *,
    max_points: int = 10**7,
    progress: Progress | None = None,
) -> Mesh:
    """Mesh a solid with hexahedra alone.

    Cells of a grid inside the domain make the core. Its planes pass through the flat faces that
    are perpendicular to an axis, so these, and the edges between them, are met as they are. Along
    each other face a sheet of cells is put in, between two materials one on either side. Faces that
    meet at a reentrant edge share a sheet, and rows of cells along such edges keep them straight.
    Vertices go to the exact corners, curves and surfaces. Those near the boundary are averaged, and
    relaxed where cells stay bad. The cubes further inside cost no more than their numbers.

    Parameters
    ----------
    domain : Plc
    sizes : callable
        Wanted edge length at points (n, 3). The smallest one in the domain holds everywhere.
    max_points : int, default 10**7
    progress : callable, optional
        Called as ``progress(stage, done, total)``.

    Returns
    -------
    Mesh
        Of hexahedra; ``info`` has the size used, the smallest scaled Jacobian and the number of
        corners of the domain that have no vertex.

    Raises
    ------
    MeshingError
        If the domain is not resolved by cells of half the size, with the place.
    BudgetError
        If the mesh would have more than `max_points` points.
    SizeError
        If the size is not positive and finite somewhere.

    Guarantees
    ----------
    The mesh conforms. Jacobians are positive all over each cell, by Bernstein bounds. Vertices on
    the boundary lie on its exact surfaces, on the curves between them and at its corners.

    Exceptions
    ----------
    Sizes do not vary over the mesh. Where cells of the size asked for do not resolve the domain,
    smaller ones are tried, and ``info`` says so. A boundary that touches itself along an edge is
    refused, and so are interfaces that end on other faces. Not resolved may be corners where
    several edges end of which some are reentrant.

    Termination
    -----------
    After five attempts, each with a bounded number of rounds.

    References
    ----------
    .. [1] R. Schneiders, "A grid-based algorithm for the generation of hexahedral element meshes",
       Engineering with Computers 12 (1996).
    .. [2] V. Garanzha, I. Kaporin, L. Kudryavtseva, F. Protais, N. Ray, D. Sokolov, "Foldover-free
       maps in 50 lines of code", ACM Transactions on Graphics 40 (2021).

    Examples
    --------
    >>> import csgmesh as cm
    >>> ball = cm.evaluate(cm.Ball((0, 0, 0), 1))
    >>> mesh = hexahedral_mesh(ball, lambda points: np.full(len(points), 0.25))
    >>> list(mesh.cells), bool(cm.quality(mesh).scaled_jacobian.min() > 0.5)
    (['hexahedron'], True)
    """
    strata = Strata.of(domain)
    asked = _smallest(domain, sizes)
    best: tuple[float, Mesh] | None = None
    failure: MeshingError | None = None
    for k, (share, inset) in enumerate(_ATTEMPTS):
        if progress is not None:
            progress("hexahedra", k, len(_ATTEMPTS))
        try:
            worst, mesh = _attempt(strata, share * asked, inset, max_points)
        except BudgetError:
            if best is None and failure is None:
                raise
            break
        except MeshingError as error:
            failure = failure or error
            continue
        if best is None or worst > best[0]:
            best = worst, mesh
        if worst >= _GOOD:
            break
    if best is None:
        raise MeshingError(f"no hexahedra of size {asked:.6g} or half of it: {failure}")
    return best[1]


def _attempt(strata: Strata, size: float, inset: float, max_points: int) -> tuple[float, Mesh]:
    """A mesh with cells of one size, and its smallest scaled Jacobian."""
    core = core_of(strata, Grid.of(strata, size), size, inset, max_points)
    require_manifold(core)
    if not len(core.owner):
        low, high = strata.domain.bounds()
        x, y, z = 0.5 * (low + high)
        raise MeshingError(
            f"no cell of size {size:.6g} fits into the domain around ({x:.6g}, {y:.6g}, {z:.6g})"
        )
    label = labelled(strata, core, size)
    groups = sheet_groups(strata, core, label)
    moves = np.any(groups >= 0, axis=0)
    skin = Skin.of(core, label, np.asarray(moves)[label])
    places_of(skin.blocks, strata, size)
    blocks = with_sheets(skin.blocks, groups)
    over = len(blocks.points) + int(np.count_nonzero(core.cells)) - len(skin.blocks.hexes)
    if over > max_points:
        raise _over_budget(size, over, max_points)
    places = places_of(blocks, strata, size)
    points = blocks.points.copy()
    points[places.at_corner] = strata.corners[places.corner]
    put(points, places, strata, np.flatnonzero(places.kind != FREE), first=True)
    loose = np.zeros(len(points), bool)
    loose[blocks.hexes[len(skin.blocks.hexes) :].ravel()] = True
    spread(points, blocks, places, strata, loose)
    held = np.zeros(len(points), bool)
    held[: len(skin.held)] = skin.held
    relaxation = Relaxation.of(points, blocks, places, strata, size, held)
    relaxation.run()
    blocks = blocks.with_points(points)
    require_positive(blocks)
    require_likeness(blocks, strata, size)
    worst = float(relaxation.quality.min(initial=1.0))
    info = {
        "method": "hexahedra",
        "size": size,
        "scaled_jacobian": worst,
        "lost_corners": lost_corners(places.corner, strata),
    }
    return worst, _mesh(strata, skin, blocks, size, info)


def sheet_groups(strata: Strata, core: Core, label: np.ndarray) -> np.ndarray:
    """Which sheet lies behind and in front of each face, -1 for none, (2, f).

    Each face that is not flat in the grid gets one; faces that meet smoothly, or at an edge that
    the solid surrounds, share it.
    """
    n = strata.n_faces
    low, high = np.full(n, 6), np.full(n, -1)
    np.minimum.at(low, label, core.way)
    np.maximum.at(high, label, core.way)
    bent = (low < high) | (strata.face_axis < 0)
    out = np.full((2, n), -1)
    for side, turn in enumerate((strata.turn, 360.0 - strata.turn)):
        joined = turn > JOINED
        _, group = components(n, strata.pair[joined, 0], strata.pair[joined, 1])
        moves = np.zeros(n, bool)
        moves[group[bent]] = True
        own = moves[group]
        if side:
            own &= (strata.face_regions >= 0).all(axis=1)
        out[side, own] = group[own]
    return out


def with_sheets(blocks: Blocks, groups: np.ndarray) -> Blocks:
    """A sheet of cells along each group of faces, on one side or on both, with rows on curves."""
    for side, group in enumerate(groups):
        for g in np.unique(group[group >= 0]).tolist():
            chosen = group[blocks.label] == g
            outer, first = np.flatnonzero(chosen), len(blocks.hexes)
            stepped = stepped_faces(blocks, chosen)
            blocks = with_sheet(blocks, chosen, in_front=side == 1)
            for face in stepped.tolist():
                own = np.flatnonzero(blocks.label[outer] == face)
                if (blocks.front[outer[own]] < 0).all():
                    blocks = with_pillow(blocks, first + own, outer[own])
    return blocks


def _smallest(domain: Plc, sizes: Callable[[np.ndarray], np.ndarray]) -> float:
    """The smallest size at the domain's points and at those of a lattice that lie inside."""
    low, high = domain.bounds()
    lines = [np.linspace(a, b, 17) for a, b in zip(low, high, strict=True)]
    inner = np.stack(np.meshgrid(*lines, indexing="ij"), axis=3).reshape(-1, 3)
    if domain.oracle is not None:
        inner = inner[domain.oracle.region(inner) >= 0]
    least = float(np.min(sizes(np.concatenate([domain.points, inner]))))
    if not 0.0 < least < np.inf:
        raise SizeError(f"size must be positive and finite everywhere; got {least!r}")
    return least


def _over_budget(size: float, n: int, max_points: int) -> BudgetError:
    return BudgetError(
        f"hexahedra of size {size:.6g} need {n:,} points; max_points allows {max_points:,}"
    )


def _mesh(strata: Strata, skin: Skin, blocks: Blocks, size: float, info: dict[str, object]) -> Mesh:
    domain = strata.domain
    points, hexes, region = skin.joined(blocks)
    middle = strata.on_faces(blocks.label, blocks.points[blocks.quads].mean(axis=1))
    sides = np.column_stack([blocks.behind, blocks.front])
    for array in (points, hexes, region):
        array.flags.writeable = False
    return Mesh(
        points,
        {"hexahedron": hexes},
        {"hexahedron": region},
        domain.region_names,
        {"quad": blocks.quads},
        {"quad": strata.markers(blocks.label, middle, size)},
        domain.boundary_names,
        {"quad": sides},
        domain=domain,  # type: ignore[arg-type]
        info=info,
    )

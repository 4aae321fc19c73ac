"""Hexahedral meshes of solids from a grid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from csgmesh.domain.plc import Plc
from csgmesh.errors import BudgetError, MeshingError, SizeError
from csgmesh.graphs import components
from csgmesh.mesh import Mesh
from csgmesh.meshers.hexahedra.blocks import Blocks, core_blocks, with_sheet
from csgmesh.meshers.hexahedra.core import core_cells, require_manifold
from csgmesh.meshers.hexahedra.grid import Grid
from csgmesh.meshers.hexahedra.judging import lost_corners, require_likeness, require_positive
from csgmesh.meshers.hexahedra.labels import labelled
from csgmesh.meshers.hexahedra.placing import Relaxation, places_of, put, spread
from csgmesh.meshers.hexahedra.strata import JOINED, Finder, Strata
from csgmesh.meshers.hexahedra.strips import with_strips
from csgmesh.meshers.workspace import Progress

#: What is tried, in turn: cells this much smaller than asked for, and how deep the core's cells
#: lie, in cells.
_ATTEMPTS = ((1.0, 0.5), (1.0, 0.2), (0.7, 0.5), (0.5, 0.5), (0.5, 0.2))

#: With a smallest scaled Jacobian above this the first attempt is good enough.
_GOOD = 0.2


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
    each other face a sheet of cells is put in, and one along each reentrant edge of a flat face
    perpendicular to an axis; vertices go to the exact corners, curves and
    surfaces, and those near the boundary are relaxed.

    Parameters
    ----------
    domain : Plc
        Of one material.
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
        If the domain is not resolved by cells of half the size, with the place; if it has several
        materials.
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
    refused. Not resolved, at any size, are mostly edges with more than 150° inside the solid
    between two faces of which none is flat and perpendicular to an axis, such as where two pipes
    meet, and corners where several such edges end.

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
    if len(domain.region_names) > 1:
        raise MeshingError(
            f"hexahedra are made of one material; the domain has {len(domain.region_names)}: "
            + ", ".join(domain.region_names)
        )
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
    grid = Grid.of(strata, size)
    cells = core_cells(strata, grid, size, inset, max_points)
    require_manifold(cells, grid)
    points, hexes, (quads, ways) = core_blocks(cells, grid)
    if not len(hexes):
        low, high = strata.domain.bounds()
        x, y, z = 0.5 * (low + high)
        raise MeshingError(
            f"no cell of size {size:.6g} fits into the domain around ({x:.6g}, {y:.6g}, {z:.6g})"
        )
    finder = Finder.of(strata, size, 2.5 * size, np.arange(len(strata.face)))
    label = labelled(strata, finder, points, quads, ways, size)
    blocks = Blocks(points, hexes, quads, label)
    places_of(blocks, strata, size)
    blocks = with_sheets(blocks, strata, ways)
    if len(blocks.points) > max_points:
        raise _over_budget(size, len(blocks.points), max_points)
    places = places_of(blocks, strata, size)
    points = blocks.points.copy()
    put(points, places, strata, first=True)
    loose = np.zeros(len(points), bool)
    loose[blocks.hexes[len(hexes) :].ravel()] = True
    spread(points, blocks, places, strata, loose)
    relaxation = Relaxation.of(points, blocks, places, strata, size, loose)
    relaxation.run()
    blocks = Blocks(points, blocks.hexes, blocks.quads, blocks.label)
    require_positive(blocks)
    require_likeness(blocks, strata, size)
    worst = relaxation.worst()
    info = {
        "method": "hexahedra",
        "size": size,
        "scaled_jacobian": worst,
        "lost_corners": lost_corners(places.corner, strata),
    }
    return worst, _mesh(strata, blocks, size, info)


def with_sheets(blocks: Blocks, strata: Strata, ways: np.ndarray) -> Blocks:
    """A sheet of cells along each face that is not flat in the grid.

    Faces that meet smoothly, or at an edge that the solid surrounds, share one.
    """
    n = strata.n_faces
    joined = strata.turn > JOINED
    _, group = components(n, strata.pair[joined, 0], strata.pair[joined, 1])
    way = 2 * ways[:, 0] + ways[:, 1]
    low, high = np.full(n, 6), np.full(n, -1)
    np.minimum.at(low, blocks.label, way)
    np.maximum.at(high, blocks.label, way)
    bent = (low < high) | (strata.face_axis < 0)
    blocks = with_strips(blocks, strata, bent)
    for g in np.unique(group[bent]).tolist():
        blocks = with_sheet(blocks, group[blocks.label] == g)
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


def _mesh(strata: Strata, blocks: Blocks, size: float, info: dict[str, object]) -> Mesh:
    domain = strata.domain
    middle = strata.on_faces(blocks.label, blocks.points[blocks.quads].mean(axis=1))
    return Mesh(
        blocks.points,
        {"hexahedron": blocks.hexes},
        region_names=domain.region_names,
        facets={"quad": blocks.quads},
        facet_marker={"quad": strata.markers(blocks.label, middle, size)},
        boundary_names=domain.boundary_names,
        facet_region={"quad": np.tile([0, -1], (len(blocks.quads), 1))},
        domain=domain,  # type: ignore[arg-type]
        info=info,
    )

"""Where a mesh's worst cells are, and why."""

from __future__ import annotations

from typing import Any

from csgmesh.errors import InputError
from csgmesh.mesh import Mesh
from csgmesh.options import check_whole


def worst_cells(mesh: Mesh, count: int = 5) -> list[dict[str, object]]:
    """The cells with the smallest angles, each with its place and the likely reason.

    Parameters
    ----------
    mesh : Mesh
        A mesh of a plane domain with triangles, or a mesh of space.
    count : int, default 5
        How many cells to list.

    Returns
    -------
    list of dict
        ``place`` of the centroid, [x, y] or [x, y, z]; ``angle`` in degrees, in space the smallest
        dihedral one; and ``reason``. In the plane: ``"input angle"`` (within the protected shell of
        one below 60 degrees), ``"narrow gap"`` (all vertices on the boundary, and no facet is the
        shortest edge), ``"size jump"`` (mean edge lengths at the vertices differ by a factor of
        1.8), ``"budget"`` (below the angle asked for without any of these: the mesher had to stop),
        or ``"within the bound"``. In space: ``"sharp edge"`` (the cell fills the edge between two
        facets), ``"thin wall"`` (all corners on the boundary), ``"size jump"``, or ``"lattice"``
        (what the surface leaves between itself and the lattice inside). JSON-able, worst first.

    Raises
    ------
    InputError
        If this is no mesh, or has no cells that can be listed.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Triangle((0, 0), (4, 0), (4, 1)))
    >>> worst = cm.worst_cells(mesh, 1)[0]
    >>> worst["reason"], round(worst["angle"], 2)
    ('input angle', 14.04)
    """
    if not isinstance(mesh, Mesh):
        raise InputError(
            f"worst_cells needs a Mesh, as generate returns; got {type(mesh).__name__}"
        )
    count = check_whole("count", count, 1)
    if mesh.dim == 3:
        from csgmesh.meshers.worst.solid import worst_solids

        return worst_solids(mesh, count)
    from csgmesh.meshers.worst.plane import worst_triangles

    return worst_triangles(mesh, count)


def describe(cell: dict[str, object]) -> str:
    """One of `worst_cells` as text.

    Examples
    --------
    >>> describe({"place": [0.5, 2.0], "angle": 3.1234, "reason": "narrow gap"})
    '3.12° at (0.5, 2) (narrow gap)'
    """
    place: Any = cell["place"]
    where = ", ".join(f"{c:.6g}" for c in place)
    return f"{cell['angle']:.3g}° at ({where}) ({cell['reason']})"

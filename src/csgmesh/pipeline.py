"""From a shape to its mesh: the only place that knows every stage."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from csgmesh.boundary import evaluate
from csgmesh.errors import InputError, MeshingError

if TYPE_CHECKING:
    from csgmesh.domain.pslg import Pslg
    from csgmesh.measures.certificate import Certificate
    from csgmesh.mesh import Mesh

Progress = Callable[[str, int, int], None]


class Mesher(Protocol):
    """A method: an immutable object of options with one verb."""

    def generate(self, domain: Any, size: Any = None, progress: Progress | None = None) -> Mesh:
        """The mesh of a Pslg or, if its ``dim`` is 3, of a Plc."""


def generate(
    shape: Any,
    mesher: Mesher | None = None,
    size: Any = None,
    *,
    deviation: float | None = None,
    snap: float | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """Mesh a shape.

    Parameters
    ----------
    shape : Shape, Regions, Embed, Periodic or Pslg
        What to mesh.
    mesher : object with ``generate``, optional
        How: `DelaunayRefinement` in the plane, `Octree` in space unless given.
    size : float, mapping, callable or SizeField, optional
        Wanted edge length in coordinate units: a number; a mapping of names of boundaries or
        regions to numbers with ``"default"``, where a name that a region and a boundary share means
        both; a callable ``h(points (n, 2)) -> (n,)``. Without it
        curvature, feature size and gradation decide.
    deviation : float, optional
        Largest distance between a facet and its exact curve; see `evaluate`.
    snap : float, optional
        Distance below which points merge; see `evaluate`.
    progress : callable, optional
        Called as ``progress(stage, done, total)``; an exception it raises stops the work.

    Returns
    -------
    Mesh

    Raises
    ------
    InputError
        If an argument breaks a rule.
    EvaluationError
        If the shape has no boundary that could be meshed.
    MeshingError
        If the mesher cannot do it; a `BudgetError` carries the mesh so far.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0), (2, 1)) - cm.Disk((1, 0.5), 0.25), size=0.2)
    >>> mesh.names
    ('box.left', 'box.right', 'box.bottom', 'box.top', 'disk')
    """
    chosen = None if mesher is None else default_mesher(mesher)
    if progress is not None and not callable(progress):
        raise InputError(
            f"progress must be callable as progress(stage, done, total); got {progress!r}"
        )
    if progress is not None:
        progress("evaluate", 0, 1)
    domain = evaluate(shape, deviation=deviation, snap=snap)
    if progress is not None:
        progress("evaluate", 1, 1)
    mesher = chosen or default_mesher(None, domain.dim)
    _refuse_other_dimension(mesher, domain.dim)
    mesh = mesher.generate(domain, size, progress)
    if domain.dim == 2 and domain.periodic and not mesh.periodic:
        raise MeshingError(
            f"{type(mesher).__name__} does not match the vertices of periodic sides; "
            "DelaunayRefinement and ConstrainedDelaunay do"
        )
    return mesh


def _refuse_other_dimension(mesher: Mesher, dim: int) -> None:
    if getattr(mesher, "dim", 2) != dim:
        places = {2: "the plane", 3: "space"}
        others = "; Octree meshes any solid, Sweep extrusions and revolutions"
        raise InputError(
            f"{type(mesher).__name__} meshes domains in {places[5 - dim]}; this one lies in "
            f"{places[dim]}" + (others if dim == 3 else "")
        )


def default_mesher(mesher: Any, dim: int = 2) -> Mesher:
    """The mesher given, or for None `DelaunayRefinement` in the plane and `Octree` in space.

    Raises
    ------
    InputError
        If it is not an object that can generate.
    """
    if mesher is None:
        from csgmesh.meshers import DelaunayRefinement, Octree

        return DelaunayRefinement() if dim == 2 else Octree()
    if isinstance(mesher, type) or not callable(getattr(mesher, "generate", None)):
        raise InputError(
            f"mesher must be an object such as DelaunayRefinement(min_angle=30), got {mesher!r}"
        )
    chosen: Mesher = mesher
    return chosen


def check(mesh: Mesh, shape: Any = None) -> Certificate:
    """Verify a mesh.

    Parameters
    ----------
    mesh : Mesh
    shape : Shape, Regions, Embed, Periodic or Pslg, optional
        With it nothing of the mesh is trusted but coordinates and connectivity: the shape is
        evaluated anew, and 1e5 points are compared with the tree itself.

    Returns
    -------
    Certificate
        ``.ok``, ``.failures``, ``.to_json()``; printing it shows every rule.

    Examples
    --------
    >>> import csgmesh as cm
    >>> plate = cm.Box((0, 0), (2, 1)) - cm.Disk((1, 0.5), 0.25)
    >>> cm.check(cm.generate(plate, size=0.2), plate).ok
    True
    """
    from csgmesh.measures.certificate import check as verify
    from csgmesh.mesh import Mesh

    if not isinstance(mesh, Mesh):
        raise InputError(f"check needs a Mesh, as generate returns; got {type(mesh).__name__}")
    if mesh.dim == 3:
        return _check_space(mesh, shape)
    if shape is None:
        return verify(mesh)
    reference = _reference(mesh, shape)
    contains = reference.oracle.region if reference.oracle is not None else None
    return verify(mesh, reference, contains)


def _check_space(mesh: Mesh, shape: Any) -> Certificate:
    from csgmesh.measures.space.certificate import check_space
    from csgmesh.measures.space.surface import check_surface
    from csgmesh.mesh.surfaces import is_surface

    verify = check_surface if is_surface(mesh) else check_space
    if shape is None:
        return verify(mesh)
    reference = evaluate(shape)
    if reference.dim != 3:
        raise InputError(f"check: the mesh is in space, the shape in the plane; got {shape!r}")
    contains = reference.oracle.region if reference.oracle is not None else None
    return verify(mesh, reference, contains)


def _reference(mesh: Mesh, shape: Any) -> Pslg:
    """The shape evaluated anew, as finely as the mesh says that its domain was.

    By default each leaf has a deviation of its own, of which a domain remembers the largest: asking
    for that one everywhere would give other chords, and other shells at sharp corners.
    """
    reference = evaluate(shape)
    known = mesh.domain
    if (
        reference is shape
        or known is None
        or (known.deviation, known.snap) == (reference.deviation, reference.snap)
    ):
        return reference
    return evaluate(shape, deviation=known.deviation or None, snap=known.snap or None)

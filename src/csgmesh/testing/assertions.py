"""Assertions on meshes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from csgmesh.domainfile.conditions import Condition
from csgmesh.domainfile.exact import covered_area
from csgmesh.domainfile.expect import measure_mismatch, mismatches, name_mismatches, read_expect
from csgmesh.mesh import Mesh
from csgmesh.pipeline import check


def assert_valid(mesh: Mesh, shape: Any = None) -> None:
    """Assert that a mesh passes `csgmesh.check`.

    Parameters
    ----------
    mesh : Mesh
    shape : Shape, Regions, Embed, Periodic or Pslg, optional
        What was meshed; it is evaluated anew and compared.

    Raises
    ------
    AssertionError
        With all rules that the mesh breaks, and where.

    Examples
    --------
    >>> import csgmesh as cm
    >>> from csgmesh.testing import assert_valid
    >>> assert_valid(cm.generate(cm.Box((0, 0), (2, 1)), size=0.5), cm.Box((0, 0), (2, 1)))
    """
    __tracebackhide__ = True
    certificate = check(mesh, shape)
    if not certificate.ok:
        _fail("the mesh is not valid", map(str, certificate.failures))


def assert_area(
    mesh: Mesh,
    area: float | str | tuple[float, float],
    tolerance: float | None = None,
    region: str | None = None,
) -> None:
    """Assert the area of a mesh or of one of its regions.

    Parameters
    ----------
    mesh : Mesh
    area : float, str or (float, float)
        The exact area; or a comparison such as ``">= 3"`` or a range, of the mesh's own area.
    tolerance : float, optional
        Largest difference between `area` and the area of the cells. Without it the area within the
        mesh's exact curves must be `area`, to what those and their chords differ by.
    region : str, optional
        Name, prefix or glob of regions.

    Raises
    ------
    AssertionError
        With the area found.
    NameLookupError
        No region has that name.

    Examples
    --------
    >>> import csgmesh as cm
    >>> from csgmesh.testing import assert_area
    >>> assert_area(cm.generate(cm.Disk((0, 0), 1), size=0.2), 3.14159265)
    """
    __tracebackhide__ = True
    what = "area" if region is None else f"area of {region!r}"
    wanted = Condition.parse(area)
    message = measure_mismatch(what, covered_area(mesh, region), wanted, tolerance)
    if message:
        _fail(message)


def assert_names(mesh: Mesh, names: Iterable[str]) -> None:
    """Assert the names of the boundaries: each one given is there, and no other.

    Parameters
    ----------
    mesh : Mesh
    names : iterable of str
        Names, prefixes (`plate` stands for all of `plate.*`) or globs.

    Raises
    ------
    AssertionError
        With the names that are missing and those that nobody expected.

    Examples
    --------
    >>> import csgmesh as cm
    >>> from csgmesh.testing import assert_names
    >>> plate = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
    >>> assert_names(cm.generate(plate, size=0.5), ["plate", "hole"])
    """
    __tracebackhide__ = True
    found = [str(mismatch) for mismatch in name_mismatches(mesh, list(names))]
    if found:
        _fail("the names differ", found)


def assert_matches(mesh: Mesh, expect: Mapping[str, Any]) -> None:
    """Assert that a mesh meets expectations, written as the ``expect`` block of a domain file.

    Parameters
    ----------
    mesh : Mesh
    expect : mapping
        With any of `area`, `volume`, `min_angle`, `max_angle`, `min_dihedral`, `max_dihedral`,
        `cells`, `points`, `boundary`, `regions`, `names`, `tolerance`; or `load(path).expect`.

    Raises
    ------
    AssertionError
        With all expectations that the mesh does not meet.
    InputError
        An unknown key, or a value that is no condition.

    Examples
    --------
    >>> import csgmesh as cm
    >>> from csgmesh.testing import assert_matches
    >>> mesh = cm.generate(cm.Disk((0, 0), 1, name="rim"), size=0.2)
    >>> assert_matches(mesh, {"min_angle": ">= 29", "boundary": {"rim": {"length": 6.283185307}}})
    """
    __tracebackhide__ = True
    found = [str(mismatch) for mismatch in mismatches(mesh, read_expect(expect))]
    if found:
        _fail("the mesh does not match", found)


def _fail(message: str, details: Iterable[str] = ()) -> None:
    __tracebackhide__ = True
    raise AssertionError("\n  ".join([message, *details]))

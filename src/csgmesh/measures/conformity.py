"""How well the edges of a mesh have the lengths that a size asks for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from csgmesh.domain.pslg import Pslg
from csgmesh.errors import InputError
from csgmesh.measures.summary import histogram
from csgmesh.mesh import Mesh
from csgmesh.size import limit_gradation, pointwise
from csgmesh.size.background import cell_edges

#: Edges between these shares of the wanted length count as right.
RIGHT = (0.6, 1.6)
_BINS = 10
_SHOWN = (0.0, 2.0)


@dataclass(frozen=True, eq=False, repr=False)
class SizeConformity:
    """Edge lengths of a mesh beside the size; printed, a histogram of their ratios.

    Attributes
    ----------
    ratio : (n_edges,) float64
        Length of each edge over the size wanted there, the mean of its ends.
    edges : (n_edges, 2) int64
        Points of each edge.
    wanted : (n_points,) float64
        Size at each point of the mesh, its growth limited along edges.
    """

    ratio: np.ndarray
    edges: np.ndarray
    wanted: np.ndarray

    @property
    def share(self) -> float:
        """Share of the edges with a ratio within [0.6, 1.6]."""
        if not len(self.ratio):
            return 1.0
        return float(((self.ratio >= RIGHT[0]) & (self.ratio <= RIGHT[1])).mean())

    def __repr__(self) -> str:
        return (
            f"<SizeConformity: {100 * self.share:.1f} % of {len(self.ratio):,} edges are "
            f"{RIGHT[0]} to {RIGHT[1]} times as long as wanted>"
        )

    def __str__(self) -> str:
        if not len(self.ratio):
            return "no edges"
        low, mean, high = self.ratio.min(), self.ratio.mean(), self.ratio.max()
        return "\n".join(
            [
                f"{100 * self.share:.1f} % of {len(self.ratio):,} edges are {RIGHT[0]} to "
                f"{RIGHT[1]} times as long as wanted; mean {mean:.3g}, {low:.3g} to {high:.3g}",
                "",
                "edge length over size",
                *histogram(self.ratio, *_SHOWN, _BINS),
            ]
        )


def size_conformity(
    mesh: Mesh, size: Any, *, gradation: float | None = None, domain: Pslg | None = None
) -> SizeConformity:
    """Compare the edges of a plane mesh with a size.

    Parameters
    ----------
    mesh : Mesh
        Of triangles, quads or both.
    size : float, mapping, callable or SizeField
        As it was given to `generate`.
    gradation : float, optional
        Bound on the growth of the size, which is lowered accordingly along the mesh's edges.
        Default: that of the mesher, or none for a mesh that does not say.
    domain : Pslg, optional
        Where names are looked up; default the mesh's own.

    Returns
    -------
    SizeConformity
        ``.ratio``, ``.share``; printing it shows a histogram.

    Raises
    ------
    InputError
        If the mesh is not plane, or knows no domain and none is given.
    SizeError, NameLookupError
        As of `generate`.

    Examples
    --------
    >>> import csgmesh as cm
    >>> mesh = cm.generate(cm.Box((0, 0), (1, 1)), size=0.05)
    >>> cm.size_conformity(mesh, 0.05).share > 0.99
    True
    """
    if not isinstance(mesh, Mesh) or mesh.dim != 2:
        raise InputError("size_conformity needs a plane Mesh, as generate returns")
    domain = mesh.domain if domain is None else domain
    if domain is None:
        raise InputError(
            "size_conformity: this mesh knows no domain; give domain=csgmesh.evaluate(shape)"
        )
    edges = cell_edges(mesh)[0]
    wanted = pointwise(size, domain)(mesh.points)
    if gradation is None:
        options = mesh.info.get("options")
        gradation = options.get("gradation") if isinstance(options, dict) else None
    if gradation is not None:
        wanted = limit_gradation(mesh.points, edges, wanted, gradation)
    a, b = mesh.points[edges[:, 0]], mesh.points[edges[:, 1]]
    length = np.hypot(*(b - a).T)
    return SizeConformity(
        length / (0.5 * (wanted[edges[:, 0]] + wanted[edges[:, 1]])), edges, wanted
    )

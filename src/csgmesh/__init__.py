"""csgmesh: constructive solid geometry to meshes that a solver can trust.

>>> import csgmesh as cm
>>> plate = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
>>> mesh = cm.generate(plate, size={"hole": 0.05, "default": 0.2})
>>> mesh.names
('plate.left', 'plate.right', 'plate.bottom', 'plate.top', 'hole')
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

#: Where each public name lives. Nothing is imported before it is used.
_HOME = {
    "csgmesh.adaptivity": ("Adaptation", "adapt", "generate_to_budget"),
    "csgmesh.boundary": ("evaluate",),
    "csgmesh.comparison": ("Comparison", "compare"),
    "csgmesh.csg": (
        "Ball",
        "Box",
        "Cone",
        "Cylinder",
        "Disk",
        "Ellipse",
        "Ellipsoid",
        "Embed",
        "EmbeddedPath",
        "EmbeddedPoints",
        "Extrude",
        "FacetedSolid",
        "HalfSpace",
        "Hull",
        "Outline",
        "Periodic",
        "Polygon",
        "Polyhedron",
        "Primitive",
        "Regions",
        "RegularPolygon",
        "Revolve",
        "Shape",
        "Tetrahedron",
        "Torus",
        "Triangle",
        "difference",
        "intersection",
        "symmetric_difference",
        "union",
    ),
    "csgmesh.domain": (
        "Plc",
        "Pslg",
    ),
    "csgmesh.domainfile": ("DomainFile", "load"),
    "csgmesh.errors": (
        "BudgetError",
        "CsgmeshError",
        "DomainFileError",
        "EmptyDomainError",
        "EvaluationError",
        "FileFormatError",
        "InputError",
        "MeshingError",
        "NameLookupError",
        "ShapeError",
        "SizeError",
        "UnboundedDomainError",
    ),
    "csgmesh.improve": ("elevate", "refine", "smooth"),
    "csgmesh.io": (
        "from_meshio",
        "read",
        "read_shape",
        "to_meshio",
        "to_pyvista",
        "to_skfem",
        "to_trimesh",
        "write",
    ),
    "csgmesh.measures": ("Certificate", "Quality", "SizeConformity", "quality", "size_conformity"),
    "csgmesh.mesh": ("Mesh",),
    "csgmesh.meshers": (
        "ConstrainedDelaunay",
        "DelaunayRefinement",
        "Layers",
        "Octree",
        "PerRegion",
        "QuadPairing",
        "Quadtree",
        "Structured",
        "SurfaceRefinement",
        "Sweep",
        "worst_cells",
    ),
    "csgmesh.pipeline": ("check", "generate"),
    "csgmesh.size": (
        "BackgroundSize",
        "CurvatureSize",
        "FeatureSize",
        "HessianSize",
        "NearSize",
        "RegionSize",
        "SizeField",
        "UniformSize",
        "minimum",
    ),
    "csgmesh.triangulation": (
        "Voronoi",
        "delaunay",
        "delaunay_balls",
        "flip_to_delaunay",
        "minimum_spanning_tree",
        "nearest_neighbours",
        "voronoi",
    ),
    "csgmesh.viz": ("draw",),
}

_MODULE_OF = {name: module for module, names in _HOME.items() for name in names}

__all__ = [
    "Adaptation",
    "BackgroundSize",
    "Ball",
    "Box",
    "BudgetError",
    "Certificate",
    "Comparison",
    "Cone",
    "ConstrainedDelaunay",
    "CsgmeshError",
    "CurvatureSize",
    "Cylinder",
    "DelaunayRefinement",
    "Disk",
    "DomainFile",
    "DomainFileError",
    "Ellipse",
    "Ellipsoid",
    "Embed",
    "EmbeddedPath",
    "EmbeddedPoints",
    "EmptyDomainError",
    "EvaluationError",
    "Extrude",
    "FacetedSolid",
    "FeatureSize",
    "FileFormatError",
    "HalfSpace",
    "HessianSize",
    "Hull",
    "InputError",
    "Layers",
    "Mesh",
    "MeshingError",
    "NameLookupError",
    "NearSize",
    "Octree",
    "Outline",
    "PerRegion",
    "Periodic",
    "Plc",
    "Polygon",
    "Polyhedron",
    "Primitive",
    "Pslg",
    "QuadPairing",
    "Quadtree",
    "Quality",
    "RegionSize",
    "Regions",
    "RegularPolygon",
    "Revolve",
    "Shape",
    "ShapeError",
    "SizeConformity",
    "SizeError",
    "SizeField",
    "Structured",
    "SurfaceRefinement",
    "Sweep",
    "Tetrahedron",
    "Torus",
    "Triangle",
    "UnboundedDomainError",
    "UniformSize",
    "Voronoi",
    "adapt",
    "check",
    "compare",
    "delaunay",
    "delaunay_balls",
    "difference",
    "draw",
    "elevate",
    "evaluate",
    "flip_to_delaunay",
    "from_meshio",
    "generate",
    "generate_to_budget",
    "intersection",
    "load",
    "minimum",
    "minimum_spanning_tree",
    "nearest_neighbours",
    "quality",
    "read",
    "read_shape",
    "refine",
    "size_conformity",
    "smooth",
    "symmetric_difference",
    "to_meshio",
    "to_pyvista",
    "to_skfem",
    "to_trimesh",
    "union",
    "voronoi",
    "worst_cells",
    "write",
]

if TYPE_CHECKING:
    from csgmesh.adaptivity import Adaptation, adapt, generate_to_budget
    from csgmesh.boundary import evaluate
    from csgmesh.comparison import Comparison, compare
    from csgmesh.csg import (
        Ball,
        Box,
        Cone,
        Cylinder,
        Disk,
        Ellipse,
        Ellipsoid,
        Embed,
        EmbeddedPath,
        EmbeddedPoints,
        Extrude,
        FacetedSolid,
        HalfSpace,
        Hull,
        Outline,
        Periodic,
        Polygon,
        Polyhedron,
        Primitive,
        Regions,
        RegularPolygon,
        Revolve,
        Shape,
        Tetrahedron,
        Torus,
        Triangle,
        difference,
        intersection,
        symmetric_difference,
        union,
    )
    from csgmesh.domain import (
        Plc,
        Pslg,
    )
    from csgmesh.domainfile import DomainFile, load
    from csgmesh.errors import (
        BudgetError,
        CsgmeshError,
        DomainFileError,
        EmptyDomainError,
        EvaluationError,
        FileFormatError,
        InputError,
        MeshingError,
        NameLookupError,
        ShapeError,
        SizeError,
        UnboundedDomainError,
    )
    from csgmesh.improve import elevate, refine, smooth
    from csgmesh.io import (
        from_meshio,
        read,
        read_shape,
        to_meshio,
        to_pyvista,
        to_skfem,
        to_trimesh,
        write,
    )
    from csgmesh.measures.certificate import Certificate
    from csgmesh.measures.conformity import SizeConformity, size_conformity
    from csgmesh.measures.quality import Quality, quality
    from csgmesh.mesh import Mesh
    from csgmesh.meshers import (
        ConstrainedDelaunay,
        DelaunayRefinement,
        Layers,
        Octree,
        PerRegion,
        QuadPairing,
        Quadtree,
        Structured,
        SurfaceRefinement,
        Sweep,
        worst_cells,
    )
    from csgmesh.pipeline import check, generate
    from csgmesh.size import (
        BackgroundSize,
        CurvatureSize,
        FeatureSize,
        HessianSize,
        NearSize,
        RegionSize,
        SizeField,
        UniformSize,
        minimum,
    )
    from csgmesh.triangulation import (
        Voronoi,
        delaunay,
        delaunay_balls,
        flip_to_delaunay,
        minimum_spanning_tree,
        nearest_neighbours,
        voronoi,
    )
    from csgmesh.viz import draw


def __getattr__(name: str) -> Any:
    module = _MODULE_OF.get(name)
    if module is None:
        raise AttributeError(f"module 'csgmesh' has no attribute {name!r}")
    value = getattr(import_module(module), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def load_ipython_extension(ipython: Any) -> None:
    """Show shapes, domains and meshes as pictures: ``%load_ext csgmesh``."""
    from csgmesh.viz.notebook import register

    register(ipython)


if "IPython" in sys.modules:  # In a notebook things show themselves without being asked.
    from csgmesh.viz.notebook import register_if_active

    register_if_active()

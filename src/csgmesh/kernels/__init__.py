"""Numba kernels: arrays in, arrays out, a status code; the only door to numba.

Importing this package costs nothing. The first use of one of its functions imports numba and
the kernels; the first call ever of a kernel compiles it, once, into a cache on disk.
"""

from __future__ import annotations

import importlib
import sys
import threading
import warnings
from functools import lru_cache
from types import ModuleType
from typing import Any

from .cache import cache_directory, callees, must_compile

__all__ = ["cache_directory", "must_compile"]

#: Exported name -> module that holds it.
_HOME = {
    "insert_points": "delaunay",
    "insertion_order": "ordering",
    "recover_segments": "segments",
    "flood_regions": "segments",
    "block_around_points": "lattice",
    "block_around_segments": "lattice",
    "find_runs": "lattice",
    "number_lattice": "weaving",
    "list_strips": "weaving",
    "find_hole": "weaving",
    "place_lattice": "weaving",
    "weave": "weaving",
    "refine": "refinement",
    "count_outer": "components",
    "join_triangles": "components",
    "mark_used": "export",
    "extract": "export",
    "look_up": "background",
    "limit_gradation": "gradation",
    "expected_points": "gradation",
    "orientations": "checks",
    "in_circles": "checks",
    "Arrays": "improvement",
    "measure": "improvement",
    "pair_half_edges": "improvement",
    "connect_block": "grids.blocks",
    "fill_block": "grids.blocks",
    "pair_along_paths": "grids.pairing",
    "pair_greedily": "grids.pairing",
    "square_up": "grids.squares",
    "smooth_vertices": "improvement",
    "treat_triangles": "improvement",
    "lowest_sources": "sizes.sources",
    "limit_growth": "sizes.gradation",
    "first_met": "sizes.rays",
    "lowest_facets": "sizes.facet_sources",
    "flip_edges": "delaunay_flips.flips",
    "number_edges": "refine_cells.edges",
    "cells_of_edges": "refine_cells.edges",
    "spread_marks": "refine_cells.edges",
    "write_children": "refine_cells.children",
    "halve": "refine_cells.children",
    "corner_sines": "refine_cells.sines",
    "Cells": "star_smoothing.moves",
    "cell_qualities": "star_smoothing.moves",
    "gather_stars": "star_smoothing.moves",
    "move_vertices": "star_smoothing.moves",
    "score_cells": "tet_improvement.pieces",
    "choose_cells": "tet_improvement.pieces",
    "connect_cells": "tet_improvement.pieces",
    "fix_pinched": "tet_improvement.pieces",
    "Piece": "tet_improvement.treatment",
    "treat_cells": "tet_improvement.treatment",
    "wish_moves": "tet_improvement.treatment",
    "grant_wishes": "tet_improvement.treatment",
    "centre_vertices": "tet_improvement.centring",
    "settle_moves": "tet_improvement.centring",
    "SurfaceArrays": "surface.arrays",
    "flip_surface": "surface.flipping",
    "insert_samples": "surface.coarsening",
    "take_vertices": "surface.coarsening",
    "refine_surface": "surface.refining",
    "divide_edges": "surface.refining",
    "surface_feet": "surface.normals",
    "smooth_surface": "surface.smoothing",
    "split_leaves": "tree.leaves",
    "mark_unbalanced": "tree.leaves",
    "places": "tree.leaves",
    "find_leaves": "tree.leaves",
    "adjoining": "tree.leaves",
    "mark_unbalanced_octants": "tree.octants",
    "octant_places": "tree.octants",
    "find_octants": "tree.octants",
    "pair_boxes": "tree.octants",
    "spread_sizes": "tree.octants",
    "sizes_at": "tree.octants",
    "number_corners": "tree.body_centred",
    "largest_leaves": "tree.nearness",
    "mark_near_triangles": "tree.nearness",
    "join_leaves": "tree.body_centred",
    "wind_around": "tree.body_centred",
    "list_lattice": "tree.body_centred",
    "beside": "tree.body_centred",
    "keep_tetrahedra": "tree.body_centred",
    "demand_sizes": "tree.demands",
    "hand_down": "tree.features",
    "mark_features": "tree.features",
    "pair_pieces": "tree.features",
    "mark_vertices": "tree.templates",
    "drop_near": "tree.templates",
    "count_cells": "tree.templates",
    "number_vertices": "tree.templates",
    "write_triangles": "tree.templates",
    "write_quads": "tree.templates",
    "core_edges": "tree.templates",
    "tetra_orientations": "tetrahedra.checks",
    "in_spheres": "tetrahedra.checks",
    "space_order": "tetrahedra.ordering",
    "insert_in_space": "tetrahedra.delaunay",
    "vertex_homes": "tetrahedra.stars",
    "find_faces": "tetrahedra.stars",
    "flood_space": "tetrahedra.regions",
    "tetra_components": "tetrahedra.components",
    "mark_edges": "tetrahedra.recovery",
    "recover_triangles": "tetrahedra.recovery",
    "find_containing": "tetrahedra.locating",
    "fill_buckets": "hexahedra.nearest",
    "nearest_faces": "hexahedra.nearest",
    "least_corners": "hexahedra.nearest",
    "relax": "hexahedra.relaxing",
    "least_determinant": "hexahedra.relaxing",
    "measure_depths": "hexahedra.filling",
    "spread_regions": "hexahedra.filling",
    "clean_cells": "hexahedra.filling",
    "list_sides": "hexahedra.filling",
    "spread_levels": "hexahedra.filling",
    "fill_deep": "hexahedra.filling",
    "mark_unproved": "hexahedra.proving",
    "list_stars": "hexahedra.averaging",
    "average_in_cells": "hexahedra.averaging",
    "average_along": "hexahedra.averaging",
}

#: Loading a module sets numba's cache directory for a while, which all threads share.
_LOADING = threading.RLock()


def _load(name: str) -> ModuleType:
    """Import a kernel module, each of its callees first, into the directory of its own sources."""
    if f"{__name__}.{name}" in sys.modules:
        return sys.modules[f"{__name__}.{name}"]
    for callee in callees(name):
        _load(callee)
    settings: Any = _numba().config
    kept = settings.CACHE_DIR
    try:
        directory = cache_directory(name)
        directory.mkdir(parents=True, exist_ok=True)
        settings.CACHE_DIR = str(directory)
        return importlib.import_module(f".{name}", __name__)
    except (OSError, RuntimeError) as error:
        warnings.warn(
            f"compiled kernels cannot be kept, so each process compiles them anew: {error}",
            RuntimeWarning,
            stacklevel=3,
        )
        pointers = importlib.import_module(".pointers", __name__)
        pointers.ENTRY["cache"] = False
        return importlib.import_module(f".{name}", __name__)
    finally:
        settings.CACHE_DIR = kept


@lru_cache
def _numba() -> ModuleType:
    """numba, imported without scipy.linalg, which no kernel needs and which takes 0.1 s.

    As numba is imported it asks whether scipy has a BLAS. It asks again whenever it compiles
    something that calls one, so that the answer may wait.
    """
    import numba

    try:
        linalg: Any = importlib.import_module("numba.np.linalg")
        ask = linalg.ensure_blas
        linalg.ensure_blas = lambda: None
        try:
            arraymath: Any = importlib.import_module("numba.np.arraymath")
            arraymath.ensure_blas = ask
        finally:
            linalg.ensure_blas = ask
    except (ImportError, AttributeError):  # Another version of numba, which asks elsewhere.
        pass
    return numba


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    with _LOADING:
        value = getattr(_load(_HOME[name]), name)
    globals()[name] = value
    return value

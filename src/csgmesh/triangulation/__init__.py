"""Delaunay triangulations of points, their Voronoi duals and their subgraphs, as functions."""

from csgmesh.triangulation.diagrams import Voronoi, voronoi
from csgmesh.triangulation.flips import flip_to_delaunay
from csgmesh.triangulation.graphs import minimum_spanning_tree, nearest_neighbours
from csgmesh.triangulation.hulls import delaunay
from csgmesh.triangulation.points import delaunay_balls

__all__ = [
    "Voronoi",
    "delaunay",
    "delaunay_balls",
    "flip_to_delaunay",
    "minimum_spanning_tree",
    "nearest_neighbours",
    "voronoi",
]

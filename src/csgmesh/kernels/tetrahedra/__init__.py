"""Tetrahedra: predicates of space, Delaunay insertion, flips, regions."""

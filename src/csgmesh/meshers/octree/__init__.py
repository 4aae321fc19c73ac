"""Cells of solids from an octree: sizes, lattice and mesher."""

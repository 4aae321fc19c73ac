"""Kernels of grid-based hexahedral meshing."""

"""Kernels that turn edges until a triangulation is Delaunay."""

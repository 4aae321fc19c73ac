"""Kernels of structured grids and of quads made of triangles."""

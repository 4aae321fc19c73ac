"""Kernels that move vertices of triangles and quads to better places of their stars."""

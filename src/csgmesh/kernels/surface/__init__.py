"""Kernels that mesh surfaces in space: exact surfaces, flips, splits, collapses, smoothing."""

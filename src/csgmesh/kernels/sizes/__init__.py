"""Kernels of size fields: graded sources, and the gradation on any graph."""

"""Kernels that divide cells: edges numbered, marks spread, children written."""

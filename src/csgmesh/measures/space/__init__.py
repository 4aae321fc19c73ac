"""Measures of cells in space, and the rules that a mesh of space is checked against."""

"""Colours: pale ones for regions, strong ones for boundaries, endless but never equal by chance."""

from __future__ import annotations

import colorsys

_REGIONS = (
    *("#d7e5f2", "#fbe2c4", "#d9edd4", "#ecdcf0", "#f6d9d9", "#d3eeee"),
    *("#f1eec6", "#e2e2e2", "#fadcec", "#e6dccd"),
)
_BOUNDARIES = (
    *("#1f4e9c", "#d1373f", "#1f9d55", "#e58900", "#7b3fa0", "#008b94"),
    *("#a0522d", "#d6369f", "#7a8500", "#4b5563"),
)
#: Turns the hue by the golden ratio, which spreads any number of colours evenly.
_GOLDEN = 0.618033988749895

EDGE = "#33415c"
UNNAMED = "#1b2230"


def region_color(i: int) -> str:
    """Pale colour of region `i`."""
    return _REGIONS[i] if i < len(_REGIONS) else _spread(i, 0.90, 0.45)


def boundary_color(i: int) -> str:
    """Strong colour of the i-th boundary."""
    return _BOUNDARIES[i] if i < len(_BOUNDARIES) else _spread(i, 0.42, 0.70)


def _spread(i: int, lightness: float, saturation: float) -> str:
    r, g, b = colorsys.hls_to_rgb((i * _GOLDEN) % 1.0, lightness, saturation)
    return f"#{round(255 * r):02x}{round(255 * g):02x}{round(255 * b):02x}"

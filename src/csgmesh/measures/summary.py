"""What measures of many cells come to: extremes, tables and histograms as text."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

_BAR = 40


def histogram(values: np.ndarray, lo: float, hi: float, n_bins: int) -> list[str]:
    """Bars of the bins that hold anything and of all between them."""
    values = np.clip(values[~np.isnan(values)], lo, hi)
    count, edges = np.histogram(values, n_bins, (lo, hi))
    used = np.flatnonzero(count)
    width = max(len(f"{n:,}") for n in count)
    edge = "{:.3g}".format
    ends = max(len(edge(e)) for e in edges)
    return [
        f"  {edge(edges[i]):>{ends}} to {edge(edges[i + 1]):<{ends}}  {count[i]:>{width + 1},}  "
        + "#" * round(_BAR * count[i] / count.max())
        for i in range(used[0], used[-1] + 1)
    ]


def extremes(measures: Mapping[str, np.ndarray]) -> dict[str, tuple[float, float]]:
    """Smallest and largest value of each measure; those that no cell has are left out.

    Examples
    --------
    >>> extremes({"angle": np.array([60.0, 45.0]), "sicn": np.array([np.nan, np.nan])})
    {'angle': (45.0, 60.0)}
    """
    found = {}
    for name, values in measures.items():
        known = values[~np.isnan(values)]
        if len(known):
            found[name] = float(known.min()), float(known.max())
    return found


def table(labels: Mapping[str, str], measures: Mapping[str, np.ndarray]) -> list[str]:
    """A row a measure: smallest, mean, largest."""
    width = max(map(len, labels.values())) + 2
    rows = [f"{'':<{width}}{'smallest':>12}{'mean':>12}{'largest':>12}"]
    for name, (low, high) in extremes(measures).items():
        mean = float(np.nanmean(measures[name]))
        rows.append(f"{labels[name]:<{width}}{low:>12.5g}{mean:>12.5g}{high:>12.5g}")
    return rows


def headline(n_points: int, n_by_kind: Mapping[str, int]) -> str:
    """Counts of points and cells.

    Examples
    --------
    >>> headline(4, {"triangle": 2})
    '4 points, 2 cells (2 triangle)'
    """
    kinds = ", ".join(f"{n:,} {kind}" for kind, n in n_by_kind.items())
    return f"{n_points:,} points, {sum(n_by_kind.values()):,} cells ({kinds or 'none'})"

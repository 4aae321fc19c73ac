"""Histograms as text."""

from __future__ import annotations

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

"""Which cells to refine."""

from __future__ import annotations

import numpy as np


def doerfler(errors: np.ndarray, share: float) -> np.ndarray:
    """Mark the fewest cells that have a share of the squared error together.

    Parameters
    ----------
    errors : (n_cells,) float64
        Error that each cell contributes; none negative.
    share : float
        In (0, 1]; few cells a step for small ones, which takes more steps.

    Returns
    -------
    (n_cells,) bool
        Equal errors are marked in the order of the cells.

    References
    ----------
    .. [1] W. Dörfler, "A convergent adaptive algorithm for Poisson's equation", SIAM J. Numerical
       Analysis 33 (1996).

    Examples
    --------
    >>> doerfler(np.array([3.0, 1.0, 4.0, 0.0]), 0.9)
    array([ True, False,  True, False])
    """
    squared = errors**2
    order = np.argsort(-squared, kind="stable")
    reached = np.cumsum(squared[order])
    marked = np.zeros(len(errors), bool)
    if len(errors) and reached[-1] > 0:
        n = int(np.searchsorted(reached, share * reached[-1], side="left")) + 1
        marked[order[:n]] = True
    return marked & (squared > 0)

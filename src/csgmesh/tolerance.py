"""Every tolerance of csgmesh, named once, with its reason."""

from __future__ import annotations

import numpy as np

#: Points closer than this share of the domain's diagonal merge. Real outlines carry vertex pairs
#: 1e-16 to 1e-13 apart that nobody meant; 1e-10 clears those and stays far below any feature
#: that double-precision input can mean on purpose.
SNAP_SHARE = 1e-10

#: Largest distance of a facet from its exact curve, as a share of the extent of the curve's leaf.
DEVIATION_SHARE = 1e-3

#: What is promised of a vertex on its exact curve, as a share of the diagonal.
ON_CURVE_SHARE = 1e-12

#: Rounding of coordinates: no promise of accuracy can be finer than a few ulp of the largest one.
ULPS = 4.0

#: Cells at an input angle below this many degrees are excused from an angle bound: no mesher can
#: do better at the apex of a sharp angle, and 60 degrees is where Ruppert's proof begins to fail.
EXCUSED_ANGLE = 60.0

#: Agreement of the mesh's covered area with the area of its PSLG: both are sums of the same
#: coordinates, so only rounding separates them.
AREA_SHARE = 1e-12

#: Agreement of a length or area with the value that a test expects: people copy expected values
#: from prints of about ten digits.
EXPECTED_SHARE = 1e-9


#: Largest magnitude of a coordinate or size. Predicates multiply up to three differences of
#: coordinates; beyond this their products leave the range of double precision.
LARGEST = 1e100

#: Smallest size (radius, semi-axis, side): its square must not underflow.
SMALLEST = 1e-100


def coordinate_ulp(*arrays: np.ndarray) -> float:
    """`ULPS` units in the last place of the largest coordinate.

    Examples
    --------
    >>> coordinate_ulp(np.array([1e9])) > 4e-7
    True
    """
    largest = max((float(np.abs(a).max()) for a in arrays if a.size), default=0.0)
    return ULPS * float(np.spacing(largest))


def accuracy(share: float, diagonal: float, *arrays: np.ndarray) -> float:
    """What can be promised: `share` of the diagonal, or the coordinates' rounding if larger."""
    return max(share * diagonal, coordinate_ulp(*arrays))

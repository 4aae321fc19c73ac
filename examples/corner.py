"""An L-shape, finer toward its re-entrant corner: a size as a function of place."""

import numpy as np

import csgmesh as cm

ell = cm.Box((-1, -1), (1, 1), name="ell") - cm.Box((0, -1), (1, 0), name="notch")


def size(points):
    """Edges as long as a tenth of the distance to the corner, within bounds."""
    return np.clip(0.25 * np.hypot(points[:, 0], points[:, 1]), 0.002, 0.15)


mesh = cm.generate(ell, size=size)
print(mesh)
print(cm.quality(mesh))
assert cm.check(mesh, ell).ok
cm.draw(mesh, "corner.png")

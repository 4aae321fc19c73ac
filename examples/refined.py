"""A corner refined where the solution is rough, then curved: cells of order 3, exact boundary."""

import numpy as np

import csgmesh as cm

shape = cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")
mesh = cm.generate(shape, size=0.6, deviation=0.05)  # coarse chords: cells will be curved

for radius in (0.6, 0.4, 0.25):
    centres = mesh.points[mesh.cells["triangle"]].mean(axis=1)
    mesh = cm.refine(mesh, np.hypot(*(centres - [1.65, 1.35]).T) < radius)

curved = cm.elevate(mesh, 3)
certificate = cm.check(curved, shape)
assert certificate.ok, certificate
print(f"{curved.n_cells} cells, smallest angle {cm.quality(mesh).min_angle.min():.1f} degrees")
print(f"area off by {abs(cm.quality(curved).total_area - (8 - np.pi / 4)):.0e}")
cm.draw(curved, "refined.png")

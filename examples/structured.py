"""A grid in blocks around a hole, fine towards the hole; and what i and j are good for."""

import numpy as np

import csgmesh as cm

plate = cm.Box((0, 0), (2, 1), name="plate") - cm.Disk((0.5, 0.5), 0.2, name="hole")

mesher = cm.Structured(counts={"hole": 48})
mesh = cm.generate(plate, mesher, size={"hole": 0.01, "default": 0.06})
assert cm.check(mesh, plate).ok
print(mesh)
for name, block in mesh.blocks.items():
    ni, nj = block.cells.shape
    print(f"{name}: {ni} x {nj} cells")

# Finite differences along the rows and columns of a ring: one block that closes on itself.
ring = cm.Disk((0, 0), 2) - cm.Disk((0, 0), 1)
grid = cm.generate(ring, cm.Structured(counts={"disk": 64}), size=0.05)
points = grid.blocks["domain"].points
r = np.hypot(*grid.points[points].T).T
u = np.log(r)
dr = r[1, 0] - r[0, 0]
slope = (u[2:] - u[:-2]) / (2 * dr)
print(f"d(log r)/dr = 1/r, off by {abs(slope * r[1:-1] - 1).max():.1e} at most")
cm.draw(mesh, "structured.png")

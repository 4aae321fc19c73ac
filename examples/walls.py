"""Boundary layers for a flow around a cylinder in a channel, and triangles for the rest."""

import numpy as np

import csgmesh as cm

channel = cm.Box((0, 0), (2.2, 0.41), name="channel")
shape = channel - cm.Disk((0.2, 0.2), 0.05, name="cylinder")

wall = cm.Layers(first=5e-4, growth=1.3, n=8)
layers = {"cylinder": wall, "channel.bottom": wall, "channel.top": wall}
mesh = cm.generate(
    shape,
    cm.DelaunayRefinement(layers=layers),
    size={"cylinder": 0.01, "default": 0.04},
)
assert cm.check(mesh, shape).ok

# Points straight above the cylinder: the layers, as high as was asked for.
x, y = (mesh.points - (0.2, 0.2)).T
height = np.sort(np.hypot(x, y)[np.hypot(x, y) < 0.05 + 1.001 * wall.heights()[-1]] - 0.05)
print(mesh)
print(f"{wall.n} layers, {wall.heights()[-1]:.4f} high together; found up to {height[-1]:.4f}")
cm.write("walls.msh", mesh)
cm.draw(mesh, "walls.png")

"""Sizes by name: fine along a crack in a dome, coarse where nothing happens."""

import numpy as np

import csgmesh as cm

dome = cm.Ellipse((0, 0), (3, 2), name="dome") & cm.HalfSpace((0, 0), (0, -1), name="ground")
cracked = cm.Embed(dome, [cm.EmbeddedPath([(-1, 0.6), (0, 0.9), (0.4, 0.7)], name="crack")])
mesh = cm.generate(cracked, size={"crack": 0.01, "ground": 0.1, "default": 3.0})

print(mesh)
for name in ("crack", "ground", "dome"):
    a, b = mesh.points[mesh.facets["line"][mesh.boundary(name)["line"]]].swapaxes(0, 1)
    length = np.hypot(*(b - a).T)
    print(f"{name}: {len(length)} edges of {length.min():.3g} to {length.max():.3g}")
assert cm.check(mesh, cracked).ok
cm.draw(mesh, "graded.png")

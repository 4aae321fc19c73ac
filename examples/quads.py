"""Quads only: a bracket of two materials, and how square its cells are."""

import csgmesh as cm

body = cm.Box((0, 0), (3, 2), name="body") - cm.Disk((0.9, 1), 0.5, name="bore")
insert = cm.Ellipse((2.1, 1), (0.5, 0.35), angle=30, name="bond")
part = cm.Regions({"steel": body, "rubber": insert})

mesh = cm.generate(part, cm.QuadPairing(), size=0.06)
assert cm.check(mesh, part).ok
assert list(mesh.cells) == ["quad"]

quality = cm.quality(mesh)
print(mesh)
print(f"SICN from {quality.sicn.min():.2f}, {quality.sicn.mean():.3f} on average")
cm.draw(mesh, "quads.png")

"""One domain from one quadtree: as triangles, as quads and triangles, and as quads alone."""

from matplotlib.figure import Figure

import csgmesh as cm

plate = cm.Box((0, 0), (1, 1), name="plate") - cm.Disk((0.3, 0.3), 0.15, name="hole")
shape = plate - cm.Disk((0.7, 0.65), 0.2, name="vent")

figure = Figure(figsize=(12, 4.4), layout="constrained")
for axes, cells in zip(figure.subplots(1, 3), ("triangle", "mixed", "quad"), strict=True):
    mesh = cm.generate(shape, cm.Quadtree(cells=cells), size={"hole": 0.03, "default": 0.06})
    assert cm.check(mesh, shape).ok
    quality = cm.quality(mesh)
    kinds = " and ".join(f"{len(rows)} {kind}s" for kind, rows in mesh.cells.items())
    print(f"{cells}: {kinds}, smallest angle {quality.min_angle.min():.1f}°")
    cm.draw(mesh, ax=axes, legend=False, title=kinds)
figure.savefig("quadtree.png", dpi=110)

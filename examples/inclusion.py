"""Two materials: a round inclusion in a matrix, with a name for the interface between them."""

import numpy as np

import csgmesh as cm

block = cm.Box((-1, -1), (1, 1), name="block")
grain = cm.Disk((0.1, 0), 0.55, name="bond")  # the name of its boundary: the interface
material = cm.Regions({"matrix": block, "grain": grain})

mesh = cm.generate(material, size={"bond": 0.03, "grain": 0.08, "default": 0.15})

facets = mesh.facets["line"][mesh.interface("matrix", "grain")["line"]]
length = np.linalg.norm(np.diff(mesh.points[facets], axis=1), axis=2).sum()
print(mesh)
print(f"interface: {length:.4f} in chords, {2 * np.pi * 0.55:.4f} exactly")
for name in mesh.region_names:
    print(f"{name}: {len(mesh.region(name)['triangle'])} triangles")

assert cm.check(mesh, material).ok
cm.write("inclusion.msh", mesh)
cm.draw(mesh, "inclusion.png")

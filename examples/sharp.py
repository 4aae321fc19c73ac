"""A blade with edges of 5 and 12 degrees: where angles are small, and why."""

import csgmesh as cm
from csgmesh.meshers import worst_cells

blade = cm.Polygon([(0, 0), (3, -0.15), (4, -0.3), (3, 0.45), (2, 0.2)], name="blade")
blade -= cm.Disk((3, 0.1), 0.12, name="bolt")
mesh = cm.generate(blade, size={"bolt": 0.03, "default": 0.12})

for cell in worst_cells(mesh, count=3):
    x, y = cell["place"]
    print(f"{cell['angle']:.1f} degrees at ({x:.3f}, {y:.3f}): {cell['reason']}")
print(cm.check(mesh, blade)["smallest angle"])
cm.draw(mesh, "sharp.png", color="min_angle")

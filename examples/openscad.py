"""A clamp from OpenSCAD, as it exports it (openscad -o clamp.csg clamp.scad), with exact bores."""

from pathlib import Path

import csgmesh as cm

clamp = cm.read_shape(Path(__file__).with_name("clamp.csg"), name="clamp")
domain = cm.evaluate(clamp)
print(domain)
print("volume:", round(float(domain.volumes()[0]), 1))
print("bore:", round(domain.area("clamp.cylinder.3.side"), 1))
cm.draw(domain, "openscad.png", view=(-60, 35))

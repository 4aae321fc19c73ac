"""Letters as a domain: the outlines of a font are Bézier curves, and stay so."""

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

import csgmesh as cm

path = TextPath((0, 0), "csgmesh", size=10, prop=FontProperties(family="STIXGeneral"))
word = cm.Outline.from_path(path.vertices, path.codes, name="ink")
low, high = word.bounds()
page = cm.Box(low - 1, high + 1, name="page")
print_shop = cm.Regions({"paper": page, "letters": word})

mesh = cm.generate(print_shop, size={"ink": 0.4, "default": 1.5})
print(mesh)
print(cm.check(mesh, print_shop))
cm.write("glyphs.vtu", mesh)
cm.draw(mesh, "glyphs.png")

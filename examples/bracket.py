"""A flanged bracket from half-spaces, polygons and disks, with sizes by name."""

import csgmesh as cm

flange = cm.intersection(
    [
        cm.HalfSpace((0, 0), (-1, 0), name="wall"),
        cm.HalfSpace((12, 0), (1, 0), name="face"),
        cm.HalfSpace((0, 0), (0, -1), name="foot"),
        cm.HalfSpace((0, 100), (0, 1), name="head"),
    ]
)
web = cm.Polygon([(6, 15), (100, 30), (100, 70), (6, 85)], name="web")
boss = cm.Disk((100, 50), 26, name="boss")
bore = cm.Disk((100, 50), 14, name="bore")

# A slot: its round ends are tangent to its straight sides.
slot = cm.Box((30, 40), (52, 60)) | cm.Disk((30, 50), 10) | cm.Disk((52, 50), 10)

bracket = (flange | web | boss) - bore - slot.named("slot")
mesh = cm.generate(bracket, size={"bore": 1.5, "slot": 2, "default": 5})

print(mesh)
print(cm.check(mesh, bracket))
cm.write("bracket.vtu", mesh)
cm.draw(mesh, "bracket.png")

"""A pulley: a profile revolved into wedges, a drum extruded into hexahedra, loads by name."""

import csgmesh as cm

groove = cm.Disk((3.0, 0.5), 0.4, name="groove")
profile = cm.Box((0.5, 0), (2.8, 1), name="rim") - groove
pulley = cm.Revolve(profile, name="pulley")

mesh = cm.generate(pulley, cm.Sweep(), size=0.2)
print(mesh)
print(cm.check(mesh, pulley))
print("seat of the rope:", len(mesh.boundary_points("pulley.side.groove")), "points")

drum = cm.Extrude(cm.Box((0, 0), (2, 1), name="wall"), 3, name="drum")
hexahedra = cm.generate(drum, cm.Sweep(cm.Structured()), size=0.25)
print(cm.quality(hexahedra))

cm.write("pulley.msh", mesh)
cm.draw(mesh, "pulley.png", cut=((0, 0, 0), (0, -1, 0)), view=(-60, 30))

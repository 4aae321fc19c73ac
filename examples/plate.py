"""A plate with three holes, from an expression to a file that Gmsh and ParaView read."""

import csgmesh as cm

plate = cm.Box((0, 0), (4, 2), name="plate")
holes = [cm.Disk((x, 1), 0.35, name="hole") for x in (0.8, 2.0, 3.2)]
shape = cm.difference(plate, *holes)

mesh = cm.generate(shape, cm.DelaunayRefinement(min_angle=30), size={"hole": 0.05, "default": 0.2})

print(mesh)
print(cm.check(mesh, shape))
print(cm.quality(mesh))

cm.write("plate.msh", mesh)
cm.draw(mesh, "plate.png")

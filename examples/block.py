"""A block with a cavity and a bore: tetrahedra, hexahedra and both of the same solid."""

import csgmesh as cm

block = cm.Box((0, 0, 0), (2, 1, 1), name="block")
ball = cm.Ball((0.6, 0.5, 0.5), 0.3, name="cavity")
bore = cm.Cylinder((1.4, 0.5, -0.1), (1.4, 0.5, 1.1), 0.25, name="bore")
shape = block - ball - bore
size = {"bore": 0.05, "default": 0.12}

tetrahedra = cm.generate(shape, cm.Octree(), size=size)
assert cm.check(tetrahedra, shape).ok
print(tetrahedra)
print("smallest dihedral angle", round(float(cm.quality(tetrahedra).min_dihedral.min()), 1))

hexahedra = cm.generate(shape, cm.Octree(cells="hexahedron"), size=0.1)
assert cm.check(hexahedra, shape).ok
print(hexahedra)
print("smallest scaled Jacobian", round(float(cm.quality(hexahedra).scaled_jacobian.min()), 2))

mixed = cm.generate(shape, cm.Octree(cells="mixed"), size=0.06)
assert cm.check(mixed, shape).ok
print(mixed)

cm.write("block.msh", tetrahedra)
half = ((1, 0.5, 0.5), (0, -1, 0))
cm.draw(tetrahedra, "block.png", cut=half)
cm.draw(hexahedra, "block_hexahedra.png", cut=half)
cm.draw(mixed, "block_mixed.png", cut=half)

"""Better angles: the same plate by default, and with vertices moved and edges turned."""

import matplotlib.pyplot as plt

import csgmesh as cm

plate = cm.Box((0, 0), (1, 1), name="plate")
for x, y, r in ((0.3, 0.3, 0.15), (0.7, 0.4, 0.1), (0.4, 0.75, 0.12)):
    plate -= cm.Disk((x, y), r, name="hole")

figure, axes = plt.subplots(1, 2, figsize=(12, 5.5))
for ax, improve in zip(axes, (False, True), strict=True):
    mesher = cm.DelaunayRefinement(improve=improve)
    # Chords about as long as the size: shorter ones would leave the angles beside them no choice.
    mesh = cm.generate(plate, mesher, size=0.04, deviation=0.002)
    worst = cm.quality(mesh).min_angle.min()
    print(f"improve={improve}: smallest angle {worst:.1f} degrees, {mesh.n_cells} triangles")
    assert cm.check(mesh, plate).ok
    title = f"improve={improve}: smallest angle {worst:.1f}°"
    cm.draw(mesh, ax=ax, color="min_angle", legend=False, title=title)
figure.savefig("improved.png", dpi=110, bbox_inches="tight")

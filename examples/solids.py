"""Seven solids that hold a mesher to its word: `ALL` has their functions by name.

Lengths are millimetres or units; every part of a boundary that loads or sizes may want has a name.
"""

from collections.abc import Callable
from math import cos, pi, radians, sin

import matplotlib.pyplot as plt
import numpy as np

import csgmesh as cm


def bracket() -> cm.Shape:
    """An angle bracket: a plate with two bores, a wall with one, a rib between them."""
    plate = cm.Box((0, 0, 0), (60, 40, 8), name="plate")
    wall = cm.Box((0, 0, 0), (8, 40, 50), name="wall")
    profile = cm.Polygon([(8, 8), (32, 8), (8, 30)], name="slope")
    # Extruded along z, then stood up: its y becomes z, its z becomes −y.
    rib = cm.Extrude(profile, 6, name="rib").rotate(90, axis=(1, 0, 0)).translate((0, 23, 0))
    bores = [cm.Cylinder((48, y, -1), (48, y, 9), 4, name="bore") for y in (10, 30)]
    eye = cm.Cylinder((-1, 20, 40), (9, 20, 40), 5, name="eye")
    return cm.difference(plate | wall | rib, *bores, eye)


def pipe_tee() -> cm.Shape:
    """Two pipes that meet at a right angle, open at three ends."""
    run = cm.Cylinder((-3, 0, 0), (3, 0, 0), 1, name="run")
    branch = cm.Cylinder((0, 0, 0), (0, 0, 2.5), 0.8, name="branch")
    bore = cm.Cylinder((-4, 0, 0), (4, 0, 0), 0.8, name="bore")
    inlet = cm.Cylinder((0, 0, 0), (0, 0, 3), 0.6, name="inlet")
    return (run | branch) - bore - inlet


def ball_in_box() -> cm.Regions:
    """A hard ball in a soft box: two materials that share their interface."""
    box = cm.Box((0, 0, 0), (2, 2, 2), name="box")
    return cm.Regions({"soft": box, "hard": cm.Ball((1, 1, 1), 0.6, name="ball")})


def gear(teeth: int = 12) -> cm.Shape:
    """A spur gear with trapezoid teeth and a keyed bore, extruded."""
    step = 2 * pi / teeth
    angles = [(k + f) * step for k in range(teeth) for f in (-0.27, -0.13, 0.13, 0.27)]
    radii = [(10.0, 12.0, 12.0, 10.0)[k % 4] for k in range(4 * teeth)]
    rim = [(r * cos(t), r * sin(t)) for r, t in zip(radii, angles, strict=True)]
    wheel = cm.Polygon(rim, name="flank")
    bore = cm.Disk((0, 0), 3, name="bore") | cm.Box((-0.8, 0), (0.8, 4), name="key")
    return cm.Extrude(wheel - bore, 4, name="gear")


def bowl() -> cm.Shape:
    """A bowl: a thick half of a spherical shell on a foot, revolved."""
    shell = cm.Disk((0, 5), 5, name="outside") - cm.Disk((0, 5), 4.4, name="inside")
    half = shell & cm.HalfSpace((0, 5), (0, 1), name="brim")
    foot = cm.Box((1.4, -0.4), (2.2, 0.8), name="foot") - cm.Disk((0, 5), 4.7)
    return cm.Revolve(half | foot, name="bowl")


def chess_piece() -> cm.Shape:
    """A pawn: base, waist, collar and head on one profile, revolved."""
    waist = ("cubic", (0.55, 1.3), (0.5, 1.8), (0.42, 2.35))
    neck = (0.65 * cos(radians(-50)), 3.1 + 0.65 * sin(radians(-50)))
    collar = ("arc", (0.85, 2.5), neck)
    head = ("arc", (0.65, 3.1), (0, 3.75))
    foot = [(0, 0), (1.15, 0), ("arc", (1.3, 0.2), (1.15, 0.4)), (0.85, 0.6)]
    profile = cm.Outline([[*foot, waist, collar, head]], name="turned")
    return cm.Revolve(profile, name="pawn")


def crowd(seed: int = 6, n: int = 200) -> cm.Shape:
    """A union of random balls and turned boxes, most of which overlap."""
    rng = np.random.default_rng(seed)
    leaves: list[cm.Shape] = []
    for centre, size, axis in zip(
        rng.uniform(0, 10, (n, 3)), rng.uniform(0.6, 1.4, n), rng.normal(size=(n, 3)), strict=True
    ):
        if len(leaves) % 2:
            box = cm.Box(centre - 0.8 * size, centre + 0.8 * size, name="box")
            leaves.append(box.rotate(rng.uniform(0, 360), center=centre, axis=axis))
        else:
            leaves.append(cm.Ball(centre, size, name="ball"))
    return cm.union(leaves)


ALL: dict[str, Callable[[], cm.Shape | cm.Regions]] = {
    "bracket": bracket,
    "pipe_tee": pipe_tee,
    "ball_in_box": ball_in_box,
    "gear": gear,
    "bowl": bowl,
    "chess_piece": chess_piece,
    "crowd": crowd,
}

if __name__ == "__main__":
    figure, axes = plt.subplots(2, 4, figsize=(13, 6.5), layout="constrained")
    for ax, (name, solid) in zip(axes.flat, ALL.items(), strict=False):
        domain = cm.evaluate(solid(), deviation=0.05 if name == "crowd" else None)
        print(name, domain)
        cm.draw(domain, ax=ax, legend=False, title=name.replace("_", " "))
    axes.flat[-1].set_axis_off()
    figure.savefig("solids.png", dpi=110)

"""Hand-made domains, and the invariants that every mesh of them must have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from csgmesh import kernels
from csgmesh.domain import Curves, Pslg
from csgmesh.domain.input_angles import input_angles
from csgmesh.mesh import Mesh

Loop = Sequence[tuple[float, float]]


def loops(*contours: Loop, scale: float = 1.0, offset: float = 0.0) -> Pslg:
    """Domain of closed contours; one inside another bounds a hole."""
    points: list[tuple[float, float]] = []
    segments: list[tuple[int, int]] = []
    for contour in contours:
        first, n = len(points), len(contour)
        points += [(offset + scale * x, offset + scale * y) for x, y in contour]
        segments += [(first + i, first + (i + 1) % n) for i in range(n)]
    return Pslg(points, segments)


def square(side: float = 1.0) -> Pslg:
    return loops([(0, 0), (side, 0), (side, side), (0, side)])


def polar(radii: np.ndarray) -> Loop:
    t = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    return list(zip(radii * np.cos(t), radii * np.sin(t), strict=True))


def star(spikes: int, inner: float = 0.1) -> Pslg:
    return loops(polar(np.where(np.arange(2 * spikes) % 2, inner, 1.0)))


def wedge(degrees: float, ratio: float = 1.0) -> Pslg:
    t = np.radians(degrees)
    return loops([(0, 0), (1, 0), (ratio * np.cos(t), ratio * np.sin(t))])


def koch(level: int) -> Pslg:
    p = np.array([0, 1, np.exp(1j * np.pi / 3)])[::-1]
    for _ in range(level):
        d = (np.roll(p, -1) - p) / 3
        p = np.stack([p, p + d, p + d + d * np.exp(1j * np.pi / 3), p + 2 * d], 1).ravel()
    return loops(list(zip(p.real, p.imag, strict=True)))


def comb(teeth: int) -> Pslg:
    top = [
        q
        for k in range(teeth)[::-1]
        for q in ((k + 0.95, 5.0), (k + 0.5, 5.0), (k + 0.5, 0.5), (k + 0.0, 5.0))
    ]
    return loops([(0, 0), (teeth - 0.05, 0), *top])


def disks(
    circles: Sequence[tuple[float, float, float, int, int]],
    n: int = 16,
    box: tuple[float, float, float, float] | None = None,
) -> Pslg:
    """Circles (x, y, radius, region inside, region outside) of n chords, in a box of region 0."""
    points, segments, curve, interval, marker, sides, arcs = [], [], [], [], [], [], []
    for i, (x, y, r, inside, outside) in enumerate(circles):
        first = len(points)
        t = np.linspace(0, 2 * np.pi, n + 1)
        points += [(x + r * np.cos(s), y + r * np.sin(s)) for s in t[:-1]]
        segments += [(first + k, first + (k + 1) % n) for k in range(n)]
        curve += [i] * n
        interval += [(t[k], t[k + 1]) for k in range(n)]
        marker += [i] * n
        sides += [(inside, outside)] * n
        arcs.append(
            Curves.arcs(
                np.array([[x, y]]),
                np.array([[r, 0.0]]),
                np.array([[0.0, r]]),
                np.array([0.0]),
                np.array([2 * np.pi]),
            )
        )
    names = [(f"disk{i}",) for i in range(len(circles))]
    if box is not None:
        first = len(points)
        points += [(box[0], box[1]), (box[2], box[1]), (box[2], box[3]), (box[0], box[3])]
        segments += [(first + k, first + (k + 1) % 4) for k in range(4)]
        curve += [-1] * 4
        interval += [(0.0, 1.0)] * 4
        marker += [len(circles)] * 4
        sides += [(0, -1)] * 4
        names.append(("box",))
    return Pslg.build(
        points=points,
        segments=segments,
        segment_curve=curve,
        segment_interval=interval,
        segment_marker=marker,
        segment_region=sides,
        boundary_names=tuple(names),
        region_names=("matrix", "core"),
        curves=Curves.concatenate(arcs),
    )


def smallest_angles(mesh: Mesh) -> np.ndarray:
    """Smallest angle of each triangle, in degrees."""
    corner = mesh.points[mesh.cells["triangle"]]
    angles = []
    for i in range(3):
        u = corner[:, (i + 1) % 3] - corner[:, i]
        v = corner[:, (i + 2) % 3] - corner[:, i]
        angles.append(np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(1)))
    return np.degrees(np.min(angles, axis=0))


def excused(mesh: Mesh, domain: Pslg) -> np.ndarray:
    """Which cells touch an apex of a small input angle or its protected shell."""
    near = np.zeros(mesh.n_points, bool)
    for apex, _, radius in zip(*input_angles(domain), strict=True):
        near |= np.hypot(*(mesh.points - apex).T) <= radius * (1 + 1e-3)
    return near[mesh.cells["triangle"]].any(axis=1)


def edge_lengths(mesh: Mesh) -> np.ndarray:
    cells = mesh.cells["triangle"]
    edges = np.unique(np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1), axis=0)  # fmt: skip  # noqa: E501
    return np.hypot(*(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]).T)


def assert_sound(mesh: Mesh, domain: Pslg) -> None:
    """Positive cells, conforming, bounded by the facets, regions filled, no unused point."""
    cells, facets = mesh.cells["triangle"], mesh.facets["line"]
    assert (kernels.orientations(mesh.points, cells) == 1).all()
    edges = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    edges, counts = np.unique(edges, axis=0, return_counts=True)
    assert counts.max() <= 2
    sides = mesh.facet_region["line"]
    outer = np.unique(np.sort(facets[(sides < 0).any(axis=1)], axis=1), axis=0)
    assert np.array_equal(outer, edges[counts == 1])
    assert len(np.unique(cells)) == mesh.n_points
    assert len(np.unique(mesh.points, axis=0)) == mesh.n_points
    centre = mesh.points.mean(axis=0)
    for region in range(len(domain.region_names)):
        a, b = (mesh.points[facets[:, k]] - centre for k in (0, 1))
        terms = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        bounded = terms[sides[:, 0] == region].sum() - terms[sides[:, 1] == region].sum()
        p, q, r = (mesh.points[cells[mesh.cell_region["triangle"] == region, k]] for k in range(3))
        u, v = q - p, r - p
        covered = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()
        rounding = 1e-11 * abs(covered) + 1e-15 * np.abs(mesh.points).max() * domain.diagonal
        assert abs(covered - bounded) <= rounding


def assert_angles(mesh: Mesh, domain: Pslg, bound: float) -> None:
    """No cell outside protected shells has an angle below the bound."""
    angles = smallest_angles(mesh)
    free = ~excused(mesh, domain)
    assert not free.any() or angles[free].min() >= bound - 1e-6


def assert_on_curves(mesh: Mesh, tolerance: float) -> None:
    """Both ends of each curved facet lie at its interval's parameters on its curve."""
    curve = mesh.facet_curve["line"]
    bent = np.flatnonzero(curve >= 0)
    for k in (0, 1) if len(bent) else ():
        exact = mesh.curves.points(curve[bent], mesh.facet_interval["line"][bent, k])
        ends = mesh.points[mesh.facets["line"][bent, k]]
        assert np.hypot(*(exact - ends).T).max() <= tolerance

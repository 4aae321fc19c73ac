"""Meshes to write: made by hand, so that files are tested without a mesher."""

import numpy as np
import pytest

from csgmesh.mesh import Mesh

NAMES = [
    ("plate.left",),
    ("plate.right",),
    ("plate.bottom",),
    ("plate.top", "lid"),
    ("core",),
    ("crack",),
    ("probe", "sensor"),
]


def two_regions(n: int = 8, m: int = 4) -> Mesh:
    """A 4 x 2 plate, x > 2 being `core`: an interface of the same name, a crack, a probe."""
    x, y = np.meshgrid(np.linspace(0, 4, n + 1), np.linspace(0, 2, m + 1), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel()])
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    a = (i * (m + 1) + j).ravel()
    b, c, d = a + m + 1, a + m + 2, a + 1
    cells = np.stack([np.column_stack([a, b, c]), np.column_stack([a, c, d])], 1).reshape(-1, 3)
    region = (points[cells].mean(axis=1)[:, 0] > 2).astype(int)
    up = np.column_stack([np.arange(m), np.arange(m) + 1])
    along = np.column_stack([np.arange(n), np.arange(n) + 1]) * (m + 1)
    half = n // 2 * (m + 1)
    parts = [
        (up[:, ::-1], 0, (0, -1)),
        (up + n * (m + 1), 1, (1, -1)),
        (along[: n // 2], 2, (0, -1)),
        (along[n // 2 :], 2, (1, -1)),
        (along[: n // 2, ::-1] + m, 3, (0, -1)),
        (along[n // 2 :, ::-1] + m, 3, (1, -1)),
        (up + half, 4, (0, 1)),
        (along[1:3] + 1, 5, (0, 0)),
    ]
    marker = np.full(len(points), -1)
    marker[[m + 3, 2 * m + 5]] = 6
    return Mesh(
        points,
        {"triangle": cells},
        {"triangle": region},
        ("rock", "core"),
        facets={"line": np.concatenate([f for f, _, _ in parts])},
        facet_marker={"line": np.concatenate([np.full(len(f), k) for f, k, _ in parts])},
        boundary_names=NAMES,
        facet_region={"line": np.concatenate([np.tile(r, (len(f), 1)) for f, _, r in parts])},
        point_marker=marker,
        info={"mesher": "by hand", "min_angle": 45.0},
    )


@pytest.fixture
def plate() -> Mesh:
    return two_regions()


@pytest.fixture
def quads() -> Mesh:
    """Quads beside triangles, of one region."""
    points = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
    return Mesh(
        points,
        {"triangle": [[1, 2, 5], [1, 5, 4]], "quad": [[0, 1, 4, 3]]},
        facets={"line": [[0, 1], [1, 2], [2, 5], [5, 4], [4, 3], [3, 0]]},
        facet_marker={"line": [0, 0, 1, 1, 1, 0]},
        facet_region={"line": [[0, -1]] * 6},
        boundary_names=[("wall",), ("door",)],
    )


@pytest.fixture
def curved() -> Mesh:
    """One second-order triangle."""
    points = [[0, 0], [1, 0], [0, 1], [0.5, 0], [0.6, 0.6], [0, 0.5]]
    return Mesh(
        points,
        {"triangle6": [[0, 1, 2, 3, 4, 5]]},
        facets={"line3": [[0, 1, 3], [1, 2, 4], [2, 0, 5]]},
        facet_marker={"line3": [0, 1, 0]},
        facet_region={"line3": [[0, -1]] * 3},
        boundary_names=[("wall",), ("arc",)],
    )

"""Meshes of solids are the same bytes whether libraries have one thread or all there are."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import csgmesh as cm


def fingerprint() -> str:
    """Of tetrahedra and of a surface, graded towards a bore."""
    bore = cm.Cylinder((1.4, 0.5, -1), (1.4, 0.5, 2), 0.25, name="bore")
    solid = cm.Box((0, 0, 0), (2, 1, 1)) - cm.Ball((0.6, 0.5, 0.5), 0.3) - bore
    digest = hashlib.sha256()
    for mesher in (cm.Octree(), cm.SurfaceRefinement()):
        mesh = cm.generate(solid, mesher, size={"bore": 0.05, "default": 0.2})
        arrays = (mesh.points, *mesh.cells.values(), *mesh.facets.values())
        for array in arrays:
            digest.update(array.tobytes())
    return digest.hexdigest()


def test_threads_change_no_byte() -> None:
    names = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "PYTHONHASHSEED")
    alone = subprocess.run(
        [sys.executable, __file__],
        env={**os.environ, **dict.fromkeys(names, "1")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert alone.stdout.strip() == fingerprint()


if __name__ == "__main__":
    print(fingerprint())

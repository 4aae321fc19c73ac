"""Compiled kernels are kept by the hash of their sources, and numba stays out until needed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import csgmesh
from csgmesh.kernels import cache

SOURCE = str(Path(csgmesh.__file__).parents[1])

MESH = """
import numpy as np
from csgmesh.domain import Pslg
from csgmesh.meshers import DelaunayRefinement
square = Pslg([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
mesh = DelaunayRefinement().generate(square, 0.5)
print(mesh.n_cells, round(float(np.abs(mesh.points).sum()), 9))
"""


def run(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": SOURCE, **environment},
    )


def test_importing_the_meshers_does_not_import_numba() -> None:
    code = "import sys, csgmesh.meshers, csgmesh.kernels; print('numba' in sys.modules)"
    assert run(code).stdout.strip() == "False"


def test_the_directory_follows_the_sources_and_the_user(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    key = cache.source_key("delaunay")
    assert cache.cache_directory("delaunay") == tmp_path / "csgmesh" / f"delaunay-{key}"
    assert cache.must_compile()


@pytest.fixture
def kernel_folder(tmp_path, monkeypatch):
    """Kernel modules that call one another, and one that none of them calls."""
    (tmp_path / "family").mkdir()
    (tmp_path / "family" / "entry.py").write_text("from ..callee import f\n")
    (tmp_path / "callee.py").write_text("from . import other, deepest\n")
    (tmp_path / "deepest.py").write_text("")
    (tmp_path / "other.py").write_text("")
    (tmp_path / "stranger.py").write_text("")
    monkeypatch.setattr(cache, "HERE", tmp_path)
    yield tmp_path
    cache.source_key.cache_clear()
    cache.callees.cache_clear()


def key_of_entry() -> str:
    cache.source_key.cache_clear()
    cache.callees.cache_clear()
    return cache.source_key("family.entry")


@pytest.mark.parametrize("module", ["family/entry", "callee", "deepest", "other"])
def test_machine_code_goes_stale_with_any_callee(kernel_folder, module) -> None:
    before = key_of_entry()
    with (kernel_folder / f"{module}.py").open("a") as file:
        file.write("# edited\n")
    assert key_of_entry() != before


def test_machine_code_outlives_edits_of_strangers(kernel_folder) -> None:
    before = key_of_entry()
    (kernel_folder / "stranger.py").write_text("# edited\n")
    assert key_of_entry() == before


def test_the_interpreter_runs_the_same_source() -> None:
    plain = run(MESH, NUMBA_DISABLE_JIT="1")
    assert plain.returncode == 0, plain.stderr
    assert plain.stdout == run(MESH).stdout


def test_a_cache_that_cannot_be_written_warns_and_works(tmp_path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    code = """
import numpy as np
from csgmesh import kernels
print(kernels.orientations(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 1, 2]])))
"""
    done = run(code, NUMBA_CACHE_DIR=str(blocked))
    assert done.stdout.strip() == "[1]"
    assert "cannot be kept" in done.stderr


def test_the_users_cache_setting_is_put_back() -> None:
    code = """
import numba, numpy as np
before = numba.config.CACHE_DIR
from csgmesh import kernels
kernels.orientations(np.array([[0, 0], [1, 0], [0, 1.0]]), np.array([[0, 1, 2]]))
print(numba.config.CACHE_DIR == before)
"""
    assert run(code).stdout.strip() == "True"

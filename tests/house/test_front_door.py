"""The front door has everything, costs nothing to open, and stays open."""

import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import csgmesh as cm

SOURCE = str(Path(cm.__file__).parents[1])
HEAVY = ("numba", "matplotlib", "scipy", "shapely", "meshio", "pydantic", "ruamel", "typer", "rich")
PLATE = 'cm.Box((0, 0), (4, 2), name="plate") - cm.Disk((2, 1), 0.5, name="hole")'


def loaded_after(code):
    """Which of the heavy packages a fresh interpreter has loaded after running code."""
    script = f"import sys\n{code}\nprint(*[name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        env={"PYTHONPATH": SOURCE},
        check=True,
    )
    return done.stdout.split()


def test_it_lists_everything_and_all_of_it_is_there():
    listed = {name for names in cm._HOME.values() for name in names}
    assert set(cm.__all__) == listed
    assert len(cm.__all__) == len(listed)
    assert list(cm.__all__) == sorted(cm.__all__)
    for module, names in cm._HOME.items():
        for name in names:
            assert getattr(cm, name) is getattr(importlib.import_module(module), name)
    assert set(cm.__all__) <= set(dir(cm))
    with pytest.raises(AttributeError, match="no attribute 'Disc'"):
        _ = cm.Disc


def test_no_module_shadows_a_name():
    modules = {module.name for module in pkgutil.iter_modules(cm.__path__)}
    assert not modules & set(cm.__all__)


def test_every_verb_works_twice(tmp_path):
    shape = cm.Box((0, 0), (2, 1), name="plate") - cm.Disk((1, 0.5), 0.25, name="hole")
    domain_file = tmp_path / "disk.yaml"
    domain_file.write_text("{csgmesh: 1, domain: {disk: {center: [0, 0], radius: 1}}}")
    for _ in range(2):
        assert cm.evaluate(shape).dim == 2
        mesh = cm.generate(shape, size=0.3)
        assert cm.check(mesh, shape).ok
        assert cm.quality(mesh).n_cells == mesh.n_cells
        cm.draw(mesh, tmp_path / "mesh.png")
        cm.write(tmp_path / "mesh.msh", mesh)
        assert cm.read(tmp_path / "mesh.msh").n_cells == mesh.n_cells
        assert cm.from_meshio(cm.to_meshio(mesh)).n_cells == mesh.n_cells
        assert cm.to_skfem(mesh).nelements == mesh.n_cells
        assert cm.load(domain_file).shape.dim == 2
        for verb in (cm.union, cm.intersection, cm.symmetric_difference):
            assert verb([shape, shape]).dim == 2
        assert cm.difference(shape, shape).dim == 2
        for module in pkgutil.walk_packages(cm.__path__, "csgmesh."):
            importlib.import_module(module.name)


def test_importing_it_loads_nothing_heavy():
    assert loaded_after("import csgmesh") == []


def test_a_shape_needs_numpy_alone():
    assert loaded_after(f"import csgmesh as cm; shape = {PLATE}; repr(shape); hash(shape)") == []


def test_evaluation_does_not_wait_for_the_compiler():
    loaded = loaded_after(f"import csgmesh as cm; cm.evaluate({PLATE})")
    assert not {"numba", "matplotlib", "meshio", "pydantic", "typer"} & set(loaded)

"""What the project says of itself is true: licence, dependencies, version, files."""

import re
import sys
import tomllib
from importlib.metadata import metadata
from pathlib import Path

import pytest

import csgmesh as cm

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
SOURCES = sorted((ROOT / "src").rglob("*.py"))
REQUIRED = [re.match(r"[\w.-]+", requirement)[0] for requirement in PROJECT["dependencies"]]
PERMISSIVE = ("BSD", "MIT", "Apache", "Python Software Foundation", "PSF")
LONGEST_FILE = 400


def test_the_licence_is_there_and_is_what_the_project_says():
    text = (ROOT / "LICENSE").read_text()
    assert "Redistribution and use in source and binary forms" in text
    assert "Neither the name" in text
    assert "BSD-3-Clause" in str(PROJECT["license"])


def test_the_version_is_stated_once_in_each_place():
    assert PROJECT["version"] == cm.__version__
    assert f"## {cm.__version__}" in (ROOT / "CHANGELOG.md").read_text()


@pytest.mark.parametrize("name", REQUIRED)
def test_what_runs_is_permissive(name):
    found = metadata(name)
    said = [found["License-Expression"] or "", (found["License"] or "").splitlines()[:1]]
    said += [c for c in found.get_all("Classifier") or [] if c.startswith("License ::")]
    text = " ".join(map(str, said))
    assert any(word in text for word in PERMISSIVE), text
    assert "GPL" not in text


def test_copyleft_peers_are_never_imported():
    peers = "|".join(["triangle", "gmsh", "netgen", "tetgen", "meshpy", "pygmsh"])
    pattern = re.compile(rf"^\s*(?:import|from)\s+(?:{peers})\b", re.MULTILINE)
    assert not [path.name for path in SOURCES if pattern.search(path.read_text())]


def test_every_import_of_a_library_is_declared():
    declared = {name.lower().replace("ruamel.yaml", "ruamel") for name in REQUIRED}
    # Two come with numba and pydantic; pytest loads the plugin; scikit-fem, PyVista are the user's.
    declared |= {"llvmlite", "pydantic_core", "pytest", "skfem", "pyvista"}
    pattern = re.compile(r"^\s*(?:import|from)\s+([a-z]\w*)", re.MULTILINE)
    for path in SOURCES:
        code = re.sub(r'"""(?:.|\n)*?"""', "", path.read_text())
        used = set(pattern.findall(code)) - set(sys.stdlib_module_names) - {"csgmesh"}
        assert used <= declared, path


def test_a_file_is_about_one_thing():
    long = [path for path in SOURCES if len(path.read_text().splitlines()) > LONGEST_FILE]
    assert not long
    assert not {path.stem for path in SOURCES} & {"utils", "util", "helpers", "common", "misc"}

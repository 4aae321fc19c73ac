"""``pytest --csgmesh`` collects domain files, and costs nothing otherwise."""

from __future__ import annotations

import subprocess
import sys

import pytest

import csgmesh as cm
from csgmesh.testing import assert_valid

pytest_plugins = ["pytester"]

GOOD = """\
csgmesh: 1
domain: {box: {lo: [0, 0], hi: [2, 1]}}
mesh: {size: 0.5}
expect: {area: 2, cells: [4, 400]}
"""


@pytest.fixture(scope="module", autouse=True)
def everything_imported() -> None:
    """Load numpy here: it loads once a process, and pytester forgets imports of the inner run."""
    box = cm.Box((0, 0), (2, 1))
    assert_valid(cm.generate(box, size=0.5), box)


@pytest.fixture
def domains(pytester: pytest.Pytester) -> pytest.Pytester:
    """A folder with one file of each kind."""
    pytester.makefile(
        ".yaml",
        good=GOOD,
        wrong=GOOD.replace("area: 2", "area: 3"),
        silent=GOOD.split("expect")[0],
        broken=GOOD.replace("box", "bx"),
        workflow="on: push\njobs: {}\n",
    )
    return pytester


def run(pytester: pytest.Pytester, *options: str) -> pytest.RunResult:
    """Run pytest in this process with the plugin, installed or not."""
    plugin = [] if installed() else ["-p", "csgmesh.testing.plugin"]
    return pytester.runpytest_inprocess(*plugin, *options)


def installed() -> bool:
    """Whether pytest finds the plugin by its entry point."""
    from importlib.metadata import entry_points

    return any(e.value == "csgmesh.testing.plugin" for e in entry_points(group="pytest11"))


def test_files_are_collected_if_asked_for(domains: pytest.Pytester) -> None:
    result = run(domains, "--csgmesh", "--continue-on-collection-errors")
    result.assert_outcomes(passed=1, failed=1, errors=1)


def test_files_are_left_alone_otherwise(domains: pytest.Pytester) -> None:
    run(domains).assert_outcomes()


def test_a_failure_is_a_report_without_a_traceback(domains: pytest.Pytester) -> None:
    result = run(domains, "--csgmesh", "wrong.yaml")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*wrong.yaml:4:16: area: 2*, expected 3*"])
    result.stdout.no_fnmatch_line("*Traceback*")
    result.stdout.no_fnmatch_line("*plugin.py:*")


def test_a_bad_file_is_an_error_at_its_place(domains: pytest.Pytester) -> None:
    result = run(domains, "--csgmesh", "broken.yaml")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["*broken.yaml:2:10: unknown key 'bx'*"])
    result.stdout.no_fnmatch_line("*Traceback*")


def test_an_empty_domain_is_a_failure(domains: pytest.Pytester) -> None:
    domains.makefile(".yml", empty=GOOD.replace("hi: [2, 1]}", "hi: [2, 1]}, complement: true"))
    result = run(domains, "--csgmesh", "empty.yml")
    result.assert_outcomes(failed=1)
    result.stdout.no_fnmatch_line("*Traceback*")


def test_the_plugin_imports_nothing_heavy() -> None:
    code = (
        "import csgmesh.testing.plugin, sys;"
        "print([m for m in ('numpy', 'numba', 'scipy', 'ruamel', 'pydantic') if m in sys.modules])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"

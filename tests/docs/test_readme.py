"""What the README and the other pages say works as it stands there."""

import doctest
import re
import shlex
import shutil
import subprocess
import sys

import pytest
from pages import PAGES, ROOT, blocks, links

import csgmesh as cm

README = ROOT / "README.md"
PROMPT = re.compile(r"^>>> ", re.MULTILINE)


def with_blocks(language):
    pages = [page for page in PAGES if blocks(page, language)]
    return pytest.mark.parametrize("page", pages, ids=lambda page: page.name)


@with_blocks("python")
def test_python_blocks(page, tmp_path, monkeypatch):
    """One after another in one session; those with prompts must print what stands there."""
    monkeypatch.chdir(tmp_path)
    # A page may define a primitive, which must not stay.
    monkeypatch.setattr(cm.Primitive, "kinds", dict(cm.Primitive.kinds))
    session: dict = {"__name__": page.stem}
    parser, runner = doctest.DocTestParser(), doctest.DocTestRunner(verbose=False)
    report: list[str] = []
    for block in blocks(page, "python"):
        if PROMPT.search(block.text):
            test = parser.get_doctest(block.text, session, page.name, str(page), block.line)
            runner.run(test, out=report.append, clear_globs=False)
            session.update(test.globs)
        else:
            exec(compile("\n" * block.line + block.text, str(page), "exec"), session)
    assert not report, "".join(report)


@with_blocks("yaml")
def test_domain_files(page, tmp_path):
    """Whole domain files mesh, pass the check and meet their own expectations."""
    for block in blocks(page, "yaml"):
        if not block.text.startswith("csgmesh: 1"):
            continue
        path = tmp_path / "page.yaml"
        path.write_text(block.text)
        file = cm.load(path)
        mesh = file.generate()
        assert cm.check(mesh, file.shape).ok, f"{page.name}:{block.line}"
        assert not file.mismatches(mesh), f"{page.name}:{block.line}"


@with_blocks("sh")
def test_commands(page, tmp_path):
    """Every csgmesh command, in order, in a folder that has the examples."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for block in blocks(page, "sh"):
        for line in block.text.splitlines():
            program, *arguments = shlex.split(line, comments=True)
            if program == "csgmesh":
                command = [sys.executable, "-m", "csgmesh", *arguments]
                done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
                assert done.returncode == 0, f"{page.name}: {line}\n{done.stderr}"


def set_up_commands():
    lines = [line for block in blocks(README, "sh") for line in block.text.splitlines()]
    return [line for line in lines if line.startswith("python3 -m venv")]


def test_ci_runs_the_second_set_up_command():
    first, second = set_up_commands()
    assert "csgmesh mesh examples/plate.yaml" in first
    shown = subprocess.run(
        ["bash", str(ROOT / ".ci" / "run"), "--show"], capture_output=True, text=True, check=True
    )
    assert shown.stdout.strip() == second
    for step in ("ruff check", "mypy", "lint-imports", "pytest"):
        assert f".venv/bin/{step}" in second


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in links(page):
        assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_every_picture_is_shown_and_drawn_by_an_example():
    shown = {(p.parent / target).resolve() for p in PAGES for target in links(p)}
    folder = ROOT / "docs" / "images"
    # `docs/make_matrix.py` draws its own.
    for path in (folder / "matrix").iterdir():
        assert path.suffix == ".png"
        assert path.resolve() in shown, f"nothing shows {path.name}"
    pictures = set(folder.glob("*")) - {folder / "matrix"}
    assert {path.suffix for path in pictures} == {".png"}
    for path in pictures:
        assert path.resolve() in shown, f"nothing shows {path.name}"
        assert (ROOT / "examples" / f"{path.stem}.py").exists(), f"nothing draws {path.name}"

"""A pytest plugin that collects domain files with an ``expect`` block: ``pytest --csgmesh``.

pytest imports this module in every run of every project in whose environment csgmesh is installed,
so it imports nothing of csgmesh, numpy or YAML until a domain file is collected.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from csgmesh.domainfile import DomainFile


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option ``--csgmesh``."""
    parser.getgroup("csgmesh").addoption(
        "--csgmesh",
        action="store_true",
        default=False,
        help="collect csgmesh domain files (.yaml, .yml) that have an expect block",
    )


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> DomainCollector | None:
    """Collect domain files, if asked to."""
    if not parent.config.getoption("--csgmesh") or file_path.suffix not in (".yaml", ".yml"):
        return None
    # Other YAML, such as that of a continuous integration, is nobody's mistake.
    with file_path.open("rb") as stream:
        if not any(line.startswith((b"csgmesh", b"{csgmesh")) for line in stream):
            return None
    return DomainCollector.from_parent(parent, path=file_path)


class BrokenDomain(Exception):
    """What a domain file's mesh has against it; its text is the whole report."""


class DomainCollector(pytest.File):
    """A domain file."""

    def collect(self) -> Iterator[DomainItem]:
        """One item, if the file expects anything."""
        from csgmesh.domainfile import load
        from csgmesh.errors import CsgmeshError

        try:
            file = load(self.path)
        except CsgmeshError as error:
            raise self.CollectError(str(error)) from None
        if file.expect is not None:
            yield DomainItem.from_parent(self, name="expect", file=file)


class DomainItem(pytest.Item):
    """The expectations of a domain file."""

    def __init__(self, *, file: DomainFile, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.file = file

    def runtest(self) -> None:
        """Mesh the file, check the mesh, compare it with what is expected."""
        from csgmesh.errors import CsgmeshError
        from csgmesh.pipeline import check

        try:
            mesh = self.file.generate()
            certificate = check(mesh, self.file.shape)
        except CsgmeshError as error:
            raise BrokenDomain(str(error)) from None
        problems = [f"{self.path}: {failure}" for failure in certificate.failures]
        problems += [f"{place}: {mismatch}" for mismatch, place in self.file.mismatches(mesh)]
        if problems:
            raise BrokenDomain("\n".join(problems))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The report of a broken domain without a traceback."""
        if isinstance(excinfo.value, BrokenDomain):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Where the expectations stand."""
        line, _ = self.file.document.place(("expect",), key=True)
        return self.path, line - 1, f"{self.path.name}: expect"

"""For tests of domains: assertions on meshes, and a pytest plugin for domain files.

Each assertion returns None or raises AssertionError with what was found and what was expected.
``pytest --csgmesh domains/`` runs the ``expect`` blocks of all domain files in a folder.

Importing this package costs nothing; numpy and the rest are imported by the first assertion.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from csgmesh.testing.assertions import (
        assert_area,
        assert_matches,
        assert_names,
        assert_valid,
    )

__all__ = ["assert_area", "assert_matches", "assert_names", "assert_valid"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module("csgmesh.testing.assertions"), name)

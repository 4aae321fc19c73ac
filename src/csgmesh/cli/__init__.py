"""The command line: ``csgmesh``, or ``python -m csgmesh``."""

from __future__ import annotations

import atexit
import gc
import sys
from typing import NoReturn

__all__ = ["main"]


def main() -> NoReturn:
    """Run the command that the arguments name, and exit with its code.

    0: done; 1: the check failed; 2: bad input; 3: the mesher could not do it; 130: interrupted.
    """
    # Start-up makes some hundred thousand objects that stay. Looking for garbage among them takes a
    # tenth of the time of a small mesh, and once more at exit a quarter.
    gc.set_threshold(50_000, 20, 100)
    atexit.register(gc.freeze)
    try:
        from csgmesh.cli.app import app

        app(prog_name="csgmesh")
    except KeyboardInterrupt:  # before or after a command, which answers its own
        sys.exit(130)
    sys.exit(0)

"""Where compiled kernels are kept, and whether they are there yet. Does not import numba."""

from __future__ import annotations

import hashlib
import os
import re
from functools import cache
from pathlib import Path

#: The entry points of a first mesh, with their modules; all of them cached means that nothing
#: will be compiled.
FIRST_MESH = {
    "insert_points": "delaunay",
    "recover_segments": "segments",
    "flood_regions": "segments",
    "refine": "refinement",
}

HERE = Path(__file__).parent
RELATIVE_IMPORT = re.compile(r"^from (\.+)(\w[\w.]*)? import \(?\s*(\w+(?:,\s*\w+)*)", re.MULTILINE)


def source(module: str) -> Path:
    """File of a kernel module; ``"tree.balance"`` is a module of a family in a folder."""
    return HERE.joinpath(*module.split(".")).with_suffix(".py")


@cache
def callees(module: str) -> tuple[str, ...]:
    """Kernel modules that a kernel module imports, in order of appearance."""
    found: dict[str, None] = {}
    for dots, name, what in RELATIVE_IMPORT.findall(source(module).read_text(encoding="utf-8")):
        family = module.split(".")[: -len(dots)]
        for callee in [name] if name else re.split(r",\s*", what):
            found[".".join([*family, callee])] = None
    return tuple(found)


@cache
def source_key(module: str) -> str:
    """Hash of the sources of a kernel module and of all that it calls.

    numba looks only at the file of the cached function itself: after an edit of a callee's file,
    and after an upgrade, it would keep running old machine code.
    """
    digest = hashlib.sha256()
    wanted, seen = [module], {module}
    while wanted:
        name = wanted.pop()
        digest.update(name.encode())
        digest.update(source(name).read_bytes())
        new = [callee for callee in callees(name) if callee not in seen]
        seen.update(new)
        wanted.extend(new)
    return digest.hexdigest()[:16]


def cache_directory(module: str) -> Path:
    """Directory of a module's machine code, below ``NUMBA_CACHE_DIR`` if the user set it."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        base = Path(chosen) / "csgmesh"
    else:
        root = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
        base = (Path(root) if root else Path.home() / ".cache") / "csgmesh"
    return base / f"{module}-{source_key(module)}"


def must_compile() -> bool:
    """Whether the first mesh of this process will have to compile kernels (some 10 s, once).

    Examples
    --------
    >>> isinstance(must_compile(), bool)
    True
    """
    try:
        return not all(
            any(cache_directory(module).glob(f"*/*.{name}-*.nbi"))
            for name, module in FIRST_MESH.items()
        )
    except (OSError, RuntimeError):
        return True

"""Where compiled kernels are kept, and whether they are there yet. Does not import numba."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

#: The entry points of a first mesh; all of them cached means that nothing will be compiled.
FIRST_MESH = ("insert_points", "recover_segments", "flood_regions", "refine")


def source_key() -> str:
    """Hash of all kernel sources.

    numba looks only at the file of the cached function itself: after an edit of a callee's file,
    and after an upgrade, it would keep running old machine code.
    """
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_directory() -> Path:
    """Directory of these sources' machine code, below ``NUMBA_CACHE_DIR`` if the user set it."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        return Path(chosen) / f"csgmesh-{source_key()}"
    root = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    base = Path(root) if root else Path.home() / ".cache"
    return base / "csgmesh" / f"kernels-{source_key()}"


def must_compile() -> bool:
    """Whether the first mesh of this process will have to compile kernels (some 10 s, once).

    Examples
    --------
    >>> isinstance(must_compile(), bool)
    True
    """
    try:
        directory = cache_directory()
        return not all(any(directory.glob(f"*/*.{name}-*.nbi")) for name in FIRST_MESH)
    except (OSError, RuntimeError):
        return True

"""Display in notebooks: shapes, domains and meshes show themselves as SVG.

Nothing heavy is imported until something is shown.
"""

from __future__ import annotations

import sys
from typing import Any

#: Module and class of everything that can be drawn; subclasses are found by IPython.
_DRAWN = (
    ("csgmesh.mesh.mesh", "Mesh"),
    ("csgmesh.domain.pslg", "Pslg"),
    ("csgmesh.domain.plc", "Plc"),
    ("csgmesh.csg.shape", "Shape"),
    ("csgmesh.csg.regions", "Regions"),
    ("csgmesh.csg.embed", "Embed"),
    ("csgmesh.csg.periodic", "Periodic"),
)


def register(ipython: Any) -> None:
    """Tell an IPython shell how to show what can be drawn.

    Parameters
    ----------
    ipython : InteractiveShell
        As ``get_ipython()`` returns it.
    """
    formatter = ipython.display_formatter.formatters["image/svg+xml"]
    for module, name in _DRAWN:
        formatter.for_type_by_name(module, name, _svg)


def register_if_active() -> bool:
    """Register with the running IPython, if there is one; whether there was."""
    loaded = sys.modules.get("IPython")
    shell = loaded.get_ipython() if loaded is not None else None
    if shell is not None:
        register(shell)
    return shell is not None


def _svg(x: object) -> str | None:
    """SVG, or None (which makes the notebook show text) for what has no picture."""
    from csgmesh.errors import CsgmeshError
    from csgmesh.viz.drawing import draw
    from csgmesh.viz.figure import svg

    try:
        figure = draw(x)
    except CsgmeshError:
        return None
    return None if figure is None else svg(figure)

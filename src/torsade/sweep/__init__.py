"""Many runs of one protocol: what to run, where, and what came of it.

>>> from torsade.sweep import Sweep
>>> sweep = Sweep("snap-twist", grid={"twist": ["0 deg", "250 deg"], "seed": {"from": 0, "to": 9}})
>>> len(sweep)
20

`sweep.run("pieces")` runs what the folder `pieces` does not have, and gives its `Catalogue`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from torsade.sweep.design import MOST_POINTS, Point, Sweep
    from torsade.sweep.engine import Effort, Summary, run
    from torsade.sweep.query import Catalogue, Rows

__all__ = ["MOST_POINTS", "Catalogue", "Effort", "Point", "Rows", "Summary", "Sweep", "run"]

# Workers import this package for the sake of one module.
_HOMES = {
    "MOST_POINTS": "design",
    "Catalogue": "query",
    "Effort": "engine",
    "Point": "design",
    "Rows": "query",
    "Summary": "engine",
    "Sweep": "design",
    "run": "engine",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"torsade.sweep.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'torsade.sweep' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)

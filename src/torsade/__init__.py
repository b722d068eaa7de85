"""Geometry, topology and mechanics of twisted elastic fibers.

>>> import torsade as ts
>>> spec = ts.protocols.PrisonEscape(knot="reef", force="15 N")
>>> spec.force
15.0

`spec.run()` gives a `Result`; `ts.open("reef.zarr")` reads one. Everything is imported when it is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from torsade import curve, knots, protocols, sweep, topology, view
    from torsade.centerline import Centerline
    from torsade.errors import TorsadeError
    from torsade.files import read_centerline, read_csv, write_centerline, write_csv
    from torsade.material import MATERIALS, Material, Section, named_material
    from torsade.results import Result, open_result
    from torsade.results import open_result as open
    from torsade.sweep import Sweep

__all__ = [
    "MATERIALS",
    "Centerline",
    "Material",
    "Result",
    "Section",
    "Sweep",
    "TorsadeError",
    "__version__",
    "curve",
    "knots",
    "named_material",
    "open",
    "open_result",
    "protocols",
    "read_centerline",
    "read_csv",
    "sweep",
    "topology",
    "view",
    "write_centerline",
    "write_csv",
]

__version__ = "0.1.0"

_MODULES = ("curve", "knots", "protocols", "sweep", "topology", "view")
_HOMES = {
    "MATERIALS": "torsade.material",
    "Centerline": "torsade.centerline",
    "Material": "torsade.material",
    "Result": "torsade.results",
    "Section": "torsade.material",
    "Sweep": "torsade.sweep",
    "TorsadeError": "torsade.errors",
    "named_material": "torsade.material",
    "open_result": "torsade.results",
    "read_centerline": "torsade.files",
    "read_csv": "torsade.files",
    "write_centerline": "torsade.files",
    "write_csv": "torsade.files",
}


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(f"torsade.{name}")
    if name == "open":
        return import_module("torsade.results").open_result
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'torsade' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)

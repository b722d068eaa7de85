"""Knots ready to be pulled, measured ones cleaned, and bends and sutures as diagrams."""

from torsade.knots.bends import Bend, bend_diagram, bend_names, find_bend
from torsade.knots.measured import Cleaned, clean
from torsade.knots.overhand import STRAND_KNOTS, overhand
from torsade.knots.stacked import BENDS, PULLS, BuiltBend, bend
from torsade.knots.sutures import suture_diagram

__all__ = [
    "BENDS",
    "PULLS",
    "STRAND_KNOTS",
    "Bend",
    "BuiltBend",
    "Cleaned",
    "bend",
    "bend_diagram",
    "bend_names",
    "clean",
    "find_bend",
    "overhand",
    "suture_diagram",
]

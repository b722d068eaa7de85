"""Knots by name: the catalogue, their diagrams, fibers ready to be pulled, and measured ones cleaned."""

from torsade.knots.bends import Bend
from torsade.knots.entries import KINDS, Entry, facts, variants
from torsade.knots.finding import bend_diagram, bend_names, find, interpret, search
from torsade.knots.measured import Cleaned, clean
from torsade.knots.overhand import STRAND_KNOTS, overhand
from torsade.knots.stacked import BENDS, PULLS, BuiltBend, bend
from torsade.knots.sutures import suture_diagram

__all__ = [
    "BENDS",
    "KINDS",
    "PULLS",
    "STRAND_KNOTS",
    "Bend",
    "BuiltBend",
    "Cleaned",
    "Entry",
    "bend",
    "bend_diagram",
    "bend_names",
    "clean",
    "facts",
    "find",
    "interpret",
    "overhand",
    "search",
    "suture_diagram",
    "variants",
]

"""Knots by name: the catalogue, their diagrams, and fibers ready to be pulled."""

from torsade.knots.bends import Bend
from torsade.knots.entries import KINDS, Entry, facts, variants
from torsade.knots.finding import bend_diagram, bend_names, find, interpret, search
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
    "Entry",
    "bend",
    "bend_diagram",
    "bend_names",
    "facts",
    "find",
    "interpret",
    "overhand",
    "search",
    "suture_diagram",
    "variants",
]

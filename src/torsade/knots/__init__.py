"""Knots ready to be pulled."""

from torsade.knots.overhand import STRAND_KNOTS, overhand
from torsade.knots.stacked import BENDS, PULLS, BuiltBend, bend

__all__ = ["BENDS", "PULLS", "STRAND_KNOTS", "BuiltBend", "bend", "overhand"]

"""Loose curves to tighten: knots and links by name, drawn as closed braids; and how short they can be."""

from __future__ import annotations

from torsade.arrays import Floats
from torsade.knots.entries import facts
from torsade.topology.codes.braid import to_braid
from torsade.topology.diagram import Diagram
from torsade.topology.drawing_curves import braid_curves
from torsade.topology.named import COMMON_NAMES, named_diagram

__all__ = ["listed_ropelength", "loose_diagram", "loose_knot"]

NODES = 100
"""To a crossing of the braid."""


def listed_ropelength(name: str) -> float | None:
    """L/h of the shortest known shape of a prime knot through 10 crossings, after KnotInfo; None for others.

    >>> listed_ropelength("m3_1")
    32.7436
    """
    found: float | None = facts(_plain(name).removeprefix("m")).get("ropelength")
    return found


def _plain(name: str) -> str:
    return COMMON_NAMES.get(name.strip().lower(), name.strip())


def loose_knot(name: str) -> list[Floats]:
    """A knot or link of the table as closed curves in space, shapes (n, 3), in units of its strands'
    distance.

    Names are those of `named_diagram`: m before one takes the mirror image, # joins summands.

    Raises:
        TorsadeError: a name that is not in the table.

    >>> from torsade.topology.identify import identify_curves
    >>> print(identify_curves(loose_knot("m5_2")))
    m5_2
    """
    diagram = named_diagram(name)
    plain = _plain(name)
    known = facts(plain.removeprefix("m")).get("braid")
    if known is None:
        return loose_diagram(diagram)
    word = [-i for i in known] if plain.startswith("m") else list(known)
    return _closed(word)


def loose_diagram(diagram: Diagram) -> list[Floats]:
    """Closed curves in space that a closed diagram draws, as a braid; for names `loose_knot` knows shorter
    ones.

    Raises:
        TorsadeError: the diagram has open strands.
    """
    return _closed(to_braid(diagram))


def _closed(word: list[int]) -> list[Floats]:
    strands = max((abs(i) + 1 for i in word), default=1)
    return braid_curves(word, strands, nodes=NODES * max(4, len(word)))

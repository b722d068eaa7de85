"""What the diagram of a code shows to be apart: split pieces, and connected summands."""

from __future__ import annotations

from torsade.topology import tangle
from torsade.topology.codes import from_pd, to_pd
from torsade.topology.invariants.code import Code, oriented

__all__ = ["summands"]


def summands(code: Code) -> list[list[Code]]:
    """Of each split piece of the diagram, prime diagrams whose connected sum it is (`tangle.summands`).

    A circle, or a piece that comes apart into crossings that can be untwisted, has no summands.
    """
    pieces = tangle.split(from_pd(code.crossings)) if code.crossings else ()
    prime = [[part for part in tangle.summands(piece) if part.n_crossings > 1] for piece in pieces]
    return [[oriented(to_pd(part)) for part in parts] for parts in prime] + [[]] * code.circles

"""What a diagram shows to be apart: split pieces, and connected summands.

Two edges that lie between the same two faces are crossed by a circle that meets the diagram nowhere else.
Cut there and joined up on either side, the diagram falls into two, whose connected sum it is. A nugatory
crossing is a summand of one crossing.
"""

from __future__ import annotations

from torsade.topology.invariants.code import Code, oriented

__all__ = ["summands"]


def summands(code: Code) -> list[list[Code]]:
    """Of each split piece of the diagram, prime diagrams whose connected sum it is.

    A circle, or a piece that comes apart into crossings that can be untwisted, has no summands.
    """
    pieces = [_factors(_part(code, piece)) for piece in code.pieces]
    return pieces + [[] for _ in range(code.circles)]


def _part(code: Code, piece: list[int]) -> Code:
    """One connected piece of a diagram."""
    return oriented([code.crossings[c] for c in piece])


def _factors(code: Code) -> list[Code]:
    """Prime diagrams of more than one crossing of which a connected diagram is the sum."""
    if len(code.crossings) == 1:
        return []
    between: dict[frozenset[int], int] = {}
    for edge, ((c, slot), _) in code.ends.items():
        faces = frozenset((code.corners[c][slot], code.corners[c][slot - 1]))
        if faces in between:
            halves = _cut(code, between[faces], edge)
            return [factor for piece in halves.pieces for factor in _factors(_part(halves, piece))]
        between[faces] = edge
    return [code]


def _cut(code: Code, e: int, f: int) -> Code:
    """The diagram in which edge e ends where edge f ended, and f where e did."""
    rows = [list(row) for row in code.crossings]
    (c, slot), (d, other) = code.ends[e][1], code.ends[f][1]
    rows[c][slot], rows[d][other] = f, e
    return oriented(rows)

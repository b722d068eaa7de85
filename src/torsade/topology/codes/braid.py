"""Braid words: integers i for the generator sigma_i and -i for its inverse.

Strands run upwards, at places 1, 2 ... from the left. In sigma_i the strand that rises to the right, from
i to i + 1, passes above, so the crossing is right-handed. [1, 1, 1] is the right-handed trefoil.
"""

from __future__ import annotations

from collections.abc import Iterable

from torsade.errors import TorsadeError
from torsade.topology.diagram import CIRCLE, Diagram

__all__ = ["from_braid"]


def from_braid(word: Iterable[int], n_strands: int | None = None) -> Diagram:
    """The closure of a braid, with the strand at place 1 outermost; crossings come as in the word.

    Args:
        word: nonzero integers.
        n_strands: number of strands of the braid; by default as many as the word needs.

    Raises:
        TorsadeError: a word that is empty, or has entries that are no generators of so many strands.

    >>> from_braid([1, -2, 1, -2])
    <Diagram: 4 crossings, 1 strand>
    """
    letters = list(word)
    if not letters and n_strands is None:
        raise TorsadeError("the braid word is empty; give nonzero integers, or the number of strands")
    if not all(isinstance(i, int) and i for i in letters):
        raise TorsadeError(
            f"the braid word {letters} has an entry that is no generator; give nonzero integers"
        )
    width = max((abs(i) + 1 for i in letters), default=1) if n_strands is None else n_strands
    if width < 1 or any(abs(i) >= width for i in letters):
        raise TorsadeError(
            f"a braid of {width} strands has generators 1 to {width - 1}, and the word is {letters}; "
            "give more strands"
        )
    mate = [0] * (4 * len(letters))
    bottom: list[int | None] = [None] * width
    loose: list[int | None] = [None] * width
    for c, i in enumerate(letters):
        # South-west, south-east, north-east and north-west, where the strand that comes from below is port 0.
        sw = 4 * c + (3 if i > 0 else 0)
        se, ne, nw = (4 * c + (sw + k & 3) for k in (1, 2, 3))
        k = abs(i) - 1
        for place, south, north in ((k, sw, nw), (k + 1, se, ne)):
            below = loose[place]
            if below is None:
                bottom[place] = south
            else:
                mate[below], mate[south] = south, below
            loose[place] = north
    for low, high in zip(bottom, loose, strict=True):
        if low is not None and high is not None:
            mate[low], mate[high] = high, low
    starts = [CIRCLE if p is None else p for p in loose]
    return Diagram.assemble(mate, starts, outer=[p for p in loose if p is not None])

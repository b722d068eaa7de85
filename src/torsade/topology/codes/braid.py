"""Braid words: integers i for the generator sigma_i and -i for its inverse.

Strands run upwards, at places 1, 2 ... from the left. In sigma_i the strand that rises to the right, from
i to i + 1, passes above, so the crossing is right-handed. [1, 1, 1] is the right-handed trefoil.
"""

from __future__ import annotations

from collections.abc import Iterable

from torsade.errors import TorsadeError, quoted
from torsade.topology.codes._limits import limited
from torsade.topology.diagram import CIRCLE, Diagram
from torsade.topology.moves import add_bigon

__all__ = ["from_braid", "to_braid"]


def from_braid(word: Iterable[int], n_strands: int | None = None) -> Diagram:
    """The closure of a braid, with the strand at place 1 outermost; crossings come as in the word.

    Args:
        word: nonzero integers.
        n_strands: number of strands of the braid; by default as many as the word needs.

    Raises:
        TorsadeError: a word that is empty, or has entries that are no generators of so many strands; more
            than 500 strands.

    >>> from_braid([1, -2, 1, -2])
    <Diagram: 4 crossings, 1 strand>
    """
    letters = list(word)
    if not letters and n_strands is None:
        raise TorsadeError("the braid word is empty; give nonzero integers, or the number of strands")
    if not all(isinstance(i, int) and i for i in letters):
        raise TorsadeError(
            f"the braid word {quoted(letters)} has an entry that is no generator; give nonzero integers"
        )
    width = max((abs(i) + 1 for i in letters), default=1) if n_strands is None else n_strands
    limited(width, "strands", "braid word")
    if width < 1 or any(abs(i) >= width for i in letters):
        raise TorsadeError(
            f"a braid of {width} strands has generators 1 to {width - 1}, and the word is {quoted(letters)}; "
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


def to_braid(diagram: Diagram) -> list[int]:
    """A braid whose closure is the knot or link of a connected closed diagram.

    Vogel's algorithm (Representation of links by braids, Comment. Math. Helv. 65, 1990): where two edges
    of different Seifert circles run the same way around a face, one is pushed over the other. When
    there are none left the Seifert circles lie around each other like the strands of a closed braid.
    It has as many strands as the diagram has Seifert circles.

    >>> from torsade.topology.codes import from_pd
    >>> to_braid(from_pd([(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 2)]))
    [1, 1, 1]
    """
    if diagram.ends or not diagram.is_connected:
        raise TorsadeError(
            f"a braid word is of a connected closed diagram, not of {diagram!r}; close or split it"
        )
    if diagram.circles:
        return []
    while pair := _incoherent(diagram):
        diagram = add_bigon(diagram, *pair)
    return _read_off(diagram, _ray(diagram))


def _incoherent(diagram: Diagram) -> tuple[int, int] | None:
    """Darts of two edges of different Seifert circles that run the same way around a face, if any."""
    circle = {e: k for k, loop in enumerate(diagram.seifert_circles) for e in loop}
    for face in diagram.faces:
        for along in (True, False):
            darts = [p for p in face if diagram.is_tail(p) == along]
            for q in darts[1:]:
                if circle[diagram.edge_at[q]] != circle[diagram.edge_at[darts[0]]]:
                    return darts[0], q
    return None


def _ray(diagram: Diagram) -> list[int]:
    """Edges met on a way from outside all Seifert circles to within the last, each time to the right.

    The face on the right of an edge has, running the other way around it, the edges of the next circle.
    """
    tails = [tail for tail, _ in diagram.edges]
    # On the left of the outermost circle lies nothing else: a face around which all edges run one way.
    first = next(p for p in tails if all(diagram.is_tail(q) for q in diagram.faces[diagram.face_at[p]]))
    ray = [first]
    while True:
        right = diagram.faces[diagram.face_at[diagram.mate[ray[-1]]]]
        following = [p for p in right if diagram.is_tail(p)]
        if not following:
            return ray
        ray.append(min(following))


def _read_off(diagram: Diagram, ray: list[int]) -> list[int]:
    """The letters of a closed braid cut open along a ray: crossings in an order that all strands agree on."""
    place = {diagram.edge_at[p]: k for k, p in enumerate(ray)}
    rows = []
    for loop in diagram.seifert_circles:
        k = next(k for k, e in enumerate(loop) if e in place)
        turned = loop[k:] + loop[:k]
        rows.append((place[turned[0]], [diagram.edges[e][1] >> 2 for e in turned]))
    strands = [row for _, row in sorted(rows)]
    at = [0] * len(strands)
    word: list[int] = []
    while len(word) < diagram.n_crossings:
        # A crossing comes next where it is next on both of its strands.
        for k in range(len(strands) - 1):
            left, right = strands[k][at[k] : at[k] + 1], strands[k + 1][at[k + 1] : at[k + 1] + 1]
            if left and left == right:
                word.append((k + 1) * diagram.signs[left[0]])
                at[k] += 1
                at[k + 1] += 1
                break
    return word

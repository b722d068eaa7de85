"""Dowker-Thistlethwaite codes: the even label that meets each of the odd labels 1, 3, 5 ...

Labels are counted through along the strands. An entry is positive where the odd label passes below, up
to a change of all signs. The code fixes a prime knot up to its mirror image.
"""

from __future__ import annotations

from collections.abc import Sequence

from torsade.errors import TorsadeError, listed, quoted
from torsade.topology.codes._realize import realized, rows_of
from torsade.topology.diagram import Diagram

__all__ = ["from_dt", "to_dt"]


def from_dt(code: Sequence[int] | Sequence[Sequence[int]]) -> Diagram:
    """The diagram of a code; its crossings come in the order of the odd labels.

    Label 1 passes below if the first entry is positive. Of the mirror images that the code allows, the
    one is drawn whose first crossing, of each part that can be mirrored by itself, is right-handed.

    Args:
        code: even integers for a knot; for a link such a list for each strand.

    Raises:
        TorsadeError: entries that are not 2, 4 ... 2n in some order, up to signs, or a code that no
            drawing has.

    >>> from_dt([4, 6, 2]).signs
    (1, 1, 1)
    """
    rows = rows_of(code)
    entries = [k for row in rows for k in row]
    n = len(entries)
    odd = [k for k in entries if k % 2]
    if odd:
        raise TorsadeError(
            f"the DT code has the odd entry {odd[0]}; give the even label that meets each odd one"
        )
    if sorted(map(abs, entries)) != list(range(2, 2 * n + 1, 2)):
        raise TorsadeError(
            f"the DT code {quoted(entries)} does not have each of 2, 4 ... {2 * n} once, up to signs; "
            "check its entries"
        )
    passages = [(0, False)] * (2 * n)
    for c, k in enumerate(entries):
        passages[2 * c] = (c, k < 0)
        passages[abs(k) - 1] = (c, k > 0)
    strands, begin = [], 0
    for row in rows:
        strands.append(passages[begin : begin + 2 * len(row)])
        begin += 2 * len(row)
    return realized(strands, "DT code")


def to_dt(diagram: Diagram) -> list[int] | list[list[int]]:
    """The code from where the strands start: a list, or for a link a list for each strand.

    Strands of a link start one edge later where that is needed for odd labels to meet even ones. All
    signs are changed if the first entry would be negative.

    Raises:
        TorsadeError: the diagram has ends, or a circle without crossings beside other strands.

    >>> to_dt(from_dt([4, 8, 10, 2, 12, 6]))
    [4, 8, 10, 2, 12, 6]
    """
    if diagram.ends:
        raise TorsadeError(f"the diagram has ends {listed(diagram.ends)}; a DT code is for closed strands")
    if diagram.circles and diagram.n_strands > 1:
        raise TorsadeError(
            "the diagram has a circle without crossings, which no DT code shows; take it away first"
        )
    strands = _started(diagram)
    label: dict[int, int] = {}
    for q in (q for strand in strands for q in strand):
        label[q] = len(label) + 1
    meets: dict[int, int] = {}
    for q, k in label.items():
        if k % 2:
            over = label.get(q ^ 1, label.get(q ^ 3, 0))
            meets[k] = -over if q & 1 else over
    flip = -1 if meets and meets[1] < 0 else 1
    rows = [[flip * meets[label[q]] for q in strand[::2]] for strand in strands]
    return rows[0] if len(rows) == 1 else rows


def _started(diagram: Diagram) -> list[tuple[int, ...]]:
    """The passages of each strand, begun so that each crossing is met at an odd and at an even label.

    A strand passes an even number of crossings, so it is begun where it starts or one edge later; where two
    strands cross, one says it of the other.
    """
    strands = diagram.strands
    place = {q: (k, i) for k, strand in enumerate(strands) for i, q in enumerate(strand)}
    later: dict[int, int] = {}
    for root in range(len(strands)):
        todo = [] if root in later else [root]
        later.setdefault(root, 0)
        for k in todo:  # grows as it is read
            for i, q in enumerate(strands[k]):
                other, j = place.get(q ^ 1) or place[q ^ 3]
                if other not in later:
                    later[other] = (later[k] + i + j + 1) % 2
                    todo.append(other)
    return [s[later[k] :] + s[: later[k]] for k, s in enumerate(strands)]

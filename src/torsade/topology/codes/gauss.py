"""Gauss codes: along each strand the crossings in order, over or under.

Signed, as text: "O1+ U2+ O3+ U1+ O2+ U3+", with | between strands. It fixes the diagram on the sphere.
Unsigned, as integers: over passages are negative. It fixes each prime summand up to its mirror image.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence

from torsade.errors import TorsadeError, quoted
from torsade.topology.codes._planar import drawn, standing
from torsade.topology.codes._realize import realized, rows_of
from torsade.topology.diagram import CIRCLE, Diagram, strand_name

__all__ = ["from_gauss", "to_gauss", "to_unsigned_gauss"]

Passage = tuple[int, bool]
"""A crossing and whether it is passed above."""


def to_gauss(diagram: Diagram) -> str:
    """The signed code; crossings are numbered from 1 in the order in which they are met.

    Open strands are written from end to end as `to_open_pd` does it: from A0 to A1.

    >>> to_gauss(from_gauss("O7+ U5+ | U7+ O5+"))
    'O1+ U2+ | U1+ O2+'
    """
    diagram = standing(diagram)
    number = _numbers(diagram)
    return " | ".join(
        " ".join(f"{'UO'[q & 1]}{number[q >> 2]}{'+' if diagram.signs[q >> 2] > 0 else '-'}" for q in strand)
        for strand in diagram.strands
    )


def to_unsigned_gauss(diagram: Diagram) -> list[list[int]]:
    """The unsigned code, a list for each strand: crossings from 1 on as they are met, negative where over."""
    diagram = standing(diagram)
    number = _numbers(diagram)
    return [[-number[q >> 2] if q & 1 else number[q >> 2] for q in strand] for strand in diagram.strands]


def _numbers(diagram: Diagram) -> dict[int, int]:
    number: dict[int, int] = {}
    for strand in diagram.strands:
        for q in strand:
            number.setdefault(q >> 2, len(number) + 1)
    return number


def from_gauss(
    code: str | Sequence[int] | Sequence[Sequence[int]],
    closed: bool | Sequence[bool] = True,
    boundary: Iterable[str] | None = None,
) -> Diagram:
    """The diagram of a Gauss code; crossings come in the order of their numbers.

    Args:
        code: signed text; or, unsigned, integers for a knot and lists of them for a link. Of the mirror
            images that an unsigned code allows, the one is drawn whose first crossing, of each part
            that can be mirrored by itself, is right-handed. A strand without passages is a circle.
        closed: whether strands are closed, all or one by one. Unsigned codes are.
        boundary: for a tangle the names of its ends, counterclockwise, as for `from_pd`.

    Raises:
        TorsadeError: text that is not understood, a crossing not passed once above and once below, signs
            that differ, or a code that is not planar.
    """
    if not isinstance(code, str):
        if closed is not True or boundary is not None:
            raise TorsadeError(
                "an unsigned Gauss code is given for open strands; give signed text, such as 'O1+ U1+'"
            )
        return realized(_renumbered([[(abs(k), k < 0) for k in row] for row in rows_of(code)]), "Gauss code")
    strands, signs = _parsed(code)
    number = {c: k for k, c in enumerate(sorted(signs))}
    strands = _renumbered(strands)
    flags = [closed] * len(strands) if isinstance(closed, bool) else list(closed)
    if len(flags) != len(strands):
        raise TorsadeError(f"{len(strands)} strands have {len(flags)} closed flags; give one for each")
    sign = [signs[c] for c in sorted(signs)]
    m = 2 * flags.count(False)
    mate = [0] * (4 * len(number) + m)
    starts: list[int] = []
    ends: list[str] = []
    for k, (strand, is_closed) in enumerate(zip(strands, flags, strict=True)):
        entries = [4 * c + (2 + sign[c] if over else 0) for c, over in strand]
        tails, heads = [q ^ 2 for q in entries], entries[:]
        if not is_closed:
            tails.insert(0, len(ends) - m)
            heads.append(len(ends) - m + 1)
            ends += [strand_name(k) + "0", strand_name(k) + "1"]
        elif tails:
            tails.insert(0, tails.pop())
        for p, q in zip(tails, heads, strict=True):
            mate[p], mate[q] = q, p
        starts.append(tails[0] if tails else CIRCLE)
    return drawn(mate, starts, ends, boundary, "Gauss code")


def _parsed(code: str) -> tuple[list[list[Passage]], dict[int, int]]:
    """The passages of each strand and the sign of each crossing."""
    strands: list[list[Passage]] = []
    signs: dict[int, int] = {}
    for part in code.split("|"):
        strands.append([])
        for word in re.sub(r"(?<=[+-])(?=[OU])|,", " ", part).split():
            found = re.fullmatch(r"([OU])(\d{1,9})([+-])", word, re.A)
            if not found:
                raise TorsadeError(
                    f"{quoted(word)} in the Gauss code is not understood; give passages such as 'O1+', 'U12-'"
                )
            c, sign = int(found[2]), 1 if found[3] == "+" else -1
            if signs.setdefault(c, sign) != sign:
                raise TorsadeError(
                    f"crossing {c} of the Gauss code has both signs; give it the same one twice"
                )
            strands[-1].append((c, found[1] == "O"))
    return strands, signs


def _renumbered(strands: list[list[Passage]]) -> list[list[Passage]]:
    """The same with crossings from 0 on, each passed once above and once below."""
    passages = [passage for strand in strands for passage in strand]
    number = {c: k for k, c in enumerate(sorted({c for c, _ in passages}))}
    times = Counter(passages)
    for c in number:
        above, below = times[c, True], times[c, False]
        if (above, below) != (1, 1):
            raise TorsadeError(
                f"crossing {c} of the Gauss code is passed {above} times above and {below} times below; "
                "give each once above and once below"
            )
    return [[(number[c], over) for c, over in strand] for strand in strands]

"""Planar diagram codes: four edge labels per crossing, the incoming lower edge first, counterclockwise.

Closed diagrams have integer labels, consecutive along each strand. Tangles may have strings such as
"A0", "A1" ... along strand A; a label that occurs once is that of an edge with an end.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from torsade.errors import TorsadeError, listed, quoted
from torsade.topology.codes._planar import drawn, standing
from torsade.topology.diagram import CIRCLE, Diagram, strand_name
from torsade.topology.moves import add_kink

__all__ = ["from_pd", "to_open_pd", "to_pd"]

Label = int | str


def to_pd(diagram: Diagram, first: int = 1) -> list[tuple[int, int, int, int]]:
    """The code of a closed diagram, with labels from `first` on, consecutive along each strand.

    A circle without crossings has no label, so it is given a kink; a single circle is [].

    Raises:
        TorsadeError: the diagram has ends.

    >>> to_pd(from_pd([(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 2)]))
    [(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 2)]
    """
    if diagram.ends:
        raise TorsadeError(f"the diagram has ends {listed(diagram.ends)}; use `to_open_pd`, or close it")
    if diagram.n_strands == diagram.circles == 1:
        return []
    while diagram.circles:
        diagram = add_kink(diagram, CIRCLE, 1)
    at = diagram.edge_at
    return [
        (first + at[p], first + at[p + 1], first + at[p + 2], first + at[p + 3]) for p in range(0, len(at), 4)
    ]


def to_open_pd(diagram: Diagram) -> list[tuple[str, str, str, str]]:
    """The code of a tangle, with labels A0, A1 ... along strand A, and so on.

    Strands are written from their end A0 to their end A1 whichever way they run: the code keeps the names of
    ends, and `Diagram.pulled` says again which are pulled. Where ends have other names, they are not kept,
    and strands are written as they run.

    >>> from torsade.topology.tangle import integer
    >>> to_open_pd(integer(1)) == to_open_pd(integer(1).reverse())
    True
    """
    diagram = standing(diagram)
    name = [diagram.edge_name(e) for e in range(len(diagram.edges))]
    at = diagram.edge_at
    return [
        (name[at[p]], name[at[p + 1]], name[at[p + 2]], name[at[p + 3]])
        for p in range(0, 4 * diagram.n_crossings, 4)
    ]


def from_pd(code: Iterable[Sequence[Label]], boundary: Iterable[str] | None = None) -> Diagram:
    """The diagram of a code, with integers or with names such as "A3".

    Strands come in the order of their smallest labels and start there. A strand that never passes
    below runs towards larger labels.

    Args:
        code: four labels for each crossing. [] is the circle without crossings.
        boundary: for a tangle the names of its ends, counterclockwise. By default they are found,
            which leaves a choice only where strands are not connected by crossings.

    Raises:
        TorsadeError: a crossing without four labels, a label that occurs three times or more, a
            crossing that does not begin with its incoming lower edge, a code that is not planar.
    """
    rows = [tuple(row) for row in code]
    if not rows:
        return Diagram.circle()
    ports = _ports(rows)
    n = 4 * len(rows)
    mate = [0] * n
    labels: list[Label] = [label for row in rows for label in row]
    tips: dict[int, int] = {}  # port → end, in the order of labels
    for places in (ports[label] for label in sorted(ports, key=_key)):
        if len(places) == 1:
            tips[places[0]] = len(tips)
            mate[places[0]] = CIRCLE
        else:
            mate[places[0]], mate[places[1]] = places[1], places[0]
    m = len(tips)
    for p, k in tips.items():
        mate[p] = k - m
    mate += list(tips)
    starts = _starts(mate, m, labels)
    ends = [""] * m
    for k, s in enumerate(starts):
        if s < 0:
            ends[s], ends[_last(mate, s)] = strand_name(k) + "0", strand_name(k) + "1"
    return drawn(mate, starts, ends, boundary, "PD code")


def _ports(rows: list[tuple[Label, ...]]) -> dict[Label, list[int]]:
    """The ports of each label."""
    ports: dict[Label, list[int]] = {}
    for c, row in enumerate(rows):
        if len(row) != 4:
            raise TorsadeError(
                f"crossing {c} of the PD code has {len(row)} labels, {quoted(list(row))}; give four"
            )
        for i, label in enumerate(row):
            ports.setdefault(label, []).append(4 * c + i)
    for label, places in ports.items():
        if len(places) > 2:
            raise TorsadeError(
                f"label {quoted(label)} occurs {len(places)} times in the PD code; give each edge a label of "
                "its own, which occurs twice, or once if the edge has an end"
            )
    return ports


def _key(label: Label) -> tuple[int, str, int]:
    """Integers in their order, names by letters, A ... Z, AA ..., and then by number."""
    if isinstance(label, int):
        return 0, "", label
    found = re.fullmatch(r"(\D*)(\d+)", label)
    if not found:
        raise TorsadeError(
            f"label {quoted(label)} of the PD code is not understood; give integers, or names such as 'A3'"
        )
    return len(found[1]), found[1], int(found[2])


def _last(mate: Sequence[int], start: int) -> int:
    """The end of the open strand that begins at an end."""
    q = mate[start]
    while q >= 0:
        q = mate[q ^ 2]
    return q


def _starts(mate: list[int], m: int, labels: list[Label]) -> list[int]:
    """Where the strands begin: at the first label of each, running as the lower passages say."""
    key = [_key(label) for label in labels]
    seen: set[int] = set()
    starts = []
    for p in sorted(range(len(labels)), key=lambda p: (key[p], p)):
        if p in seen:
            continue
        start = mate[p] if mate[p] < 0 else p
        entries = _entries(mate, start)
        lower = {q for q in entries if not q & 1}
        if start >= 0:
            rising = sum(key[q] < key[q ^ 2] for q in entries)
            against = sum(bool(q & 3) for q in lower) if lower else len(entries) - rising
            agreeing = len(lower) - against if lower else rising
            if agreeing < against or (agreeing == against and entries[0] & 3 != 3):
                start = mate[start]
                entries = _entries(mate, start)
        wrong = [q for q in entries if q & 3 == 2]
        if wrong:
            c = wrong[0] >> 2
            raise TorsadeError(
                f"crossing {c} of the PD code, {quoted(labels[4 * c : 4 * c + 4])}, does not begin with its "
                "incoming lower edge: along its strand the third label comes first; turn it by two places"
            )
        seen.update(entries)
        seen.update(q ^ 2 for q in entries)
        starts.append(start)
    return starts


def _entries(mate: Sequence[int], start: int) -> list[int]:
    """The ports by which the strand from `start` enters crossings."""
    entries, p = [], start
    while (q := mate[p]) >= 0:
        entries.append(q)
        p = q ^ 2
        if p == start:
            break
    return entries

"""Codes as text, as tables and other programs write them; what a text is, its first characters say.

| code | as in |
| --- | --- |
| PD | `[[1,5,2,4],[3,1,4,6],[5,3,6,2]]`, `X[1,5,2,4] X[3,1,4,6] ...`, `PD[...]` |
| PD of a tangle | `X[B2,A1,B3,A0] ...`, with labels A0, A1 ... along strand A |
| Dowker-Thistlethwaite | `DT: [4,6,2]`, `DT(4 6 2)`, of a link `DT: [(4,6),(2,8)]` |
| Gauss, signed | `O1+ U2+ O3+ U1+ O2+ U3+`, with a bar between strands |
| Gauss, unsigned | `Gauss: [-1,2,-3,1,-2,3]`, negative where over; of a link `Gauss: [[1,-2],[-1,2]]` |
| braid | `{1,-2,1,-2}`, `braid: 1 -2 1 -2` |
| Conway notation | `[3 2]`, `C[21;3;2]`, `Conway: 3 2` |
"""

from __future__ import annotations

import re
from collections.abc import Callable

from torsade.errors import TorsadeError, quoted
from torsade.topology.codes.braid import from_braid
from torsade.topology.codes.conway import from_conway
from torsade.topology.codes.dowker import from_dt
from torsade.topology.codes.gauss import from_gauss
from torsade.topology.codes.pd import from_pd
from torsade.topology.diagram import Diagram

__all__ = ["code_kind", "from_text"]

LONGEST = 20_000
"""Longest text that is read: some thousand crossings."""

_KINDS: tuple[tuple[str, str], ...] = (
    ("DT code", r"DT\b[\s:]*"),
    ("Gauss code", r"Gauss\b[\s:]*|(?=[OU]\d+[+-])"),
    ("braid word", r"braid\b[\s:]*|(?=\{)"),
    ("PD code", r"PD\b[\s:]*|(?=X\s*[\[(])|(?=[\[(]\s*[\[(])"),
    ("Conway code", r"(?:Conway|C(?=\s*[\[:]))[\s:]*|(?=\[)"),
)
"""What a text is, by the first pattern that its beginning has; the pattern is not part of the code."""


def code_kind(text: str) -> str | None:
    """What code a text is in: "PD code", "DT code", "Gauss code", "braid word", "Conway code", or None."""
    return next((kind for kind, pattern in _KINDS if re.match(pattern, text.strip(), re.I)), None)


def from_text(text: str) -> Diagram:
    """The diagram of a code given as text.

    >>> from_text("X[1,5,2,4] X[3,1,4,6] X[5,3,6,2]").signs
    (1, 1, 1)
    >>> [from_text(code).n_crossings for code in ("{1,-2,1,-2}", "DT: [4,6,2]", "[3 2]")]
    [4, 3, 5]

    Raises:
        TorsadeError: text in none of these forms, or a code that `from_pd` or its like refuses.
    """
    kind = code_kind(text)
    if kind is None:
        raise TorsadeError(
            f"{quoted(text)} is no code; begin with X[ or [[ for PD, DT:, Gauss: or O1+, braid: or {{, "
            "C[ for Conway notation"
        )
    if len(text) > LONGEST:
        raise TorsadeError(f"the {kind} has {len(text)} characters; give at most {LONGEST}")
    pattern = dict(_KINDS)[kind]
    body = re.sub(f"^(?:{pattern})", "", text.strip(), count=1, flags=re.I).strip()
    return _READERS[kind](body, kind)


def _pd(body: str, kind: str) -> Diagram:
    rows = re.findall(r"[\[(]\s*([^\[\]()]*?)\s*[\])]", body)
    if not rows and re.sub(r"[\s\[\]()]", "", body):
        raise TorsadeError(f"the {kind} {quoted(body)} has no crossing in brackets; give such as X[1,5,2,4]")
    left = re.sub(r"[\[(][^\[\]()]*[\])]", "", body)
    strange = re.sub(r"[X\s,;\[\]()]", "", left, flags=re.I)
    if strange:
        raise TorsadeError(
            f"{quoted(strange)} in the {kind} is not understood; give crossings such as [1,5,2,4]"
        )
    labels = [[word for word in re.split(r"[\s,]+", row) if word] for row in rows if row]
    words = [word for row in labels for word in row]
    once = [word for word in words if words.count(word) == 1 and _is_integer(word)]
    if once and all(len(row) == 4 for row in labels):
        raise TorsadeError(
            f"label {once[0]} occurs once in the {kind}; give it twice, or name the edges of a tangle "
            "A0, A1 ..."
        )
    return from_pd([[int(word) if _is_integer(word) else word for word in row] for row in labels])


def _dt(body: str, kind: str) -> Diagram:
    return from_dt(_rows(body, kind, "4 6 2"))


def _gauss(body: str, kind: str) -> Diagram:
    if re.search(r"[OU]", body, re.I):
        return from_gauss(body.strip("[]() ").upper())
    return from_gauss(_rows(body, kind, "-1 2 -3 1 -2 3"))


def _braid(body: str, kind: str) -> Diagram:
    return from_braid(_integers(body.strip("{}[]() "), kind, "1 -2 1 -2"))


def _conway(body: str, kind: str) -> Diagram:
    if body.count("[") != body.count("]"):
        raise TorsadeError(f"the {kind} {quoted(body)} has a bracket that is not closed; close it")
    return from_conway(body)


_READERS: dict[str, Callable[[str, str], Diagram]] = {
    "PD code": _pd,
    "DT code": _dt,
    "Gauss code": _gauss,
    "braid word": _braid,
    "Conway code": _conway,
}


def _rows(body: str, kind: str, example: str) -> list[int] | list[list[int]]:
    """One list of integers, or several where there are inner brackets."""
    inner = re.findall(r"[\[(]([^\[\]()]*)[\])]", body)
    if len(inner) > 1:
        return [_integers(row, kind, example) for row in inner]
    numbers = _integers(body.strip("[]{}() "), kind, example)
    if not numbers:
        raise TorsadeError(f"the {kind} is empty; give integers such as {example}")
    return numbers


def _integers(text: str, kind: str, example: str) -> list[int]:
    words = [word for word in re.split(r"[\s,;]+", text) if word]
    wrong = [word for word in words if not _is_integer(word)]
    if wrong:
        raise TorsadeError(f"{quoted(wrong[0])} in the {kind} is no integer; give integers such as {example}")
    return [int(word) for word in words]


def _is_integer(word: str) -> bool:
    return re.fullmatch(r"[+-]?\d{1,9}", word, re.A) is not None

"""Codes as text, as tables and other programs write them; what a text is, its first characters say.

| code | as in |
| --- | --- |
| PD | `[[1,5,2,4],[3,1,4,6],[5,3,6,2]]`, `X[1,5,2,4] X[3,1,4,6] ...`, `X_{1,5,2,4} ...`, `PD[...]` |
| PD of a tangle | `X[B2,A1,B3,A0] ...`, with labels A0, A1 ... along strand A |
| Dowker-Thistlethwaite | `DT: [4,6,2]`, `DT(4 6 2)`, of a link `DT: [(4,6),(2,8)]` |
| Gauss, signed | `O1+ U2+ O3+ U1+ O2+ U3+`, with a bar between strands |
| Gauss, unsigned | `Gauss: [-1,2,-3,1,-2,3]`, over negative; `O1U2O3U1O2U3`; of a link `[[1,-2],[-1,2]]` |
| braid | `{1,-2,1,-2}`, `braid: 1 -2 1 -2`, `BR[3,{1,-2,1,-2}]` with the number of strands |
| Conway notation | `[3 2]`, `C[21;3;2]`, `Conway: 3 2` |

In brackets and round brackets stand a PD code, if the inner ones are a list with rows of four, and else
Conway notation, as in `[(3,2)(21,2)]`.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable

from torsade.errors import TorsadeError, quoted
from torsade.topology.codes._limits import limited
from torsade.topology.codes.braid import from_braid
from torsade.topology.codes.conway import from_conway
from torsade.topology.codes.dowker import from_dt
from torsade.topology.codes.gauss import from_gauss
from torsade.topology.codes.pd import from_pd
from torsade.topology.diagram import Diagram

__all__ = ["BEGINNINGS", "code_kind", "from_text", "leaves_mirror_open"]

BEGINNINGS = "X[ or [[ for PD, DT:, Gauss: or O1+, braid: or {, C[ for Conway notation"
"""How codes begin, for error messages."""

LONGEST = 20_000
"""Longest text that is read: hundreds of crossings."""

_ROW = r"\([^()\[\]]*\)"

_KINDS: tuple[tuple[str, str], ...] = (
    ("DT code", r"DT\b[\s:]*"),
    ("Gauss code", r"Gauss\b[\s:]*|(?=[OU]\d)"),
    ("braid word", r"(?:braid|BR)\b[\s:]*|(?=\{)"),
    ("PD code", r"PD\b[\s:]*|(?=X\s*_?\s*[\[({])|(?=\[\s*\[|\(\s*[\[(])"),
    ("Conway code", r"(?:Conway|C(?=\s*[\[:]))[\s:]*|(?=\[)"),
)
"""What a text is, by the first pattern that its beginning has; the pattern is not part of the code."""


def code_kind(text: str) -> str | None:
    """What code a text is in: "PD code", "DT code", "Gauss code", "braid word", and so on, or None.

    >>> [code_kind(text) for text in ("[(3,2)(21,2)]", "[(1,5,2,4),(3,1,4,6),(5,3,6,2)]", "reef")]
    ['Conway code', 'PD code', None]
    """
    if _has_rows_of_four(text):
        return "PD code"
    return next((kind for kind, pattern in _KINDS if re.match(pattern, text.strip(), re.I)), None)


def _has_rows_of_four(text: str) -> bool:
    """Whether a text is a list of round brackets, one of them with four labels."""
    if not re.fullmatch(rf"\[\s*{_ROW}(\s*,\s*{_ROW})*\s*(,\s*)?\]?", text.strip()):
        return False
    return any(len(_words(row.strip("() "))) == 4 for row in re.findall(_ROW, text))


def leaves_mirror_open(text: str) -> bool:
    """Whether a code leaves open the mirror image of each summand: DT codes and Gauss codes without signs.

    >>> [leaves_mirror_open(text) for text in ("DT: 4 6 2", "O1U2O3U1O2U3", "O1+ U1+", "[3 2]")]
    [True, True, False, False]
    """
    kind = code_kind(text)
    unsigned = not re.search(r"[OU]\d+\s*[+-]", text, re.I)
    return kind == "DT code" or (kind == "Gauss code" and unsigned)


def from_text(text: str) -> Diagram:
    """The diagram of a code given as text, of at most 500 crossings and strands.

    >>> from_text("X[1,5,2,4] X[3,1,4,6] X[5,3,6,2]").signs
    (1, 1, 1)
    >>> [from_text(code).n_crossings for code in ("{1,-2,1,-2}", "DT: [4,6,2]", "[3 2]")]
    [4, 3, 5]

    Raises:
        TorsadeError: text in none of these forms, a code that is too large, or one that `from_pd` or its
            like refuses.
    """
    kind = code_kind(text)
    if kind is None:
        raise TorsadeError(f"{quoted(text)} is no code; begin with {BEGINNINGS}")
    if len(text) > LONGEST:
        raise TorsadeError(f"the {kind} has {len(text)} characters; give at most {LONGEST}")
    pattern = dict(_KINDS)[kind]
    body = re.sub(f"^(?:{pattern})", "", text.strip(), count=1, flags=re.I).strip()
    _check_brackets(body, kind)
    if kind == "Conway code" and body == text.strip():
        _check_list(body)
    return _READERS[kind](body, kind)


def _check_brackets(body: str, kind: str) -> None:
    """Refuse brackets that are not closed, or close nothing."""
    waiting: list[str] = []
    for sign in re.findall(r"[\[\](){}]", body):
        if sign in "[({":
            waiting.append("])}"["[({".index(sign)])
        elif not waiting or sign != waiting.pop():
            raise TorsadeError(
                f"the {kind} {quoted(body)} has a {sign!r} that closes no bracket; take it away"
            )
    if waiting:
        raise TorsadeError(f"the {kind} {quoted(body)} has a bracket that is not closed; close it")


def _check_list(body: str) -> None:
    """Refuse a bare list that other tables would give as a DT or Gauss code or as a braid."""
    words = [word.strip() for word in body.strip("[] ").split(",")]
    if len(words) < 2 or not all(map(_is_integer, words)):
        return
    numbers = [int(word) for word in words]
    sizes = sorted(map(abs, numbers))
    for what, sign, is_one in (
        ("a DT code", "DT:", sizes == list(range(2, 2 * len(sizes) + 1, 2))),
        ("a Gauss code", "Gauss:", sorted(numbers) == sorted(-k for k in numbers)),
        ("a braid", "braid:", 1 in sizes),
    ):
        if is_one:
            raise TorsadeError(
                f"{quoted(body)} may be {what} or Conway notation; say which with {sign} or C before it"
            )


def _pd(body: str, kind: str) -> Diagram:
    body = re.sub(r"X\s*_", "X", body, flags=re.I).translate(_AS_BRACKETS)
    rows = re.findall(r"\[([^\[\]]*)\]", body)
    if not rows and re.sub(r"[\s\[\]]", "", body):
        raise TorsadeError(f"the {kind} {quoted(body)} has no crossing in brackets; give such as X[1,5,2,4]")
    left = re.sub(r"\[[^\[\]]*\]", "", body)
    strange = re.sub(r"[X\s,;\[\]]", "", left, flags=re.I)
    if strange:
        raise TorsadeError(
            f"{quoted(strange)} in the {kind} is not understood; give crossings such as [1,5,2,4]"
        )
    labels = [_words(row) for row in rows if row.strip()]
    limited(len(labels), "crossings", kind)
    wrong = [
        word for row in labels for word in row if not re.fullmatch(r"\+?\d{1,9}|[a-z]+\d{1,9}", word, re.I)
    ]
    if wrong:
        raise TorsadeError(
            f"the label {quoted(wrong[0])} in the {kind} is no whole number; give such, or names such as A3 "
            "in a tangle"
        )
    times = Counter(word for row in labels for word in row)
    once = [word for word in times if times[word] == 1 and _is_integer(word)]
    if once and all(len(row) == 4 for row in labels):
        raise TorsadeError(
            f"label {once[0]} occurs once in the {kind}; give it twice, or name the edges of a tangle "
            "A0, A1 ..."
        )
    return from_pd([[int(word) if _is_integer(word) else word for word in row] for row in labels])


def _dt(body: str, kind: str) -> Diagram:
    return from_dt(_rows(body, kind, "4 6 2"))


def _gauss(body: str, kind: str) -> Diagram:
    if not re.search(r"[OU]", body, re.I):
        return from_gauss(_rows(body, kind, "-1 2 -3 1 -2 3", passages=2))
    code = body.strip("[](){} ").upper()
    strands = code.split("|")
    limited(len(strands), "strands", kind)
    limited(len(re.findall(r"[OU]", code)) // 2, "crossings", kind)
    if re.search(r"\d\s*[+-]", code):
        return from_gauss(code)
    passages = [re.sub(r"(?<=\d)(?=[OU])", " ", strand).replace(",", " ").split() for strand in strands]
    wrong = [word for strand in passages for word in strand if not re.fullmatch(r"[OU]\d{1,9}", word, re.A)]
    if wrong:
        raise TorsadeError(
            f"{quoted(wrong[0])} in the {kind} is not understood; give passages such as O1+ U2+, or all "
            "without signs"
        )
    return from_gauss([[int(word[1:]) * (-1 if word[0] == "O" else 1) for word in s] for s in passages])


def _braid(body: str, kind: str) -> Diagram:
    counted = re.fullmatch(r"[\[(]\s*(\d{1,9})\s*,\s*[\[({]([^\[\](){}]*)[\])}]\s*[\])]", body, re.A)
    letters = _integers(counted[2] if counted else body.strip("{}[]() "), kind, "1 -2 1 -2")
    limited(len(letters), "crossings", kind)
    return from_braid(letters, int(counted[1]) if counted else None)


def _conway(body: str, kind: str) -> Diagram:
    return from_conway(body)


_READERS: dict[str, Callable[[str, str], Diagram]] = {
    "PD code": _pd,
    "DT code": _dt,
    "Gauss code": _gauss,
    "braid word": _braid,
    "Conway code": _conway,
}

_AS_BRACKETS = str.maketrans("(){}", "[][]")


def _rows(body: str, kind: str, example: str, passages: int = 1) -> list[int] | list[list[int]]:
    """One list of integers, or several where there are inner brackets; so many numbers for each crossing."""
    inner = re.findall(r"\[([^\[\]]*)\]", body.translate(_AS_BRACKETS))
    rows = [_integers(row, kind, example) for row in inner if len(inner) > 1]
    numbers = [] if rows else _integers(body.strip("[]{}() "), kind, example)
    limited(len(rows), "strands", kind)
    limited((sum(map(len, rows)) + len(numbers)) // passages, "crossings", kind)
    if not rows and not numbers:
        raise TorsadeError(f"the {kind} is empty; give integers such as {example}")
    return rows or numbers


def _integers(text: str, kind: str, example: str) -> list[int]:
    words = _words(text)
    wrong = [word for word in words if not _is_integer(word)]
    if wrong:
        raise TorsadeError(f"{quoted(wrong[0])} in the {kind} is no integer; give integers such as {example}")
    return [int(word) for word in words]


def _words(text: str) -> list[str]:
    return [word for word in re.split(r"[\s,;]+", text) if word]


def _is_integer(word: str) -> bool:
    return re.fullmatch(r"[+-]?\d{1,9}", word, re.A) is not None

"""From a name to an entry of the catalogue: `find`, and `search` for part of a name."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

from torsade.errors import TorsadeError, counted, quoted
from torsade.knots.entries import KINDS, Entry, entries, strand_knot, suture, torus
from torsade.topology.codes import code_kind, from_text
from torsade.topology.diagram import Diagram
from torsade.topology.named import COMMON_NAMES, looks_like_a_name, named_diagram
from torsade.topology.table import contents
from torsade.topology.tangle import cut

__all__ = [
    "bend_diagram",
    "bend_names",
    "find",
    "interpret",
    "known_bend",
    "known_closed",
    "known_strand",
    "search",
]

_SUTURE = r"\(?\s*([+-]?\d{1,6})\s*,\s*([+-]?\d{1,6})\s*\)?"

LONGEST_NAME = 5000
"""Longest name [characters], of a sum of 500 knots."""

LARGEST = 99
"""Largest number in the name of a torus knot or an overhand knot."""


def find(name: str) -> Entry:
    """The entry that a name or alias stands for, upper and lower case and the marks between words aside.

    Known are the names that `search` lists, and

    - knots and links of the table, with m before them for the mirror image and # between summands: m3_1#4_1;
    - T(p,q), torus knots and links;
    - "overhand-9" and other odd numbers: an overhand knot with so many crossings, in one strand;
    - "open 5_2": a closed knot cut open;
    - two odd numbers such as 5,-3: a suture;
    - "mirror reef": the mirror image of anything.

    >>> entry = find("Thief knot")
    >>> entry.name, entry.pulled, entry.diagram.n_crossings
    ('thief', 'A1B0', 6)

    Raises:
        TorsadeError: nothing is called so; the sentence says which name is nearest.
    """
    text = name.strip()
    if len(text) > LONGEST_NAME:
        raise TorsadeError(f"a name of {len(text)} characters is given; give at most {LONGEST_NAME}")
    plain = _plain(text)
    if plain in _known():
        return _known()[plain]
    if match := re.fullmatch(r"mirror(?: image)?(?: of)?(?: the)? (.+)", plain):
        if match[1].startswith("mirror "):
            raise TorsadeError(
                f"{quoted(text)} is mirrored more than once; give mirror once, or leave it out"
            )
        rest = match[1] if match[1] in _known() else text[-len(match[1]) :]
        if len(rest) >= len(text):  # some letters are two in lower case
            raise TorsadeError(_unknown(text))
        return _mirrored(find(rest))
    found = _by_pattern(text)
    if found is None:
        raise TorsadeError(_unknown(text))
    return found


def interpret(text: str) -> Entry:
    """The entry of a name, or of a code as `torsade.topology.from_text` reads it.

    >>> interpret("{1,-2,1,-2}").diagram.n_crossings
    4

    Raises:
        TorsadeError: it is neither, or a code that cannot be read.
    """
    code = text.strip()
    kind = code_kind(code)
    if kind is not None:
        diagram = from_text(code)
        return Entry(code, kind, kind, lambda: diagram, source="given")
    listed = re.fullmatch(r"[\d\s,;()+-]+", code) and not re.fullmatch(_SUTURE, code)
    if listed and not _in_table(code):
        raise TorsadeError(
            f"{quoted(code)} is a list of numbers; say which code it is, such as 'DT: 4 6 2', "
            "'braid: 1 -2 1 -2' or 'Gauss: -1 2 -3 1 -2 3'"
        )
    return find(code)


def search(text: str = "", kind: str | None = None) -> tuple[Entry, ...]:
    """All entries with a text in their name, title or aliases; all there are for an empty text.

    >>> [entry.name for entry in search("fisher")]
    ['fisherman', 'double_fisherman']

    Raises:
        TorsadeError: the kind is none of `KINDS`.
    """
    if kind is not None and kind not in KINDS:
        raise TorsadeError(f"there is no kind {quoted(kind)}; choose one of {', '.join(KINDS)}")
    plain = _plain(text)
    return tuple(
        entry
        for entry in entries()
        if kind in (None, entry.kind)
        and any(plain in _plain(word) for word in (entry.name, entry.title, *entry.aliases))
    )


def bend_names() -> tuple[str, ...]:
    """Every name that stands for a bend and its pulled ends."""
    return tuple(entry.name for entry in entries() if entry.kind == "bend")


def bend_diagram(name: str) -> Diagram:
    """The diagram of a bend, its strands running towards the ends that the name pulls.

    >>> from torsade.topology import state
    >>> reef, thief = state(bend_diagram("reef")), state(bend_diagram("thief"))
    >>> (reef.crossings, reef.tau, reef.gamma), (thief.crossings, thief.tau, thief.gamma)
    ((6, 1.0, 4.0), (6, 1.0, 1.0))

    Raises:
        TorsadeError: no bend is called so.
    """
    entry = find(name)
    if entry.kind not in ("bend", "variant"):
        raise TorsadeError(
            f"{quoted(name)} is no bend, but {entry.title}; choose one of {', '.join(bend_names())}"
        )
    return entry.diagram.pulled(str(entry.pulled))


def known_bend(name: str) -> Entry:
    """The entry of a knot of two strands.

    Raises:
        TorsadeError: nothing is called so, or what is has not two strands with ends.
    """
    entry = interpret(name)
    if len(entry.diagram.ends) == 4:
        return entry
    advice = "choose one that torsade knots list --kind bend shows, such as zeppelin"
    if len(entry.diagram.ends) == 2:
        advice = f"give torsade run tighten --knot {_word(entry.name)}, or a bend such as zeppelin"
    raise TorsadeError(f"{quoted(name)} is {_what(entry)}, and a bend has two strands with ends; {advice}")


def known_strand(name: str) -> Entry:
    """The entry of a knot in one strand.

    Raises:
        TorsadeError: nothing is called so, or what is has not one strand with two ends.
    """
    entry = interpret(name)
    if len(entry.diagram.ends) == 2:
        return entry
    advice = "choose one that torsade knots list --kind strand shows, such as overhand"
    if len(entry.diagram.ends) == 4:
        advice = f"give torsade run prison-escape --knot {_word(entry.name)}"
    elif entry.kind == "closed":
        advice = f"give 'open {entry.name}' for it cut open"
    raise TorsadeError(f"{quoted(name)} is {_what(entry)}, and one strand with two ends is wanted; {advice}")


def known_closed(name: str) -> str:
    """The name of a closed knot in the table, where it has one, from a name or a code.

    >>> known_closed("trefoil"), known_closed("unknot")
    ('3_1', '0_1')

    Raises:
        TorsadeError: nothing is called so, or what is has ends or more than one strand.
    """
    entry = interpret(name)
    if entry.diagram.ends or len(entry.diagram.strands) != 1:
        raise TorsadeError(
            f"{quoted(name)} is {_what(entry)}, and one closed strand is wanted; give a knot such as 4_1, or "
            "unknot for a ring"
        )
    return COMMON_NAMES.get(entry.name, entry.name)


def _word(name: str) -> str:
    """A name as it is typed in a shell."""
    return repr(name) if re.search(r"[^\w,-]", name) else name


def _what(entry: Entry) -> str:
    """What an entry is, with its article."""
    words = {
        "closed": "a closed knot",
        "strand": "a knot in one strand",
        "variant": "a bend",
        "torus": "closed",
    }
    if entry.kind in KINDS:
        return words.get(entry.kind, f"a {entry.kind}")
    return f"a {entry.kind} of {counted(len(entry.diagram.ends) // 2, 'open strand')}"


@lru_cache(maxsize=1)
def _known() -> Mapping[str, Entry]:
    """Entries by all words for them; of two that share a word the kind that comes first here has it."""
    known: dict[str, Entry] = {}
    kinds = ("strand", "closed", "link", "bend", "suture", "torus", "variant")
    for entry in sorted(entries(), key=lambda entry: kinds.index(entry.kind)):
        by_rule = entry.kind in ("suture", "torus")  # their names are numbers, and signs count
        words = [_plain(word) for word in (*(() if by_rule else (entry.name,)), *entry.aliases)]
        for word in words:
            known.setdefault(word, entry)
        for word in words:
            for ending in {"bend": ("bend", "knot"), "link": ("link", "rings")}.get(entry.kind, ("knot",)):
                known.setdefault(f"{word} {ending}", entry)
        for number in entry.abok:
            known.setdefault(f"abok {number.lower()}", entry)
    return MappingProxyType(known)


def _plain(name: str) -> str:
    """A name without case, apostrophes and what separates words."""
    return re.sub(r"[\s_\-]+", " ", re.sub(r"['’]", "", name.lower())).strip()


def _mirrored(entry: Entry) -> Entry:
    return replace(
        entry,
        name=f"mirror {entry.name}",
        title=f"{entry.title}, mirror image",
        draw=lambda: entry.diagram.mirror(),
        aliases=(),
    )


def _by_pattern(text: str) -> Entry | None:
    """Names that are made by a rule."""
    if match := re.fullmatch(r"T\s*\(?\s*([+-]?\d{1,9})\s*[,;]\s*([+-]?\d{1,9})\s*\)?", text, re.I | re.A):
        p, q = int(match[1]), int(match[2])
        if not (
            p
            and q
            and max(abs(p), abs(q)) <= LARGEST
            and (min(abs(p), abs(q)) - 1) * max(abs(p), abs(q)) < 1000
        ):
            raise TorsadeError(
                f"{quoted(text)} is asked for; give T(p,q) with p and q not 0 and fewer than 1000 crossings"
            )
        return torus(p, q)
    if match := re.fullmatch(r"overhand[\s_-]*(\d{1,9})", text, re.I | re.A):
        n = int(match[1])
        if n % 2 == 0 or not 3 <= n <= LARGEST:
            raise TorsadeError(
                f"an overhand knot of {n} crossings is asked for; give an odd number from 3 to {LARGEST}"
            )
        return _overhand(n)
    if match := re.fullmatch(_SUTURE, text, re.A):
        return suture(int(match[1]), int(match[2]))
    if match := re.fullmatch(r"open[\s_-]+(.+)", text, re.I):
        if re.search(r"\bopen ", _plain(match[1])):
            raise TorsadeError(f"{quoted(text)} is cut open more than once; give open once")
        closed = find(match[1])
        if closed.kind != "closed":
            raise TorsadeError(
                f"{quoted(match[1])} is not a closed knot; give one of the table, such as open 5_2"
            )
        return strand_knot(f"open {closed.name}", closed.name)
    if looks_like_a_name(text):
        named_diagram(text)  # refuses what is not in the table
        kind = "link" if "L" in text else "closed"
        title = f"{'Link' if kind == 'link' else 'Knot'} {text}"
        return Entry(text, kind, title, lambda: named_diagram(text), source="the tables of knots and links")
    return None


def _overhand(n: int) -> Entry:
    wound = torus(2, n)
    return replace(
        strand_knot(f"overhand-{n}", "3_1", {"title": f"Overhand knot of {n} crossings"}),
        draw=lambda: cut(wound.diagram),
        source=f"closed braid {wound.name}, cut open",
    )


def _in_table(text: str) -> list[str]:
    """Knots of the table that a text with other marks may mean: 3_1 for 31, 3.1 or K3_1, m3_1 for 3_1m."""
    found = re.fullmatch(r"(m?)k?(\d{1,5})(?:[\s._-]+(\d{1,3}))?(m?)", text.strip().lower(), re.A)
    if found is None:
        return []
    m, digits, rest, after = found.groups()
    splits = [(digits, rest)] if rest else [(digits[:k], digits[k:]) for k in (1, 2)]
    names = [f"{crossings}_{number}" for crossings, number in splits]
    return [f"{m or after}{name}" for name in names if name in contents()["knots"]]


def _unknown(name: str) -> str:
    """What to say of a name that is not known."""
    words = [word for word in _known() if re.search(r"[a-z]{3}", word)]  # near a number is any other
    near = _in_table(name) or difflib.get_close_matches(_plain(name), words, n=1, cutoff=0.7)
    hint = f"did you mean {' or '.join(map(repr, near))}? " if near else ""
    return (
        f"nothing is called {quoted(name)}; {hint}give a name that torsade knots list shows, such as reef, "
        "overhand, 3_1, m3_1#4_1, L5a1 or T(3,4), or a code"
    )

"""The catalogue: what there is by name, as data files say it. See `catalogue/README.md`."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from importlib.resources import files
from math import gcd
from types import MappingProxyType
from typing import Any

from torsade.knots.bends import bends
from torsade.knots.sutures import suture_diagram
from torsade.topology.codes import from_braid
from torsade.topology.diagram import Diagram
from torsade.topology.named import COMMON_NAMES, named_diagram
from torsade.topology.table import contents
from torsade.topology.tangle import cut

__all__ = ["KINDS", "Entry", "entries", "facts", "strand_knot", "suture", "torus", "variants"]

KINDS = MappingProxyType(
    {
        "bend": "two strands, tied by name",
        "strand": "a knot in one strand with two ends",
        "suture": "two throws on each other",
        "closed": "a prime knot through 10 crossings",
        "link": "a prime link through 8 crossings",
        "torus": "a torus knot or link T(p,q)",
        "variant": "a bend and its pulled ends, as chapter 4 of the thesis labels them",
    }
)
"""Kinds of entries, and what they are."""

STANDING = "A1B1"
SUTURES = MappingProxyType(
    {
        (5, -3): ("surgeon's knot", "surgeon"),
        (5, 3): ("surgeon's granny",),
        (3, -5): ("reversed surgeon's knot",),
        (5, -5): ("double surgeon's knot",),
    }
)
"""Names of sutures besides their numbers of half turns."""

TORUS = ((2, 3), (2, 4), (2, 5), (2, 7), (2, 9), (3, 3), (3, 4), (3, 5), (4, 4), (4, 5), (5, 4))


@dataclass(frozen=True)
class Entry:
    """Something that has a name.

    Attributes:
        name: which finds it.
        kind: one of `KINDS`.
        title: its name in full.
        draw: makes its diagram.
        aliases: other names.
        pulled: the clamped and the pulled end, of a knot with ends.
        pulls: what it is called when pulled by each two ends.
        abok: its numbers in The Ashley Book of Knots, where they are certain.
        source: where its code is from.
        certainty: how sure it is that the code is this knot, where that is a question.
    """

    name: str
    kind: str
    title: str
    draw: Callable[[], Diagram] = field(compare=False)
    aliases: tuple[str, ...] = ()
    pulled: str | None = None
    pulls: Mapping[str, str] = field(default_factory=dict)
    abok: tuple[str, ...] = ()
    source: str = ""
    certainty: str = ""

    @property
    def diagram(self) -> Diagram:
        """The diagram as its code has it; strands run from their end 0 to their end 1."""
        return self.draw()


@lru_cache(maxsize=1)
def entries() -> tuple[Entry, ...]:
    """Everything that can be listed; `torsade.knots.find` knows more: sums, other torus knots and sutures."""
    sutures = (suture(s * bottom, top) for s in (1, -1) for bottom in (3, 5, 7) for top in (3, 5, -3, -5))
    wound = (torus(p, q) for p, q in TORUS)
    listed = (*_bends(), *_strands(), *sutures, *wound, *_closed(), *_links())
    names = {entry.name for entry in listed}  # reef, thief, granny and grief are labels of the thesis too
    return (*listed, *(entry for label, entry in variants().items() if label not in names))


def facts(name: str) -> Mapping[str, Any]:
    """What is known of a closed knot of the table besides its code: `catalogue/closed.json`."""
    known: Mapping[str, Any] = _data("closed").get(name, {})
    return known


@lru_cache(maxsize=4)
def _data(name: str) -> dict[str, Any]:
    text = files("torsade.knots").joinpath(f"catalogue/{name}.json").read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(text)
    return found


def _bends() -> Iterator[Entry]:
    for name, bend in bends().items():
        about = (bend.pulls, bend.abok, bend.source, bend.certainty)
        draw = partial(_drawn, bend.diagram)
        yield Entry(name, "bend", bend.title, draw, bend.aliases, STANDING, *about)
        for words, pulled in bend.other_pulls.items():
            word, *others = words.split(", ")
            title = f"{word.capitalize()} knot: {bend.title.lower()} pulled by {pulled}"
            yield Entry(word, "bend", title, draw, tuple(others), pulled, *about)


def _drawn(diagram: Diagram, mirrored: bool = False) -> Diagram:
    return diagram.mirror() if mirrored else diagram


def strand_knot(name: str, closure: str, row: Mapping[str, Any] = MappingProxyType({})) -> Entry:
    """A closed knot, by its name, cut open."""
    return Entry(
        name,
        "strand",
        row.get("title", f"{closure}, cut open"),
        lambda: cut(named_diagram(closure)),
        tuple(row.get("aliases", ())),
        "A0A1",
        abok=tuple(row.get("abok", ())),
        source=f"closed knot {closure}, cut open",
    )


def _strands() -> Iterator[Entry]:
    for name, row in _data("strands").items():
        yield strand_knot(name, row["closure"], row)


def suture(bottom: int, top: int) -> Entry:
    """Two throws of half turns, the bottom one first."""
    aliases = SUTURES.get((bottom, top), ())
    hands = ["right-handed" if turns > 0 else "left-handed" for turns in (bottom, top)]
    first = f"{abs(bottom)} {hands[0]}" if hands[0] != hands[1] else str(abs(bottom))
    return Entry(
        f"{bottom},{top}",
        "suture",
        f"Suture of {first} and {abs(top)} {hands[1]} half turns" + (f": {aliases[0]}" if aliases else ""),
        partial(suture_diagram, bottom, top),
        aliases,
        STANDING,
        source="thesis, chapter 6",
    )


def torus(p: int, q: int) -> Entry:
    """T(p, q) as a closed braid; right-handed if p and q have the same sign."""
    right = (p > 0) == (q > 0)
    p, q = abs(p), abs(q)
    word = [k if right else -k for k in range(1, p)] * q
    what = "knot" if gcd(p, q) == 1 else "link"
    hand = "right" if right else "left"
    return Entry(
        f"T({p},{q if right else -q})",
        "torus",
        f"Torus {what}, {hand}-handed, {p} strands around {q} times",
        lambda: from_braid(word, p),
        source="closed braid",
    )


def _closed() -> Iterator[Entry]:
    yield Entry("0_1", "closed", "Unknot", Diagram.circle, ("unknot",), source="a circle")
    for name in contents()["knots"]:
        yield _tabulated(name, "closed", "Knot", "KnotInfo")


def _links() -> Iterator[Entry]:
    for name in contents()["links"]:
        yield _tabulated(name, "link", "Link", "Thistlethwaite's table")


def _tabulated(name: str, kind: str, what: str, source: str) -> Entry:
    aliases = tuple(word for word, known in COMMON_NAMES.items() if known == name)
    title = f"{what} {name}" + (f": {aliases[0]}" if aliases else "")
    return Entry(name, kind, title, partial(named_diagram, name), aliases, source=source)


@lru_cache(maxsize=1)
def variants() -> Mapping[str, Entry]:
    """The 22 pulled bends of the thesis's chapter 4, by its labels."""
    found: dict[str, Entry] = {}
    for label, row in _data("variants").items():
        bend, mirrored = bends()[row["bend"]], bool(row.get("mirror"))
        found[label] = Entry(
            label,
            "variant",
            f"{bend.title} pulled by {row['pulled']}" + (", mirror image" if mirrored else ""),
            partial(_drawn, bend.diagram, mirrored),
            pulled=row["pulled"],
            pulls=bend.pulls,
            source="thesis, chapter 4",
            certainty=bend.certainty,
        )
    return MappingProxyType(found)

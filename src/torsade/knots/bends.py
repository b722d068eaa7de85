"""The catalogue of bends as diagrams: two-strand tangles by name, each with the ends that its name pulls.

What is known of each lies in `catalogue/bends.json`; see the README beside it. `torsade.knots.bend` makes
fibers of them.
"""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from types import MappingProxyType

from torsade.errors import TorsadeError, quoted
from torsade.topology.codes import from_gauss
from torsade.topology.diagram import Diagram

__all__ = ["PULLS", "Bend", "bend_diagram", "bend_names", "bends", "find_bend", "usual_name"]

STANDING = "A1B1"

PULLS = ("A1B1", "A1B0", "A0B1", "A0B0")
"""Pairs of ends: the first is clamped, the second pulled."""


@dataclass(frozen=True)
class Bend:
    """A bend of the catalogue.

    Attributes:
        name: its name in the catalogue, such as "alpine_butterfly".
        title: its name in full.
        aliases: other names.
        diagram: strand A from A0 to A1, strand B from B0 to B1.
        pulls: what it is called when pulled by each two ends.
        names_of_pulls: names that stand for it pulled otherwise than by A1 and B1, and by which ends.
        source: how its code was found.
        certainty: how sure it is that the code is this bend.
    """

    name: str
    title: str
    aliases: tuple[str, ...]
    diagram: Diagram
    pulls: Mapping[str, str]
    names_of_pulls: Mapping[str, str]
    source: str
    certainty: str


@lru_cache(maxsize=1)
def bends() -> Mapping[str, Bend]:
    """The catalogue by name."""
    text = files("torsade.knots").joinpath("catalogue/bends.json").read_text(encoding="utf-8")
    return MappingProxyType(
        {
            name: Bend(
                name,
                row["title"],
                tuple(row["aliases"]),
                from_gauss(row["gauss"], closed=False, boundary=row["boundary"].split()),
                MappingProxyType(row["pulls"]),
                MappingProxyType(row.get("names_of_pulls", {})),
                row["source"],
                row["certainty"],
            )
            for name, row in json.loads(text).items()
        }
    )


def bend_names() -> tuple[str, ...]:
    """Every name that stands for a bend and its pulled ends: those of the catalogue, and such as "thief"."""
    found = bends()
    return (*found, *(word for entry in found.values() for word in entry.names_of_pulls))


def find_bend(name: str) -> tuple[Bend, str]:
    """The bend that a name or alias stands for, and the ends that it is pulled by.

    >>> bend, pulled = find_bend("Thief knot")
    >>> bend.name, pulled
    ('reef', 'A1B0')

    Raises:
        TorsadeError: no bend is called so; the sentence says which name is nearest.
    """
    known = _known()
    plain = _plain(name)
    if plain in known:
        return known[plain]
    near = difflib.get_close_matches(plain, known, n=1, cutoff=0.7)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise TorsadeError(f"no bend is called {quoted(name)}; {hint}choose one of {', '.join(bend_names())}")


def usual_name(name: str) -> str:
    """The word of `bend_names` for a name or alias.

    >>> usual_name("Square knot"), usual_name("Bread-bag knot")
    ('reef', 'thief')

    Raises:
        TorsadeError: no bend is called so.
    """
    entry, pulled = find_bend(name)
    return (
        entry.name if pulled == STANDING else next(w for w, p in entry.names_of_pulls.items() if p == pulled)
    )


def bend_diagram(name: str) -> Diagram:
    """The diagram of a bend, its strands running towards the ends that the name pulls.

    >>> from torsade.topology import state
    >>> reef, thief = state(bend_diagram("reef")), state(bend_diagram("thief"))
    >>> (reef.crossings, reef.tau, reef.gamma), (thief.crossings, thief.tau, thief.gamma)
    ((6, 1.0, 4.0), (6, 1.0, 1.0))

    Raises:
        TorsadeError: no bend is called so.
    """
    entry, pulled = find_bend(name)
    return entry.diagram.pulled(pulled)


@lru_cache(maxsize=1)
def _known() -> Mapping[str, tuple[Bend, str]]:
    known: dict[str, tuple[Bend, str]] = {}
    for entry in bends().values():
        known |= {_plain(word): (entry, STANDING) for word in (entry.name, *entry.aliases)}
        known |= {_plain(word): (entry, pulled) for word, pulled in entry.names_of_pulls.items()}
    return MappingProxyType(known)


def _plain(name: str) -> str:
    """A name without case, apostrophes and what separates words, and without "knot" or "bend" at its end."""
    words = re.sub(r"[\s_\-]+", " ", re.sub(r"['’]", "", name.lower())).strip()
    return re.sub(r" (knot|bend)$", "", words)

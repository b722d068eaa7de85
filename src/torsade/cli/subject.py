"""What `torsade topology` is asked about: a file, a code or a name, read into a diagram."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from pathlib import Path

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, quoted
from torsade.files import SUFFIXES, read_centerline
from torsade.knots.bends import bend_names, find_bend
from torsade.knots.sutures import suture_diagram
from torsade.topology.codes import code_kind, from_text
from torsade.topology.diagram import Diagram
from torsade.topology.named import COMMON_NAMES, looks_like_a_name, named_diagram
from torsade.topology.projection import Projection, project

__all__ = ["Subject", "subject"]


@dataclass(frozen=True)
class Subject:
    """What was given, and the diagram that it is.

    Attributes:
        given: the argument as it was typed.
        kind: "bend", "suture", "name", "PD code" and so on, or "centerline".
        title: what it is, in words.
        diagram: strands run as the code or the file has them.
        pulled: the ends that its name pulls; None if it has no name that says so.
        centerline, projection: of a file.
    """

    given: str
    kind: str
    title: str
    diagram: Diagram
    pulled: str | None = None
    centerline: Centerline | None = None
    projection: Projection | None = None


def subject(given: str, length_unit: str = "m") -> Subject:
    """Read the argument of the command; what it is, its form says.

    Raises:
        TorsadeError: it is none of these, or a file or code that cannot be read.
    """
    text = given.strip()
    if not text:
        raise TorsadeError("nothing is given; give a name such as reef or 5_1, a code, or a file of curves")
    if re.match(r"--?[a-z]", text):
        raise TorsadeError(f"topology has no option {quoted(text)}; see torsade topology --help")
    if text.lower().endswith(SUFFIXES) or "/" in text or Path(text).is_file():
        return _file(given, length_unit)
    kind = code_kind(text)
    if kind is not None:
        return Subject(given, kind, kind, from_text(text))
    pair = re.fullmatch(r"\(?\s*([+-]?\d{1,6})\s*,\s*([+-]?\d{1,6})\s*\)?", text, re.A)
    if pair:
        return Subject(given, "suture", "suture", suture_diagram(int(pair[1]), int(pair[2])), "A1B1")
    if re.fullmatch(r"[\d\s,;()+-]+", text):
        raise TorsadeError(
            f"{quoted(text)} is a list of numbers; say which code it is, such as 'DT: 4 6 2', "
            "'braid: 1 -2 1 -2' or 'Gauss: -1 2 -3 1 -2 3'"
        )
    if looks_like_a_name(text):
        return Subject(given, "name", "knot or link", named_diagram(text))
    return _bend(given, text)


def _file(path: str, unit: str) -> Subject:
    centerline = read_centerline(path, unit)
    seen = project(centerline.strands, centerline.closed)
    return Subject(path, "centerline", "centerline", seen.diagram, centerline=centerline, projection=seen)


def _bend(given: str, name: str) -> Subject:
    """A bend; if there is none of this name, the error also knows the words for knots and links."""
    try:
        entry, pulled = find_bend(name)
    except TorsadeError:
        raise TorsadeError(_unknown(name)) from None
    return Subject(given, "bend", entry.title, entry.diagram, pulled)


def _unknown(name: str) -> str:
    words = (*bend_names(), *COMMON_NAMES)
    near = difflib.get_close_matches(re.sub(r"[\s-]+", "_", name.lower()), words, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return (
        f"nothing is called {quoted(name)}; {hint}give a bend ({', '.join(bend_names())}), a knot or link "
        "such as 3_1, m3_1#4_1 or L5a1, a suture such as 5,-3, a code or a file of curves"
    )

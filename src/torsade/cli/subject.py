"""What `torsade topology` is asked about: a file, a code or a name, read into a diagram."""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, quoted
from torsade.files import SUFFIXES, read_centerline
from torsade.knots.bends import bend_names, find_bend
from torsade.knots.sutures import suture_diagram
from torsade.topology.codes import code_kind, from_text
from torsade.topology.diagram import Diagram
from torsade.topology.named import COMMON_NAMES, looks_like_a_name, named_diagram
from torsade.topology.projection import Projection, clearest, project

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


def subject(given: str, length_unit: str = "m", direction: str | None = None) -> Subject:
    """Read the argument of the command; what it is, its form says.

    Args:
        given: what was typed.
        length_unit: of the nodes in a file.
        direction: along which a file is seen: an axis, three numbers, or "fewest".

    Raises:
        TorsadeError: it is none of these, or a file or code that cannot be read.
    """
    text = given.strip()
    if not text:
        raise TorsadeError("nothing is given; give a name such as reef or 5_1, a code, or a file of curves")
    if re.match(r"--?[a-z]", text):
        raise TorsadeError(f"topology has no option {quoted(text)}; see torsade topology --help")
    if text.lower().endswith(SUFFIXES) or "/" in text or Path(text).is_file():
        return _file(given, length_unit, direction)
    if direction is not None:
        raise TorsadeError(
            f"--direction is {direction!r}, but {quoted(text)} is a drawing already; give it with a file"
        )
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


def _file(path: str, unit: str, direction: str | None) -> Subject:
    along = None if direction in (None, "fewest") else _vector(str(direction))
    centerline = read_centerline(path, unit)
    look = clearest if direction == "fewest" else partial(project, direction=along)
    seen = look(centerline.strands, centerline.closed)
    return Subject(path, "centerline", "centerline", seen.diagram, centerline=centerline, projection=seen)


def _vector(text: str) -> tuple[float, ...]:
    """A direction: an axis such as -z, or three numbers."""
    axis = re.fullmatch(r"([+-]?)([xyz])", text.strip().lower())
    if axis:
        return tuple((-1.0 if axis[1] == "-" else 1.0) * (name == axis[2]) for name in "xyz")
    words = [word for word in re.split(r"[\s,()\[\]]+", text) if word]
    try:
        vector = tuple(map(float, words))
    except ValueError:
        vector = ()
    if len(vector) != 3 or not 0 < sum(map(abs, vector)) < math.inf:
        raise TorsadeError(
            f"--direction is {quoted(text)}; give an axis such as z, three numbers such as 1,0,0.5, or fewest"
        )
    return vector


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

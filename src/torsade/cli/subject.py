"""What `torsade topology` is asked about: a file, a code or a name, read into a diagram."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, quoted
from torsade.files import SUFFIXES, read_centerline
from torsade.knots.finding import interpret
from torsade.topology.diagram import Diagram
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
        pulls: what it is called when pulled by each two ends.
        centerline, projection: of a file.
    """

    given: str
    kind: str
    title: str
    diagram: Diagram
    pulled: str | None = None
    pulls: Mapping[str, str] = field(default_factory=dict)
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
    # A file named reef does not stand in the way of the reef.
    if text.lower().endswith(SUFFIXES) or "/" in text or _is_other_file(text):
        return _file(given, length_unit, direction)
    if direction is not None:
        raise TorsadeError(
            f"--direction is {direction!r}, but {quoted(text)} is a drawing already; give it with a file"
        )
    entry = interpret(text)
    pulled = None if entry.kind == "strand" else entry.pulled  # a knot in one strand is pulled at both ends
    return Subject(given, entry.kind, entry.title, entry.diagram, pulled, entry.pulls)


def _is_other_file(text: str) -> bool:
    """Whether a text is the name of a file of another kind, to be told so."""
    return re.fullmatch(r"[^\s]{1,200}\.\w{1,9}", text) is not None and Path(text).is_file()


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

"""What `torsade topology` is asked about: a file, a code or a name, read into a diagram."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, quoted
from torsade.files import SUFFIXES, read_centerline
from torsade.knots.finding import interpret
from torsade.topology.codes import BEGINNINGS, code_kind, leaves_mirror_open
from torsade.topology.diagram import Diagram, strand_name
from torsade.topology.projection import Projection, clearest, project

__all__ = ["Subject", "subject"]

SAME, NEAR = 1e-6, 1.5
"""Ends of a strand nearer than so many edges are meant to be one node, or may be."""


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
        handed: False where a code leaves open the mirror image of each summand.
        notes: what the user may not have meant, a sentence each.
    """

    given: str
    kind: str
    title: str
    diagram: Diagram
    pulled: str | None = None
    pulls: Mapping[str, str] = field(default_factory=dict)
    centerline: Centerline | None = None
    projection: Projection | None = None
    handed: bool = True
    notes: tuple[str, ...] = ()


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
            f"--direction is {quoted(direction)}, but {quoted(text)} is a drawing already; give it with a "
            "file"
        )
    if code_kind(text) is None and re.search(r"[\[\]{}|;:*]", text):
        raise TorsadeError(
            f"{quoted(text)} is no name, and no code that is read here; codes begin with {BEGINNINGS}"
        )
    entry = interpret(text)
    pulled = None if entry.kind == "strand" else entry.pulled  # a knot in one strand is pulled at both ends
    return Subject(
        given,
        entry.kind,
        entry.title,
        entry.diagram,
        pulled,
        entry.pulls,
        handed=not leaves_mirror_open(text),
    )


def _is_other_file(text: str) -> bool:
    """Whether a text names a file of another kind, to be told so; a code may be longer than a name."""
    try:
        return re.fullmatch(r"\S+\.\w{1,9}", text) is not None and Path(text).is_file()
    except OSError:
        return False


def _file(path: str, unit: str, direction: str | None) -> Subject:
    along = None if direction in (None, "fewest") else _vector(str(direction))
    centerline = read_centerline(path, unit)
    notes = tuple(_gaps(path, centerline))
    look = clearest if direction == "fewest" else partial(project, direction=along)
    seen = look(centerline.strands, centerline.closed)
    what = "centerline"
    return Subject(path, what, what, seen.diagram, centerline=centerline, projection=seen, notes=notes)


def _gaps(path: str, centerline: Centerline) -> Iterator[str]:
    """What to say of open strands whose ends lie next to each other.

    Raises:
        TorsadeError: the ends of a strand are one point but for round-off.
    """
    for k, (x, shut) in enumerate(zip(centerline.strands, centerline.closed, strict=True)):
        size = float(np.abs(x).max())
        if shut or len(x) < 3 or not 0 < size < math.inf:
            continue
        longest = float(np.linalg.norm(np.diff(x / size, axis=0), axis=1).max())
        gap = float(np.linalg.norm((x[-1] - x[0]) / size))
        if 0 < gap < SAME * longest:
            raise TorsadeError(
                f"the last node of strand {k} in {path!r} is the first one but for {gap * size:.1g} m; "
                "repeat the first exactly if the strand is closed, or leave the last out if it is open"
            )
        if 0 < gap <= NEAR * longest:
            yield (
                f"the ends of strand {strand_name(k)} are one edge apart; if it is closed, repeat its first "
                "node at the end"
            )


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

"""Files opened and written: regular, of bearable size, line by line, replaced when complete."""

from __future__ import annotations

import io
import math
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, NamedTuple

from torsade.errors import TorsadeError, named, quoted, reason_of
from torsade.places import private, writing

__all__ = [
    "LARGEST_FILE",
    "LONGEST_LINE",
    "NODES",
    "Kind",
    "finite_number",
    "lines",
    "opened",
    "replace_file",
    "whole_number",
]

LARGEST_FILE = 64 * 2**20
"""Largest file read [bytes]: about a million nodes, ten times what a run can use."""

LONGEST_LINE = 2**20
"""Longest line read [characters]: a polyline of 100 000 nodes in one line of an OBJ file."""


class Kind(NamedTuple):
    """What is expected in a file, as messages say it.

    Attributes:
        things: what is in it: "nodes".
        example: the name of such a file: "knot.csv".
        owner: what has so many of them: "a centerline".
        fewer: what to do with too many: "resample it to fewer nodes".
        line: what stands in a line: "one node".
    """

    things: str
    example: str
    owner: str
    fewer: str
    line: str


NODES = Kind("nodes", "knot.csv", "a centerline", "resample it to fewer nodes", "one node")


@contextmanager
def opened(path: Path, kind: Kind = NODES) -> Iterator[tuple[BinaryIO, int]]:
    """A regular file, open to read, and its size [bytes].

    Raises:
        TorsadeError: there is none, it is something else (reading a pipe or a device may never end), it is
            too large, or it cannot be read.
    """
    name = named(path)
    try:
        found = path.stat()
        if stat.S_ISDIR(found.st_mode):
            raise TorsadeError(f"{name} is a directory; give a file of {kind.things}, such as {kind.example}")
        if not stat.S_ISREG(found.st_mode):
            raise TorsadeError(f"{name} is a pipe or a device; give a regular file of {kind.things}")
        if found.st_size > LARGEST_FILE:
            raise TorsadeError(
                f"{name} has {found.st_size / 2**20:.0f} MB, more than the {LARGEST_FILE / 2**20:.0f} MB "
                f"{kind.owner} may have; {kind.fewer}"
            )
        with path.open("rb") as file:
            yield file, found.st_size
    except FileNotFoundError:
        raise TorsadeError(f"there is no file {name}; give the path of a file of {kind.things}") from None
    except (OSError, ValueError) as error:
        if isinstance(error, TorsadeError):
            raise
        raise TorsadeError(f"cannot read {name} ({reason_of(error)}); give a readable file") from None


def lines(path: Path, kind: Kind = NODES) -> Iterator[tuple[str, str]]:
    """Where each line of a text file is, "'knot.csv', line 3", and the line; never much of it in memory.

    Raises:
        TorsadeError: as `opened`; or it is not text in UTF-8, or has a line that does not end.
    """
    name = named(path)
    binary = f"{name} is not a text file; give numbers as text, in UTF-8"
    with opened(path, kind) as (file, _):
        text = io.TextIOWrapper(file, encoding="utf-8-sig", newline=None)
        number = 0
        while True:
            try:
                line = text.readline(LONGEST_LINE + 1)
            except UnicodeDecodeError:
                raise TorsadeError(binary) from None
            if not line:
                return
            number += 1
            if "\0" in line:
                raise TorsadeError(binary)
            if len(line) > LONGEST_LINE:
                raise TorsadeError(
                    f"{name}, line {number} is longer than {LONGEST_LINE} characters; give {kind.line} per "
                    "line"
                )
            yield f"{name}, line {number}", line


def finite_number(cell: str, axis: str, where: str) -> float:
    """A coordinate.

    Raises:
        TorsadeError: it is not a finite number.
    """
    try:
        value = math.nan if "_" in cell else float(cell)
    except ValueError:
        raise TorsadeError(f"{where} has {axis} = {quoted(cell, 40)}; give a number such as 1.5e-3") from None
    if not math.isfinite(value):
        raise TorsadeError(f"{where} has {axis} = {quoted(cell, 40)}; give a finite number")
    return value


def whole_number(cell: str, what: str, where: str) -> int:
    """An index or a count of at most nine digits, negative ones among them.

    Raises:
        TorsadeError: it is something else.
    """
    digits = cell.removeprefix("-")
    if not (digits.isascii() and digits.isdigit() and len(digits) <= 9):
        raise TorsadeError(f"{where} has {what} {quoted(cell, 40)}; give a whole number")
    return int(cell)


def replace_file(path: Path, content: bytes) -> None:
    """Write a file under another name and give it its own when it is complete.

    Raises:
        TorsadeError: it cannot be written, or the path is of something that is no file.
    """
    with writing(path):
        target = path.resolve()  # what a link leads to is replaced, not the link
        if target.exists() and not target.is_file():
            raise TorsadeError(f"{str(path)!r} is not a file; give the name of a file, such as knot.csv")
        new = private(target, "new")
        try:
            new.write_bytes(content)
            new.replace(target)
        finally:
            new.unlink(missing_ok=True)

"""CSV: a header strand,x,y,z and a line for each node."""

from __future__ import annotations

import csv
from pathlib import Path

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, counted, quoted
from torsade.files.gathered import Gathered, rows
from torsade.files.regular import lines

__all__ = ["HEADER", "SEPARATORS", "cells_of", "read", "written"]

HEADER = "strand,x,y,z"
SEPARATORS = ",;\t"


def written(centerline: Centerline) -> bytes:
    """Columns strand, x, y, z, to the last bit; a closed strand ends with its first node."""
    text = ["# centerline nodes [m]; a strand that ends with its first node is closed", HEADER]
    for k, (x, closed) in enumerate(zip(centerline.strands, centerline.closed, strict=True)):
        text += [f"{k},{a!r},{b!r},{c!r}" for a, b, c in rows(x, closed)]
    return ("\n".join(text) + "\n").encode()


def read(path: Path) -> Centerline:
    """Strands numbered 0, 1, 2 ... in the order of the file; lines that begin with # are comments.

    Columns are separated by commas, semicolons or tabs, as in the header.
    """
    separator = ""
    found = Gathered(path)
    for where, line in lines(path):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        if not separator:
            separator = _separator(line, where)
            continue
        cells = cells_of(line, separator, where)
        strand = _strand(cells, where)
        count = len(found.numbers)
        if strand == count:
            found.begin()
        elif strand != count - 1:
            raise TorsadeError(_misplaced(strand, count, where))
        found.add(cells[1:], where)
    if not found.numbers:
        missing = "no nodes" if separator else f"no header {HEADER!r}"
        raise TorsadeError(f"{found.name} has {missing}; give a line {HEADER!r} and then one line per node")
    return found.centerline()


def cells_of(line: str, separator: str, where: str) -> list[str]:
    """The cells of a line, without blanks around them."""
    table = csv.reader([line.strip(" \r\n")], delimiter=separator, strict=True, skipinitialspace=True)
    try:
        return [cell.strip() for cell in next(table)]
    except csv.Error:
        raise TorsadeError(f"{where} cannot be read as CSV; give numbers separated by commas") from None


def _separator(line: str, where: str) -> str:
    """What separates the columns of a header."""
    for separator in SEPARATORS:
        if ",".join(cells_of(line, separator, where)).lower() == HEADER:
            return separator
    raise TorsadeError(
        f"{where} is {quoted(line.strip(), 40)}, not the header; begin with the line {HEADER!r}, with "
        "commas, semicolons or tabs"
    )


def _strand(cells: list[str], where: str) -> int:
    if len(cells) != 4:
        raise TorsadeError(f"{where} has {counted(len(cells), 'column')}; give the four of {HEADER!r}")
    if not (cells[0].isascii() and cells[0].isdigit() and len(cells[0]) <= 9):
        raise TorsadeError(f"{where} has strand {quoted(cells[0], 40)}; give an integer of at least 0")
    return int(cells[0])


def _misplaced(strand: int, count: int, where: str) -> str:
    if strand < count:
        return (
            f"{where} returns to strand {strand} after strand {count - 1}; put the nodes of a strand together"
        )
    return (
        f"{where} begins strand {strand} where strand {count} is due; number the strands 0, 1, 2 ... in order"
    )

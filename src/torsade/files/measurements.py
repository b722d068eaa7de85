"""Tables of measurements: CSV with a heading for each column that names its unit, such as `twist_deg`.

Headings are a name and a unit: `length_mm`, `speed_mm_per_s`, `twist (deg)`, `mass [g]`. Columns may stand in
any order, separated by commas, semicolons or tabs; those that nothing is known of are left alone. A cell that
is empty is a number that is not known. Lines that begin with # are comments.
"""

from __future__ import annotations

import contextlib
import difflib
import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from torsade.errors import QuantityError, TorsadeError, counted, named, quoted
from torsade.files.csv_table import SEPARATORS, cells_of
from torsade.files.regular import Kind, finite_number, lines
from torsade.units import is_bearable, quantity

__all__ = ["MOST_ROWS", "Column", "Row", "Table", "read_table"]

MOST_COLUMNS = 500
MOST_ROWS = 100_000
"""Most lines of a table."""

MOST_NUMBERS = 1000
"""Most numbers in a cell."""


class Column(NamedTuple):
    """A column that is known.

    Attributes
    ----------
    name : its heading, without the unit
    dimension : of its numbers, a name in `units.DIMENSIONS`; "" for text, which has no unit
    unit : an example, as it stands in the heading: "deg"
    required : whether a file must have it
    several : whether a cell may hold several numbers, with blanks, semicolons or + between them
    aliases : other names
    """

    name: str
    dimension: str
    unit: str = ""
    required: bool = False
    several: bool = False
    aliases: tuple[str, ...] = ()

    @property
    def heading(self) -> str:
        """As it may stand in a file."""
        return f"{self.name}_{self.unit}" if self.unit else self.name


Cell = float | str | tuple[float, ...] | None


class Row(NamedTuple):
    """A line of a table.

    Attributes
    ----------
    where : such as "'trials.csv', line 3"
    cells : by the names of columns, in SI units; None where one is not known
    """

    where: str
    cells: dict[str, Cell]


class Table(NamedTuple):
    """What is in a file.

    Attributes
    ----------
    rows : its lines
    columns : names of the columns that it has
    ignored : headings that nothing is known of
    """

    rows: list[Row]
    columns: tuple[str, ...]
    ignored: tuple[str, ...]


class _Heading(NamedTuple):
    """A column of the file: which it is, its heading, and how many SI units its unit is."""

    column: Column
    text: str
    factor: float


def read_table(path: Path, columns: Sequence[Column], kind: Kind) -> Table:
    """Read a table; numbers are in SI units.

    Raises
    ------
    TorsadeError
        When the file cannot be read, a column is missing or given twice, a heading has no unit or a wrong
        one, or a cell is not a number.
    """
    name = named(path)
    headings: list[_Heading | None] = []
    texts: list[str] = []
    separator = ""
    rows: list[Row] = []
    for where, line in lines(path, kind):
        if not line.strip(f"{SEPARATORS} \r\n") or line.lstrip().startswith("#"):
            continue
        if not separator:
            separator = max(SEPARATORS, key=line.count)
            texts = cells_of(line, separator, where)
            if len(texts) > MOST_COLUMNS:
                raise TorsadeError(f"{where} has {len(texts)} headings; give at most {MOST_COLUMNS}")
            headings = _headings(texts, columns, where)
            continue
        if len(rows) == MOST_ROWS:
            raise TorsadeError(f"{name} has more than {MOST_ROWS} lines; give fewer")
        cells = cells_of(line, separator, where)
        if len(cells) != len(headings):
            raise TorsadeError(
                f"{where} has {counted(len(cells), 'column')} where the headings have {len(headings)}; leave "
                "cells empty that are not known, and write decimals with a point"
            )
        rows.append(Row(where, _row(cells, headings, where)))
    if not rows:
        missing = "no lines below its headings" if separator else "nothing in it"
        raise TorsadeError(
            f"{name} has {missing}; give {_asked(columns)} and one line for each of the {kind.things}"
        )
    known = tuple(h.column.name for h in headings if h is not None)
    ignored = tuple(t for t, h in zip(texts, headings, strict=True) if h is None)
    return Table(rows, known, ignored)


def _asked(columns: Sequence[Column]) -> str:
    """The headings to give: "the headings twist_deg,lengths_mm"."""
    needed = [c.heading for c in columns if c.required] or [c.heading for c in columns[:3]]
    return f"the {'heading' if len(needed) == 1 else 'headings'} {','.join(needed)}"


def _headings(texts: Sequence[str], columns: Sequence[Column], where: str) -> list[_Heading | None]:
    """Which column each heading is of."""
    found = [_heading(text, columns, where) for text in texts]
    known = [h for h in found if h is not None]
    for h in known:
        same = [other for other in known if other.column == h.column]
        apart = h.column.several and len({other.text for other in same}) == len(same)
        if len(same) > 1 and not (apart and len({other.factor for other in same}) == 1):
            given = " and ".join(other.text for other in same[:3])
            raise TorsadeError(
                f"{where} has {h.column.name} more than once, as {given}; give it once, in one unit"
            )
    for column in columns:
        if column.required and column not in [h.column for h in known]:
            near = difflib.get_close_matches(column.heading, texts, n=1, cutoff=0.6)
            hint = f"rename {quoted(near[0], 40)} to it" if near else "add it, with the unit in the heading"
            raise TorsadeError(f"{where} has no column {column.heading}; {hint}")
    return found


def _heading(text: str, columns: Sequence[Column], where: str) -> _Heading | None:
    """The column of a heading, or None when nothing is known of it."""
    plain = re.sub(r"\s+", "_", text.strip())
    names = [(name, column) for column in columns for name in (column.name, *column.aliases)]
    for name, column in sorted(names, key=lambda item: -len(item[0])):
        number = r"(?:_?\d+)?" if column.several else ""
        match = re.fullmatch(
            rf"{name}{number}(?:_*[(\[](?P<in>.*)[)\]]|_(?P<after>.*)|)", plain, re.IGNORECASE
        )
        if match is not None:
            return _with_unit(text, match["in"] or match["after"] or "", column, where)
    return None


def _with_unit(text: str, unit: str, column: Column, where: str) -> _Heading | None:
    """A heading whose name is known; None where it is of something else after all."""
    if column.dimension in ("", "number"):
        return None if unit else _Heading(column, text, 1.0)
    if not unit:
        raise TorsadeError(
            f"{where} has the heading {quoted(text, 40)} without a unit; write {column.heading}"
        )
    # A heading all in capitals has a unit in capitals too, which is no unit as it stands.
    for spelt in (unit, unit.lower()) if text.isupper() else (unit,):
        plain = re.sub(r"^per_", "1/", spelt).replace("_per_", "/")
        with contextlib.suppress(QuantityError):
            return _Heading(column, text, quantity(f"1 {plain}", column.dimension))
    raise TorsadeError(
        f"{where} has the heading {quoted(text, 40)}, where {quoted(unit, 20)} is no unit of "
        f"{column.dimension}; write {column.heading}"
    )


def _row(cells: Sequence[str], headings: Sequence[_Heading | None], where: str) -> dict[str, Cell]:
    found: dict[str, Cell] = {}
    for cell, heading in zip(cells, headings, strict=True):
        if heading is None:
            continue
        column = heading.column
        if not cell:
            if column.required:
                raise TorsadeError(f"{where} has no {heading.text}; give a number, or leave the line out")
            found.setdefault(column.name, None)
        elif not column.dimension:
            found[column.name] = cell
        elif column.several:
            parts = [part for part in re.split(r"[\s+|/;]+", cell) if part]
            if len(parts) > MOST_NUMBERS:
                raise TorsadeError(
                    f"{where} has {len(parts)} numbers in {heading.text}; give at most {MOST_NUMBERS}"
                )
            numbers = tuple(_number(part, heading, where) for part in parts)
            before = found.get(column.name)
            found[column.name] = (*(before if isinstance(before, tuple) else ()), *numbers)
        else:
            found[column.name] = _number(cell, heading, where)
    return found


def _number(cell: str, heading: _Heading, where: str) -> float:
    """A number in SI units; what follows it, as a unit may, is said to belong into the heading."""
    with_unit = re.fullmatch(r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([^\W\d_°%]+|°|%)", cell)
    if with_unit and cell.lower().lstrip("+-") not in ("nan", "inf", "infinity"):
        raise TorsadeError(
            f"{where} has {heading.text} = {quoted(cell, 40)}; give the number alone, in the unit of the "
            "heading"
        )
    if re.fullmatch(r"[-+]?\d+,\d+", cell):
        raise TorsadeError(
            f"{where} has {heading.text} = {quoted(cell, 40)}; write decimals with a point, such as "
            f"{cell.replace(',', '.')[:20]}"
        )
    value = heading.factor * finite_number(cell, heading.text, where)
    if not is_bearable(value):
        raise TorsadeError(
            f"{where} has {heading.text} = {quoted(cell, 40)}, beyond what can be computed with; check it"
        )
    return value

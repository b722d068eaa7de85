"""What a figure is: specifications to run, tables of numbers measured on the results, a picture of both."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from torsade.errors import TorsadeError, reason_of

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result
    from torsade.sweep import Catalogue, Sweep

__all__ = ["Cell", "Choice", "Figure", "Preset", "Swept", "Table"]

Cell = float | int | str | bool | None

Preset = Literal["standard", "published"]


@dataclass(frozen=True)
class Choice:
    """What a user chose.

    Attributes
    ----------
    presets : models to run, those whose numbers are shown first, first
    quick : short and coarse runs, for a look: the numbers are not those of the docs
    """

    presets: tuple[Preset, ...] = ("standard", "published")
    quick: bool = False


@dataclass(frozen=True)
class Table:
    """Numbers under headings that say their units, such as `v_m_per_s`; None where one is not known."""

    columns: tuple[str, ...]
    rows: list[tuple[Cell, ...]]

    def __post_init__(self) -> None:
        for row in self.rows:
            assert len(row) == len(self.columns), (self.columns, row)

    def column(self, name: str) -> list[Cell]:
        """All values under a heading."""
        k = self.columns.index(name)
        return [row[k] for row in self.rows]

    def only(self, *names: str) -> Table:
        """The table with these columns alone."""
        at = [self.columns.index(name) for name in names]
        return Table(names, [tuple(row[k] for k in at) for row in self.rows])

    def write(self, path: Path) -> None:
        """Write it as CSV; what is not known stays empty.

        Raises
        ------
        TorsadeError
            When the file cannot be written.
        """
        try:
            with path.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(self.columns)
                writer.writerows([_text(cell) for cell in row] for row in self.rows)
        except OSError as error:
            raise TorsadeError(
                f"cannot write {str(path)!r} ({reason_of(error)}); make room, or give another --out"
            ) from None


def _text(cell: Cell) -> str:
    """A cell as it stands in a file."""
    if cell is None or (isinstance(cell, float) and not math.isfinite(cell)):
        return ""
    return format(cell, ".8g") if isinstance(cell, float) else str(cell)


@dataclass(frozen=True)
class Swept:
    """Many runs of which a figure needs the numbers alone.

    Attributes
    ----------
    name : of their folder
    design : what is run
    measure : numbers → tables by name
    """

    name: str
    design: Callable[[Choice], Sweep]
    measure: Callable[[Catalogue, Choice], Mapping[str, Table]]


@dataclass(frozen=True)
class Figure:
    """A figure of the thesis.

    Attributes
    ----------
    number, title : such as "4-5", and what it shows
    runs : what has to be run, by label
    measure : results by label → tables by name; the one named "" is the main one
    draw : results, tables → a PNG file
    swept : more runs, whose tables come beside those of `measure`
    """

    number: str
    title: str
    runs: Callable[[Choice], Mapping[str, Spec]]
    measure: Callable[[Mapping[str, Result], Choice], Mapping[str, Table]]
    draw: Callable[[Mapping[str, Result], Mapping[str, Table], Choice, Path], None]
    swept: Swept | None = None

    def tables(
        self, results: Mapping[str, Result], catalogue: Catalogue | None, choice: Choice
    ) -> dict[str, Table]:
        """All tables, of runs and of the sweep."""
        found = dict(self.measure(results, choice))
        if self.swept is not None and catalogue is not None:
            found |= self.swept.measure(catalogue, choice)
        return found

    def file(self, folder: Path, table: str | None = None) -> Path:
        """Where its picture goes, or a table of that name."""
        if table is None:
            return folder / f"figure-{self.number}.png"
        return folder / f"figure-{self.number}{'-' if table else ''}{table}.csv"

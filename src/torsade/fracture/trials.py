"""Trials of breaking rods, as a laboratory writes them down: how they are read, and what is refused.

One line is one rod that was broken; docs/fracture-theory.md describes the columns.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from torsade.errors import TorsadeError, counted
from torsade.files.measurements import Column, Row, read_table
from torsade.files.regular import Kind
from torsade.fracture.rod import Rod

__all__ = ["COLUMNS", "TOLERANCE", "Trial", "Trials", "read_trials"]

COLUMNS = (
    Column(
        "lengths",
        "length",
        "mm",
        several=True,
        aliases=("length", "piece_lengths", "piece_length", "fragment_lengths", "fragment_length"),
    ),
    Column("twist", "angle", "deg"),
    Column("end_distance", "length", "mm", aliases=("end_to_end_distance", "end_to_end")),
    Column("end_distance_error", "length", "mm"),
    Column("limit_curvature", "curvature", "per_m"),
    Column("speed", "velocity", "mm_per_s"),
    Column("pieces", "number"),
)
"""What a file of trials may hold; `lengths` or `pieces` it must."""

TRIALS = Kind("trials", "trials.csv", "a table of trials", "split it", "one trial")

TOLERANCE = 0.05
"""By how much of the rod's length pieces may be longer than it together, for they are measured one by one."""

MOST_STRAIN = 0.2
"""Largest strain at the surface, of bending or of twist, that anything which breaks like a rod can have."""

CHECK = "check the unit in the heading and the length of the rod"


@dataclass(frozen=True)
class Trial:
    """One rod that was broken; None where something is not known.

    Attributes
    ----------
    where : in which line of which file
    pieces : number of pieces, flakes no longer than the radius left out
    lengths : of the pieces that were measured, flakes left out [m]
    flakes : how many were left out
    twist : total twist [rad]; without a column for it, 0
    end_distance, end_distance_error : from end to end when it broke [m]
    limit_curvature : largest curvature when it broke, as given [1/m]
    speed : at which the ends approached each other [m/s]
    """

    where: str
    pieces: int
    lengths: tuple[float, ...]
    flakes: int
    twist: float
    end_distance: float | None
    end_distance_error: float
    limit_curvature: float | None
    speed: float | None

    @property
    def smallest(self) -> float | None:
        """Length of the smallest piece that was measured [m]."""
        return min(self.lengths, default=None)


@dataclass(frozen=True)
class Trials:
    """All trials of a file, with the headings that nothing was known of."""

    trials: tuple[Trial, ...]
    columns: tuple[str, ...]
    ignored: tuple[str, ...]


def read_trials(path: str | Path, rod: Rod) -> Trials:
    """Read trials from CSV.

    Parameters
    ----------
    path : of the file
    rod : that was broken: pieces must fit in it

    Raises
    ------
    TorsadeError
        When the file cannot be read, or says what cannot be.
    """
    table = read_table(Path(path), COLUMNS, TRIALS)
    if not {"lengths", "pieces"} & set(table.columns):
        raise TorsadeError(
            f"{str(path)!r} has no column lengths_mm and no column pieces; add one of them: the lengths of "
            "all pieces with blanks between them, or how many there were"
        )
    return Trials(tuple(_trials(table.rows, rod)), table.columns, table.ignored)


def _trials(rows: Iterable[Row], rod: Rod) -> Iterable[Trial]:
    for row in rows:
        lengths = _lengths(row, rod)
        kept = tuple(x for x in lengths if x > rod.h)
        twist = _one(row, "twist")
        limit_curvature = _least(row, "limit_curvature")
        _check_strain(row, "twist", twist, MOST_STRAIN * rod.L / rod.h, math.degrees, "deg")
        _check_strain(row, "limit_curvature", limit_curvature, MOST_STRAIN / rod.h, float, "1/m")
        yield Trial(
            where=row.where,
            pieces=_pieces(row, kept, rod),
            lengths=kept,
            flakes=len(lengths) - len(kept),
            twist=0.0 if twist is None else twist,
            end_distance=_within(row, "end_distance", rod),
            end_distance_error=_least(row, "end_distance_error") or 0.0,
            limit_curvature=limit_curvature,
            speed=_least(row, "speed", above=True),
        )


def _one(row: Row, name: str) -> float | None:
    """A number of a cell."""
    value = row.cells.get(name)
    return value if isinstance(value, float) else None


def _least(row: Row, name: str, above: bool = False) -> float | None:
    """A number that is not negative, or that is above 0."""
    value = _one(row, name)
    if value is not None and (value < 0 or (above and value == 0)):
        allowed = "a number above 0" if above else "0 or more"
        raise TorsadeError(f"{row.where} has {name} = {value:g} in SI units; give {allowed}")
    return value


def _check_strain(
    row: Row, name: str, value: float | None, most: float, shown: Callable[[float], float], unit: str
) -> None:
    """Refuse a twist or a curvature that is above what any rod of this radius bears."""
    if value is not None and abs(value) > most:
        raise TorsadeError(
            f"{row.where} has {name} = {shown(value):.4g} {unit}, and no rod of this length and radius bears "
            f"more than {shown(most):.4g} {unit}; check the unit in the heading"
        )


def _within(row: Row, name: str, rod: Rod) -> float | None:
    """A distance that the ends of the rod can have."""
    value = _least(row, name)
    if value is not None and value > rod.L:
        raise TorsadeError(
            f"{row.where} has {name} = {1e3 * value:g} mm, more than the rod's {1e3 * rod.L:g} mm; {CHECK}"
        )
    return value


def _lengths(row: Row, rod: Rod) -> tuple[float, ...]:
    """Lengths of pieces that can come from the rod."""
    given = row.cells.get("lengths")
    lengths = given if isinstance(given, tuple) else ()
    for x in lengths:
        if x <= 0:
            raise TorsadeError(f"{row.where} has a piece of {1e3 * x:g} mm; give lengths above 0")
        if x > (1 + TOLERANCE) * rod.L:
            raise TorsadeError(
                f"{row.where} has a piece of {1e3 * x:g} mm, longer than the rod of {1e3 * rod.L:g} mm; "
                f"{CHECK}"
            )
    if sum(lengths) > (1 + TOLERANCE) * rod.L:
        raise TorsadeError(
            f"{row.where} has pieces of {1e3 * sum(lengths):g} mm together, longer than the rod of "
            f"{1e3 * rod.L:g} mm; {CHECK}"
        )
    return lengths


def _pieces(row: Row, kept: tuple[float, ...], rod: Rod) -> int:
    """Number of pieces: as given, or as many as there are lengths."""
    given = _one(row, "pieces")
    if given is None:
        if not kept:
            raise TorsadeError(
                f"{row.where} has neither lengths nor pieces; give one of them, or leave it out"
            )
        if len(kept) == 1:
            raise TorsadeError(
                f"{row.where} has the length of one piece and not how many there were; give all lengths, or "
                "how many in a column pieces"
            )
        return len(kept)
    if given != int(given) or given < 2:
        raise TorsadeError(f"{row.where} has pieces = {given:g}; give a whole number from 2, as it broke")
    if len(kept) > given:
        raise TorsadeError(
            f"{row.where} has {len(kept)} lengths above the radius and pieces = {given:g}; give as many "
            "pieces as lengths, or more where some were not measured"
        )
    if len(kept) < given and sum(kept) > (1 - TOLERANCE / 10) * rod.L:
        raise TorsadeError(
            f"{row.where} has pieces = {given:g} and {counted(len(kept), 'length')} that fill the rod of "
            f"{1e3 * rod.L:g} mm already; give as many pieces as lengths"
        )
    return int(given)

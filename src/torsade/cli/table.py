"""The table that a run prints for people."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["print_file", "print_table"]

WIDTH = 24
"""Of the first column: the longest name in it."""


def print_table(result: Result, report: dict[str, Any]) -> None:
    """Print what was done and what came of it."""
    _print((*_asked(result), *_found(report, result.last_held), *_spent(report)))


def print_file(what: str, path: str) -> None:
    """Print where a file of the result is, as a further row of the table."""
    _print([(what, path)])


def _print(rows: Iterable[tuple[str, str]]) -> None:
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True, min_width=WIDTH)
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(name, Text(value))
    Console(highlight=False).print(table)


def _asked(result: Result) -> Iterator[tuple[str, str]]:
    spec = result.spec
    yield "protocol", result.protocol
    yield "knot", str(result.dataset.attrs["knot"])
    yield "preset", spec["preset"]
    yield "force", f"{spec['force']:g} N for {spec['duration']:g} s"


def _found(report: dict[str, Any], held: int) -> Iterator[tuple[str, str]]:
    if "separation_m" in report:
        yield from _escape(report, held)
    else:
        yield from _tightened(report)


def _escape(report: dict[str, Any], held: int) -> Iterator[tuple[str, str]]:
    """Compression and twist are those of the last frame that held."""
    c_f, speed, slipped = (report[k] for k in ("c_f", "pull_speed_m_per_s", "slipped_at_s"))
    yield "topological friction c_f", "not known: the ends did not part" if c_f is None else f"{c_f:.1f}"
    yield "mean pull speed", "not known" if speed is None else f"{1e3 * speed:.2f} mm/s"
    yield "slipped", "no, it holds" if slipped is None else f"at {slipped:.3f} s"
    yield "separation", _span(report["separation_m"], 1e3, "mm")
    yield "compression", f"{report['compression_N'][held]:.0f} N"
    yield "twist", ", ".join(f"{'AB'[k]} {t[held]:+.2f} rad" for k, t in enumerate(report["twist_rad"]))


def _tightened(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    yield "end to end", _span(report["end_to_end_m"], 1e3, "mm")
    yield "length", _span(report["length_m"], 1e3, "mm")
    yield "largest h kappa", f"{report['h_kappa_max'][-1]:.3f}"
    yield "twist", f"{report['total_twist_rad'][-1]:+.3f} rad"
    yield "largest log strain", f"{report['max_log_strain'][-1]:.3f}"


def _spent(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    yield "steps", f"{report['steps']}"
    yield "wall time", f"{report['wall_s']:.1f} s"


def _span(values: list[float], scale: float, unit: str) -> str:
    return f"{scale * values[0]:.2f} to {scale * values[-1]:.2f} {unit}"

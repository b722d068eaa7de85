"""The table that a run prints for people."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from torsade.errors import counted

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["print_file", "print_grid", "print_rows", "print_table"]

WIDTH = 24
"""Of the first column: the longest name in it."""

GUTTER = 2
"""Blanks between columns of a grid."""

SHORTEST_FOLDED = 20
"""Texts in a grid that are longer may be folded."""

_STAGES = ("start", "top", "end")


def print_table(result: Result, report: dict[str, Any]) -> None:
    """Print what was done and what came of it."""
    from torsade.cli import batteries_table, rods_table, sutures_table

    own = rods_table.ROWS | batteries_table.ROWS | sutures_table.ROWS
    if result.protocol in own:
        print_rows(own[result.protocol](result, report))
    else:
        print_rows((*_asked(result), *_found(result, report), *_spent(report)))


def print_file(what: str, path: str) -> None:
    """Print where a file of the result is, as a further row of the table."""
    # In one line, however long, so that it can be copied.
    line = Text.assemble((f"{what:<{WIDTH}}", "bold"), "  ", path)
    Console(highlight=False, soft_wrap=True).print(line)


def print_rows(rows: Iterable[tuple[str, str]]) -> None:
    """Print names and values, a row for each."""
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True, min_width=WIDTH)
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(name, Text(value))
    Console(highlight=False).print(table)


def print_grid(columns: Sequence[str], rows: Iterable[Sequence[float | int | str | bool | None]]) -> None:
    """Print a table under its headings; what is not known is left out.

    A table that is too wide is printed in parts below each other, which begin with the same columns: numbers
    are never folded, long texts are.
    """
    rows = [list(row) for row in rows]
    cells = [[_cell(cell) for cell in row] for row in rows]
    widths = [max(map(cell_len, column)) for column in zip(columns, *cells, strict=True)]
    texts = [all(isinstance(row[k], str | None) for row in rows) for k in range(len(columns))]
    folds = [text and width > SHORTEST_FOLDED for text, width in zip(texts, widths, strict=True)]
    console = Console(highlight=False)
    taken = [SHORTEST_FOLDED if fold else width for fold, width in zip(folds, widths, strict=True)]
    for number, part in enumerate(_parts(taken, console.width)):
        table = Table(box=None, pad_edge=False)
        for k in part:
            table.add_column(columns[k], overflow="fold", no_wrap=not folds[k])
        for row in cells:
            table.add_row(*(Text(row[k]) for k in part))
        if number:
            console.print()
        console.print(table)


def _parts(widths: Sequence[int], room: int) -> Iterator[list[int]]:
    """Which columns of these widths stand side by side; the first ones, which name a row, in all parts."""
    lead, taken = [0], widths[0]
    while len(lead) < len(widths) and taken + GUTTER + widths[len(lead)] <= room / 3:
        taken += GUTTER + widths[len(lead)]
        lead.append(len(lead))
    part, filled = list(lead), taken
    for k in range(len(lead), len(widths)):
        if len(part) > len(lead) and filled + GUTTER + widths[k] > room:
            yield part
            part, filled = list(lead), taken
        part.append(k)
        filled += GUTTER + widths[k]
    yield part


def _cell(cell: float | int | str | bool | None) -> str:
    if cell is None or cell != cell:
        return ""
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)


def _asked(result: Result) -> Iterator[tuple[str, str]]:
    spec, attrs = result.spec, result.dataset.attrs
    yield "protocol", result.protocol
    if "knot" in attrs:
        yield "move" if result.protocol == "reidemeister" else "knot", str(attrs["knot"])
    if "pulled" in attrs:
        yield "pulled", f"{attrs['pulled'][:2]} clamped, {attrs['pulled'][2:]} pulled"
    if "preset" in spec:
        yield "preset", spec["preset"]
    yield "fiber", f"{spec['material']}, radius {1e3 * attrs['radius']:g} mm"
    if "force" in spec:
        yield "force", f"{spec['force']:g} N for {spec['duration']:g} s"


def _found(result: Result, report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    if result.protocol == "prison-escape":
        yield from _escape(report, result.last_held, result.spec["duration"])
    elif result.protocol == "tighten":
        yield from _tightened(report, "until_still" in result.spec)
    elif result.protocol == "bend-twist":
        yield from _bent(report)
    else:
        yield from _moved(report)


def _escape(report: dict[str, Any], held: int, duration: float) -> Iterator[tuple[str, str]]:
    """Compression and twist are those of the last frame that held."""
    c_f, speed, slipped = (report[k] for k in ("c_f", "pull_speed_m_per_s", "slipped_at_s"))
    times = report["times_s"]
    since = f"from {report['c_f_from_s'] or 0:g} s to {slipped or times[-1]:.3g} s"
    yield "topological friction c_f", "not known: the ends did not part" if c_f is None else f"{c_f:.1f}"
    yield "mean pull speed", "not known" if speed is None else f"{1e3 * speed:.2f} mm/s, {since}"
    yield "slipped", f"no, not within {duration:g} s" if slipped is None else f"at {slipped:.3f} s"
    yield "separation", _span(report["separation_m"], times)
    at = f"at {times[held]:.3g} s"
    yield "compression", f"{report['compression_N'][held]:.0f} N {at}"
    twist = ", ".join(f"{'AB'[k]} {t[held]:+z.2f} rad" for k, t in enumerate(report["twist_rad"]))
    yield "twist", f"{twist} {at}"
    yield "turned about the pull", f"{report['rotation_rad'][held]:+z.2f} rad {at}"


def _tightened(report: dict[str, Any], awaited: bool) -> Iterator[tuple[str, str]]:
    times, still = report["times_s"], report["still_at_s"]
    at = f"at {times[-1]:.3g} s"
    if awaited:
        yield "still", f"no, not within {times[-1]:g} s" if still is None else f"at {still:.3g} s"
    yield "end to end", _span(report["end_to_end_m"], times)
    yield "length", _span(report["length_m"], times)
    yield "largest h kappa", f"{report['h_kappa_max'][-1]:.3f} {at}"
    yield "twist", f"{report['total_twist_rad'][-1]:+z.3f} rad {at}"
    yield "largest log strain", f"{report['max_log_strain'][-1]:.3f} {at}"


def _moved(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Energies in units of B/L, bending stiffness over free length, beyond those of strands lying apart."""
    unit, crossings = report["B_over_L_J"], report["crossings"]
    start, top, end = ((report[f"energy_{k}_J"] - report["energy_apart_J"]) / unit for k in _STAGES)
    way = 1e3 * report["displacement_m"][-1]
    yield "strands", f"{1e3 * report['length_m']:g} mm from grip to grip, ends {report['ends']}"
    yield "way of moved ends", f"{way:.2f} mm in {report['times_s'][-1]:g} s"
    yield "crossings", f"{crossings[0]} at the start, {crossings[-1]} at the end"
    yield "unit of energy B/L", f"{unit:.3g} J"
    yield "energies", "beyond those of the same strands lying apart"
    yield "energy at the start", f"{start:z.3f} B/L"
    yield "highest energy", f"{top:z.3f} B/L, after {1e3 * report['top_at_m']:.2f} mm"
    yield "energy at the end", f"{end:z.3f} B/L"


def _bent(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Lengths in mm, as they are measured on a table."""
    turned, span = math.degrees(report["end_rotation_rad"]), report["kappa_max_range_per_m"]
    within = "" if span is None else f", between {span[0]:.4g} and {span[1]:.4g} 1/m"
    yield "length", f"{1e3 * report['length_m']:g} mm, ends {1e3 * report['end_distance_m']:g} mm apart"
    yield "twist", f"{math.degrees(report['twist_rad']):g} deg; grips turned by {turned:.2f} deg"
    yield "largest curvature", f"{report['kappa_max_per_m']:.5g} 1/m{within}"
    yield "curvature at the ends", f"{report['kappa_end_per_m']:.4g} 1/m"
    yield "thrust", f"{report['thrust_N']:.4g} N"
    yield "out of plane", f"{1e3 * report['out_of_plane_m']:.4g} mm"
    yield "torque", f"{report['torque_N_m']:.4g} N m"
    stable = report["stable"]
    modes = report["unstable_motions"]
    yield "stable", "yes" if stable else f"no, {counted(modes, 'motion')} would lower the energy"


def _spent(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    if "steps" in report:
        yield "steps", f"{report['steps']}"
    yield "wall time", f"{report['wall_s']:.1f} s"


def _span(values: list[float], times: list[float]) -> str:
    """First and last of a length [m], with the times [s] they belong to."""
    return f"{1e3 * values[0]:.2f} mm at 0 s, {1e3 * values[-1]:.2f} mm at {times[-1]:.3g} s"

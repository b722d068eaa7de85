"""What `torsade sweep` and `torsade query` do."""

from __future__ import annotations

import csv as csv_format
import json as json_format
import math
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from torsade.cli.commands import now_and_then, progress
from torsade.cli.messages import say
from torsade.errors import TorsadeError, counted, quoted
from torsade.sweep import MOST_POINTS, Catalogue, Rows, Summary, Sweep

__all__ = ["query", "sweep"]

FIRST_POINTS = 5
"""Shown of a design."""

MOST_ROWS = 40
"""Shown to people; machines get all."""


def sweep(
    file: str,
    out: str | None,
    *,
    workers: str | None,
    scheduler: str | None,
    retry_failed: bool,
    keep: bool,
    at_most: str | None,
    dry_run: bool,
    json: bool,
) -> int:
    """Read a design, run what is missing, and say what there is."""
    if out is not None and not out.strip():
        raise TorsadeError("--out is empty; give the name of a folder, such as --out pieces")
    most = MOST_POINTS if at_most is None else _whole("--at-most", at_most, 9)
    count = None if workers is None else _whole("--workers", workers, 4)
    wanted = Sweep.read(file)
    if keep:
        wanted.keep = "results"
    if dry_run:
        return _show(wanted, most, json)
    folder = Path(out) if out is not None else Path(Path(file).stem)
    from torsade.sweep import run

    with progress(json, now_and_then(), estimate=False) as shown:
        done = run(
            wanted,
            folder,
            workers=count,
            scheduler=scheduler,
            retry_failed=retry_failed,
            at_most=most,
            progress=shown,
        )
    _print(done, folder, json)
    if done.failed:
        say(
            f"{done.failed} of {counted(done.points, 'point')} failed; see why with torsade query {folder} "
            '"SELECT reason, count(*) FROM runs GROUP BY reason", and run them again with --retry-failed'
        )
    return 0


def _whole(option: str, text: str, digits: int) -> int:
    if not re.fullmatch(rf"[1-9]\d{{0,{digits - 1}}}", text, re.A):
        raise TorsadeError(f"{option} is {quoted(text)}; give a whole number from 1 to {10**digits - 1}")
    return int(text)


def _show(wanted: Sweep, most: int, json: bool) -> int:
    """How many points there are, and the first."""
    points = wanted.points(most)
    first = [{name: getattr(p.spec, name) for name in wanted.varied} for p in points[:FIRST_POINTS]]
    if json:
        found = {"protocol": wanted.protocol, "varied": list(wanted.varied), "points": len(points)}
        print(json_format.dumps(found | {"first": first}), flush=True)
        return 0
    from torsade.cli.table import print_rows

    rows = [("protocol", wanted.protocol), ("points", str(len(points)))]
    rows += [(f"point {k}", wanted.told(values) or "everything is fixed") for k, values in enumerate(first)]
    print_rows([*rows, *([("...", "")] if len(points) > len(first) else [])])
    return 0


def _print(done: Summary, folder: Path, json: bool) -> None:
    """What was done."""
    counts = done.catalogue.counts()
    if json:
        found = {
            "folder": str(folder),
            "protocol": done.catalogue.protocol,
            "points": done.points,
            "stored_before": done.before,
            "ran": done.ran,
            "done": counts["done"],
            "failed": done.failed,
            "killed_workers": done.effort.killed,
            "workers": done.effort.workers,
            "wall_s": done.effort.wall_s,
            "start_s": done.effort.start_s,
            "compute_s": done.compute_s,
        }
        print(json_format.dumps(found, allow_nan=False), flush=True)
        return
    from torsade.cli.table import print_file, print_rows

    print_rows(_told(done, counts))
    print_file("sweep", str(folder))


def _told(done: Summary, counts: dict[str, int]) -> Iterator[tuple[str, str]]:
    yield "protocol", done.catalogue.protocol
    yield "points", f"{done.points}: {counts['done']} done, {done.failed} failed"
    yield "run now", f"{done.ran}; {done.before} were stored before"
    workers, killed, wall, start = done.effort
    if killed:
        yield "workers killed", str(killed)
    if done.ran and done.compute_s > 0:
        beyond = max(0.0, (wall - start) * workers / done.compute_s - 1)
        yield "computing", f"{done.compute_s:.1f} s by {counted(workers, 'worker')} in {wall:.1f} s"
        yield "beside computing", f"{start:.1f} s to start, then {100 * beyond:.1f} %"


def query(folder: str, sql: str | None, csv: bool, json: bool) -> int:
    """Ask a sweep, and print what it says."""
    if csv and json:
        raise TorsadeError("--csv and --json are both given; give one")
    catalogue = Catalogue(folder)
    if sql is None:
        sql = _overview(catalogue)
        if not csv and not json:
            return _describe(catalogue, folder, sql)
    found = catalogue.query(sql)
    if json:
        rows = [dict(zip(found.columns, map(_plain, row), strict=True)) for row in found.rows]
        columns = dict(zip(found.columns, found.types, strict=True))
        print(json_format.dumps({"columns": columns, "rows": rows}, allow_nan=False), flush=True)
    elif csv:
        lines = csv_format.writer(sys.stdout, lineterminator="\n")
        lines.writerow(found.columns)
        lines.writerows([_text(value) for value in row] for row in found.rows)
        sys.stdout.flush()
    else:
        _grid(found)
    return 0


def _overview(catalogue: Catalogue) -> str:
    """A query for the fields that vary and the numbers that are no lists."""
    kinds = catalogue.columns()
    numbers = [name for name, kind in kinds.items() if name in _numbers(catalogue, kinds) and "[" not in kind]
    names = ", ".join(f'"{name}"' for name in dict.fromkeys(["point", *catalogue.varied, "status", *numbers]))
    return f"SELECT {names} FROM runs"


def _numbers(catalogue: Catalogue, kinds: dict[str, str]) -> list[str]:
    """Columns that are neither fields nor said of every run."""
    from torsade.protocols.files import PROTOCOLS

    known = {
        *PROTOCOLS[catalogue.protocol].model_fields,
        "point",
        "key",
        "status",
        "reason",
        "wall_s",
        "versions",
    }
    return [name for name in kinds if name not in known]


def _describe(catalogue: Catalogue, folder: str, overview: str) -> int:
    """What there is to ask for, and how."""
    from torsade.cli.table import print_rows

    counts = catalogue.counts()
    kinds = catalogue.columns()
    numbers = _numbers(catalogue, kinds)
    lists = [name for name in numbers if "[" in kinds[name]]
    example = (
        f"SELECT {(catalogue.varied or ('point',))[0]}, count(*) FROM runs WHERE status = 'done' GROUP BY 1"
    )
    print_rows(
        [
            ("protocol", catalogue.protocol),
            ("points", f"{sum(counts.values())}: " + ", ".join(f"{n} {what}" for what, n in counts.items())),
            ("varied", ", ".join(catalogue.varied) or "nothing"),
            ("numbers", ", ".join(name for name in numbers if name not in lists) or "none yet"),
            *([("lists", ", ".join(lists))] if lists else []),
            ("all columns", f'torsade query {folder} "DESCRIBE runs"'),
            ("ask in SQL", f'torsade query {folder} "{example}"'),
        ]
    )
    print()
    found = catalogue.query(f"{overview} LIMIT {FIRST_POINTS}")
    known = [k for k in range(len(found.columns)) if any(row[k] is not None for row in found.rows)]
    _print_grid([found.columns[k] for k in known], [[row[k] for k in known] for row in found.rows])
    return 0


def _grid(found: Rows) -> None:
    _print_grid(found.columns, found.rows[:MOST_ROWS])
    if len(found.rows) > MOST_ROWS:
        print(
            f"... and {len(found.rows) - MOST_ROWS} more rows; add LIMIT, or print all with --csv or --json"
        )


def _print_grid(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    from torsade.cli.table import print_grid

    print_grid(columns, [[_cell(value) for value in row] for row in rows])


def _cell(value: Any) -> float | int | str | bool | None:
    """A value as people read it."""
    if isinstance(value, list):
        return ", ".join(f"{x:.4g}" if isinstance(x, float) else str(x) for x in value)
    return value if value is None or isinstance(value, float | int) else str(value)


def _plain(value: Any) -> Any:
    """A value as JSON holds it."""
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, dict):
        return {str(name): _plain(entry) for name, entry in value.items()}
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int | str) else _number_or_text(value)


def _number_or_text(value: Any) -> float | str:
    """Decimals as numbers, dates and the like as text."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return str(value)
    return number if math.isfinite(number) else str(value)


def _text(value: Any) -> Any:
    return json_format.dumps(_plain(value)) if isinstance(value, list | tuple | dict) else value

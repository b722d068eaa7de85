"""What `torsade figure` does: runs what a figure needs, writes its tables and its picture."""

from __future__ import annotations

import json as json_format
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsade.cli.commands import check_drawings, now_and_then, progress
from torsade.cli.messages import say
from torsade.errors import TorsadeError, counted, quoted, reason_of
from torsade.figures import NUMBERS, figure
from torsade.figures.base import Cell, Choice, Table

if TYPE_CHECKING:
    from torsade.figures.base import Figure
    from torsade.sweep import Catalogue

__all__ = ["draw", "show_all"]

PRESETS: Mapping[str, tuple[Any, ...]] = {
    "both": ("standard", "published"),
    "standard": ("standard",),
    "published": ("published",),
}


def show_all(json: bool) -> int:
    """List the figures that there are."""
    titles = {number: figure(number).title for number in NUMBERS}
    if json:
        print(json_format.dumps(titles), flush=True)
        return 0
    from torsade.cli.table import print_rows

    print_rows(titles.items())
    return 0


def draw(
    number: str, out: str, preset: str, quick: bool, fresh: bool, workers: str | None, json: bool
) -> int:
    """Make one figure."""
    wanted = figure(number)
    if preset not in PRESETS:
        raise TorsadeError(f"--preset is {quoted(preset)}; give one of {', '.join(PRESETS)}")
    if not out:
        raise TorsadeError("--out is empty; give the name of a folder, such as --out figures")
    if workers is not None and not re.fullmatch(r"[1-9]\d{0,3}", workers, re.A):
        raise TorsadeError(f"--workers is {quoted(workers)}; give a whole number from 1 to 9999")
    folder = Path(out)
    choice = Choice(PRESETS[preset], quick)
    from torsade.figures.runs import make_folder, results

    make_folder(folder)
    check_drawings(str(wanted.file(folder)), None)
    _check_files(wanted, folder)
    specs, kept = wanted.runs(choice), folder / "runs"
    at_once = None if workers is None else int(workers)
    catalogue = _swept(wanted, choice, folder, at_once, fresh, json)
    with progress(json) as shown:
        found = results(specs, kept, workers=at_once, fresh=fresh, progress=shown)
    try:
        tables = wanted.tables(found, catalogue, choice)
        for name, table in tables.items():
            table.write(wanted.file(folder, name))
        wanted.draw(found, tables, choice, wanted.file(folder))
    except KeyboardInterrupt:
        stored = f"all {counted(len(specs), 'run')} are stored in {str(kept)!r}; " if specs else ""
        again = "the same command without --fresh goes on" if specs and fresh else "the same command goes on"
        raise KeyboardInterrupt(
            f"interrupted before figure {wanted.number} was drawn; {stored}{again}"
        ) from None
    _print(wanted, tables, folder, json)
    return 0


def _swept(
    wanted: Figure, choice: Choice, folder: Path, workers: int | None, fresh: bool, json: bool
) -> Catalogue | None:
    """The sweep of a figure that has one, run as far as it is not stored."""
    if wanted.swept is None:
        return None
    from torsade.sweep import run

    place = folder / "sweeps" / wanted.swept.name
    with progress(json, now_and_then(), estimate=False) as shown:
        done = run(wanted.swept.design(choice), place, workers=workers, fresh=fresh, progress=shown)
    if done.failed:
        say(
            f"{done.failed} of {counted(done.points, 'run')} failed and are left out; see why with torsade "
            f'query {place} "SELECT reason, count(*) FROM runs GROUP BY reason"'
        )
    return done.catalogue


def _check_files(wanted: Figure, folder: Path) -> None:
    """Refuse what stands in the place of the picture or of a table and cannot be written, before any run."""
    main = wanted.file(folder, "")
    others = sorted(folder.glob(f"{main.stem}-*{main.suffix}"))
    for path in (wanted.file(folder), main, *others):
        if path.is_dir():
            raise TorsadeError(f"{str(path)!r} is a folder; remove it, or give another --out")
        if not path.exists():
            continue
        try:
            with path.open("ab"):
                pass
        except OSError as error:
            raise TorsadeError(
                f"cannot write {str(path)!r} ({reason_of(error)}); remove it, or give another --out"
            ) from None


def _print(wanted: Figure, tables: Mapping[str, Table], folder: Path, json: bool) -> None:
    """What was made, and the numbers of the main table."""
    files = {name or "main": str(wanted.file(folder, name)) for name in tables}
    if json:
        numbers = {
            name or "main": [dict(zip(table.columns, map(_known, row), strict=True)) for row in table.rows]
            for name, table in tables.items()
        }
        found = {
            "figure": wanted.number,
            "title": wanted.title,
            "picture": str(wanted.file(folder)),
            "tables": files,
            "numbers": numbers,
        }
        print(json_format.dumps(found, allow_nan=False), flush=True)
        return
    from torsade.cli.table import print_file, print_grid

    print_grid(tables[""].columns, tables[""].rows)
    print_file("picture", str(wanted.file(folder)))
    for name, path in files.items():
        print_file("numbers" if name == "main" else f"numbers, {name}", path)


def _known(cell: Cell) -> Cell:
    """A number that is not finite is not known."""
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell

"""Sweeps whose workers and command are killed, on processes and on dask: every point once; and overhead.

Writes its tables into docs/sweeps.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import json
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from benchmarks import common
from torsade.errors import TorsadeError
from torsade.sweep import Catalogue, Sweep, run

PAGE = Path(__file__).parents[1] / "docs" / "sweeps.md"

DESIGN = """protocol = "snap-twist"

[fixed]
edges = 10
frames = 1
disorder = 0.05
duration = "{duration}"

[grid]
twist = {{ from = "0 deg", to = "20 deg", count = {twists} }}
seed = {{ from = 1, to = {seeds} }}
"""

PARTS = ("processes", "dask", "overhead")
TWISTS = 10
WORKERS = 2
LOOK_EVERY = 1.0  # [s]
CHECKED = 20
"""Points that are run once more, alone, and compared to the last bit."""

QUERY = "SELECT twist, avg(fragments), stddev(fragments) FROM runs WHERE status = 'done' GROUP BY twist"


def processes() -> Iterator[tuple[int, int, str]]:
    """Number, parent and command line of every process, as Linux tells them."""
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            yield int(entry.name), parent, (entry / "cmdline").read_text().replace("\0", " ")


def workers_of(command: int) -> list[int]:
    """The processes that run points for a sweep."""
    return [number for number, parent, line in processes() if parent == command and "spawn_main" in line]


def stored(folder: Path) -> int:
    """Points that are done, as a reader sees them while the sweep goes on."""
    with suppress(TorsadeError):
        return Catalogue(folder).counts()["done"]
    return 0


def begun(design: Path, folder: Path, *more: str, errors: int | None = None) -> subprocess.Popen[str]:
    """A sweep, as a command of its own."""
    command = [sys.executable, "-m", "torsade", "sweep", str(design), "--out", str(folder), "--json", *more]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True)


def until(reached: Callable[[], bool], running: subprocess.Popen[str]) -> bool:
    """Wait; whether it came before the command ended."""
    while running.poll() is None:
        if reached():
            return True
        time.sleep(LOOK_EVERY)
    return False


def kill(process: int) -> None:
    os.kill(process, signal.SIGKILL)


def under_fire(
    design: Path, folder: Path, points: int, *where: str, worker: Callable[[int], int]
) -> dict[str, Any]:
    """A sweep whose worker is killed once and which is killed itself twice, each time to be gone on with.

    Parameters
    ----------
    where : options that say where it runs
    worker : the sweep's process → a process that runs points for it
    """
    began = time.perf_counter()
    seen: list[int] = []
    worker_kills = 0
    for share in (0.3, 0.6, None):
        running = begun(design, folder, *where)
        before = stored(folder)
        aim = points if share is None else share * points
        if share == 0.3 and until(lambda: stored(folder) > 0.1 * points, running):
            kill(worker(running.pid))
            worker_kills += 1
        if share is not None and until(lambda aim=aim: stored(folder) >= aim, running):  # type: ignore[misc]
            kill(running.pid)
            running.communicate()
            seen.append(stored(folder))
            if seen[-1] < before:
                raise RuntimeError("points that were stored have gone")
    out, _ = running.communicate()
    if running.returncode:
        raise RuntimeError(f"the sweep failed: {out}")
    last = json.loads(out)
    wall = time.perf_counter() - began
    return {
        "worker_kills": worker_kills,
        "command_kills": len(seen),
        "stored_when_killed": seen,
        "stored_at_last_start": last["stored_before"],
        "wall_s": wall,
        **verified(design, folder, points),
    }


def verified(design: Path, folder: Path, points: int) -> dict[str, Any]:
    """Whether every point is there once, whole, with the numbers that it has when it is run alone."""
    catalogue = Catalogue(folder)
    rows, keys, done, whole = catalogue.query(
        "SELECT count(*), count(DISTINCT key), count(*) FILTER (status = 'done'), "
        "count(*) FILTER (fragments IS NOT NULL AND len(lengths_m) = fragments) FROM runs"
    ).rows[0]
    (twice,) = catalogue.query("SELECT count(*) - count(DISTINCT key) FROM stored").rows[0]
    every = Sweep.read(design).points()
    found = {r[0]: r[1:] for r in catalogue.query("SELECT key, steps, lengths_m, li FROM runs").rows}
    alike = 0
    for point in every[:: max(1, points // CHECKED)][:CHECKED]:
        report = point.spec.report(point.spec.run())
        alike += found[point.key] == (report["steps"], report["lengths_m"], report["li"])
    taken = common.seconds(lambda: Catalogue(folder).query(QUERY), 9, common.WALL)
    unit, compute = catalogue.query("SELECT median(wall_s), sum(wall_s) FROM runs").rows[0]
    left = [path.name for path in folder.iterdir() if not re.search(r"\.(parquet|json)$", path.name)]
    return {
        "points": points,
        "every_point_once": bool(rows == keys == done == whole == points and twice == 0),
        "checked_alone": min(CHECKED, points),
        "alike": alike,
        "left_behind": len(left),
        "unit_s": unit,
        "compute_s": compute,
        "query_s": taken,
    }


@contextmanager
def dask_cluster() -> Iterator[tuple[str, list[subprocess.Popen[str]]]]:
    """A dask scheduler and two workers on this machine: its address, and the processes in that order."""
    began: list[subprocess.Popen[str]] = []
    with tempfile.TemporaryDirectory() as folder:
        try:
            file = Path(folder) / "scheduler.json"
            began.append(_dask("scheduler", "--scheduler-file", str(file), "--port", "0", "--no-dashboard"))
            while not file.exists():
                time.sleep(0.1)
            address = json.loads(file.read_text())["address"]
            for _ in range(WORKERS):
                began.append(
                    _dask("worker", address, "--nthreads", "1", "--local-directory", folder, "--no-dashboard")
                )
            yield address, began
        finally:
            for process in reversed(began):
                process.terminate()
                process.wait()


def _dask(*words: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *words[1:]]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True)


def on_processes(design: Path, folder: Path, points: int) -> dict[str, Any]:
    """A sweep on processes of this machine, under fire."""
    return under_fire(
        design, folder, points, "--workers", str(WORKERS), worker=lambda command: workers_of(command)[0]
    )


def on_dask(design: Path, folder: Path, points: int) -> dict[str, Any]:
    """A sweep on dask, under fire."""
    with dask_cluster() as (address, (_, first, *_)):

        def worker(command: int) -> int:
            """The worker itself: what looks after it starts another."""
            return next(number for number, parent, _ in processes() if parent == first.pid)

        return under_fire(design, folder, points, "--scheduler", address, worker=worker)


def alike(one: Path, other: Path) -> dict[str, int]:
    """How many points two sweeps share, and of how many everything but times is the same to the last bit."""
    mine, theirs = (_done(Catalogue(folder)) for folder in (one, other))
    shared = mine.keys() & theirs.keys()
    return {"shared": len(shared), "the_same": sum(mine[key] == theirs[key] for key in shared)}


def _done(catalogue: Catalogue) -> dict[str, dict[str, Any]]:
    """What is done, by key: columns by name, since their order is that in which they were first filled."""
    found = catalogue.query("SELECT * EXCLUDE (point, wall_s) FROM runs WHERE status = 'done'")
    rows = [dict(zip(found.columns, row, strict=True)) for row in found.rows]
    return {row.pop("key"): row for row in rows}


def overhead(folder: Path, duration: str, count: int) -> dict[str, Any]:
    """What a sweep costs beside computing: (wall · workers − sum of compute) / sum of compute, in one run."""
    sweep = Sweep(
        "snap-twist",
        fixed={"edges": 10, "frames": 1, "disorder": 0.05, "duration": duration},
        grid={"seed": {"from": 1, "to": count}},
    )
    done = run(sweep, folder, workers=WORKERS)
    workers, _, wall, start = done.effort
    walls = [row[0] for row in done.catalogue.query("SELECT wall_s FROM runs").rows]
    return {
        "points": count,
        "unit_s": statistics.median(walls),
        "wall_s": wall,
        "start_s": start,
        "compute_s": done.compute_s,
        "overhead": wall * workers / done.compute_s - 1,
        "overhead_once_started": (wall - start) * workers / done.compute_s - 1,
    }


def kills_text(found: dict[str, Any]) -> str:
    rows = []
    for name, label in (("processes", "two processes"), ("dask", "dask, two workers")):
        one = found.get(name)
        if one is not None:
            rows.append(
                (
                    label,
                    one["points"],
                    one["worker_kills"],
                    one["command_kills"],
                    "yes" if one["every_point_once"] else "NO",
                    f"{one['alike']} of {one['checked_alone']}",
                    one["left_behind"],
                    f"{1e3 * one['unit_s']:.0f}",
                    f"{one['wall_s']:.0f}",
                    f"{1e3 * one['query_s']:.0f}",
                )
            )
    heads = (
        "on",
        "points",
        "workers killed",
        "command killed",
        "every point once",
        "alike when run alone",
        "half-written files",
        "a run [ms]",
        "in all [s]",
        "a query [ms]",
    )
    text = common.table(heads, rows)
    if both := found.get("both"):
        shared, same = f"{both['shared']:,}", f"{both['the_same']:,}"
        text += f"\n\nOf {shared} points that both ran, {same} have the same numbers to the last bit."
    return text


def overhead_text(found: Sequence[dict[str, Any]]) -> str:
    rows = [
        (
            one["points"],
            f"{one['unit_s']:.2g}",
            f"{one['wall_s']:.1f}",
            f"{one['start_s']:.1f}",
            f"{one['compute_s']:.1f}",
            f"{100 * one['overhead']:.1f} %",
            f"{100 * one['overhead_once_started']:.1f} %",
        )
        for one in found
    ]
    heads = (
        "points",
        "median of a run [s]",
        "wall [s]",
        "start [s]",
        "sum of runs [s]",
        "in all",
        "once started",
    )
    return common.table(heads, rows)


def measured(part: str, folder: Path, points: int, quick: bool) -> Any:
    """One part of what is to be found."""
    if part == "overhead":
        return [overhead(folder / "long", "450 ms", 150), overhead(folder / "short", "0.5 ms", 1000)]
    design = folder / f"{part}.toml"
    duration = "100 ms" if quick else "0.5 ms"
    design.write_text(DESIGN.format(duration=duration, twists=TWISTS, seeds=points // TWISTS))
    points = len(Sweep.read(design))
    return (on_dask if part == "dask" else on_processes)(design, folder / part, points)


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--points", type=int, default=10_000, help="points of the sweep that is killed")
    options.add_argument("--only", choices=PARTS, help="one part; with --out the others are kept from before")
    options.add_argument("--out", help="folder to keep the sweeps in; by default they are not kept")
    options.add_argument("--no-write", action="store_true", help="leave docs/sweeps.md as it is")
    given = options.parse_args(arguments)
    points = 60 if given.quick else given.points
    parts = [given.only] if given.only else PARTS[:1] if given.quick else PARTS
    with tempfile.TemporaryDirectory() as place:
        folder = Path(given.out or place)
        folder.mkdir(exist_ok=True)
        kept = folder / "found.json"
        found: dict[str, Any] = {}
        for part in parts:
            one = measured(part, folder, points, given.quick)
            found = (json.loads(kept.read_text()) if kept.exists() else {}) | {part: one}
            if "dask" in found and "processes" in found:
                found["both"] = alike(folder / "dask", folder / "processes")
            kept.write_text(json.dumps(found))
    tables = {"kills": kills_text(found), "overhead": overhead_text(found.get("overhead", []))}
    if not (given.quick or given.no_write):
        for name, text in tables.items():
            common.put(text, PAGE, name)
    return common.show(found, list(tables.values()), given.json)


if __name__ == "__main__":
    main()

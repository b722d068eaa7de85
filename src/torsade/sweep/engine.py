"""Running a sweep: what is stored is left, what is missing is run, what comes is stored."""

from __future__ import annotations

import json
import multiprocessing
import re
import shutil
import time
from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from torsade import places
from torsade.errors import TorsadeError, counted, reason_of
from torsade.protocols import stored
from torsade.provenance import cores
from torsade.stopping import STOPPING, Patience
from torsade.sweep import parts
from torsade.sweep.design import MOST_POINTS, Point, Sweep
from torsade.sweep.lanes import Lane, Local, Shared
from torsade.sweep.processes import GRACE
from torsade.sweep.query import ABOUT, POINTS, Catalogue, read_about
from torsade.sweep.unit import Outcome, Unit
from torsade.sweep.warm import warm_up
from torsade.sweep.work import Work

if TYPE_CHECKING:
    from torsade.protocols.base import Progress

__all__ = ["RESULTS", "Summary", "run"]

RESULTS = "results"
"""Folder of whole results, KEY.zarr."""

FLUSH_EVERY = 3.0
"""Time between writes [s]: so much is computed again at most when this process is killed."""

BUSY = (
    "another command runs the sweep in {out} ({owner}); wait for it or give another --out, or remove {lock} "
    "when no such command goes on"
)

_LEFT_BEHIND = re.compile(r"part\.[0-9a-f]{12}\.new|[0-9a-f]{16}\.[0-9a-f]{12}\.new\.zarr.*", re.A)
"""Names of what was being written when a process was killed."""


class Effort(NamedTuple):
    """What running took.

    Attributes
    ----------
    workers : at a time
    killed : of these
    wall_s : from the first batch that was given to the last that came back [s]
    start_s : of that, until the first worker was at work [s]
    """

    workers: int
    killed: int
    wall_s: float
    start_s: float


class Summary(NamedTuple):
    """What a sweep did.

    Attributes
    ----------
    catalogue : what there is now
    points : of the design
    before : points that were stored already, failures that are left among them
    ran : points that were run now
    failed : of all points
    compute_s : sum of what units took, as their workers saw it [s]
    effort : what that took here
    """

    catalogue: Catalogue
    points: int
    before: int
    ran: int
    failed: int
    compute_s: float
    effort: Effort


def run(
    sweep: Sweep,
    out: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    executor: Executor | None = None,
    retry_failed: bool = False,
    fresh: bool = False,
    at_most: int = MOST_POINTS,
    progress: Progress | None = None,
) -> Summary:
    """Run the points of a sweep that a folder does not have.

    Numbers do not depend on workers, batches, or the order in which runs come to their end.

    Parameters
    ----------
    sweep : what to run
    out : folder of the sweep, made when missing
    workers : processes at a time, as many as cores by default; with a queue, how many to ask for
    scheduler : address of a dask scheduler, or slurm or pbs
    executor : where to run, in place of processes or of a scheduler: any of `concurrent.futures`
    retry_failed : run again what failed
    fresh : run again what is there too; whole results that are kept stay
    at_most : refuse designs of more points
    progress : called with the share done and what is going on

    Raises
    ------
    TorsadeError
        When the design is unfit, the folder holds something else or cannot be written, another command is at
        work there, a file of it is damaged, or workers cannot be had. Runs that fail raise nothing: their
        reasons are stored.
    KeyboardInterrupt
        On Ctrl-C, saying how many points are stored.
    """
    tell = progress or (lambda share, note: None)
    con = parts.connect()
    tell(0.0, "reading the design")
    points = sweep.points(at_most)
    folder = _folder(sweep, Path(out))
    lock = places.Lock(folder, busy=BUSY)
    try:
        _clean(folder)
        status = _statuses(con, folder)
        _note(con, folder, sweep, points)
        again = () if fresh else ("done",) if retry_failed else ("done", "failed")
        keep = folder / RESULTS if sweep.keep == "results" else None
        there = [p for p in points if status.get(p.key) in again and _kept(keep, p.key, status[p.key])]
        known = {p.key for p in there}
        units = [Unit(p.key, p.spec) for p in points if p.key not in known]
        store = _Store(con, folder, {p.key: p for p in points}, len(there))
        options = {"workers": workers, "scheduler": scheduler, "executor": executor}
        try:
            effort = _run(sweep, units, store, keep, options, tell) if units else Effort(0, 0, 0.0, 0.0)
        except KeyboardInterrupt:
            store.flush()
            raise KeyboardInterrupt(_interrupted(store)) from None
        store.flush()
        parts.merge_all(con, folder)
    finally:
        lock.release()
        con.close()
    old = sum(status.get(p.key) == "failed" for p in there)
    return Summary(
        Catalogue(folder),
        len(points),
        len(there),
        store.ran,
        store.failed + old,
        store.compute,
        effort,
    )


def _folder(sweep: Sweep, out: Path) -> Path:
    """The folder, made where it is missing; what is something else is refused."""
    if out.is_file():
        raise TorsadeError(f"{str(out)!r} is a file, not a folder; remove it, or give another --out")
    about = read_about(out)
    if about is None and out.exists() and any(out.iterdir()):
        raise TorsadeError(f"{str(out)!r} holds something else than a sweep; give another --out")
    if about is not None and about["protocol"] != sweep.protocol:
        raise TorsadeError(
            f"{str(out)!r} holds a sweep of {about['protocol']}, not of {sweep.protocol}; give another --out"
        )
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TorsadeError(
            f"cannot make the folder {str(out)!r} ({reason_of(error)}); give another --out"
        ) from None
    return out


def _clean(folder: Path) -> None:
    """Remove what was half written when a process was killed."""
    for place in (folder, folder / RESULTS):
        for path in place.iterdir() if place.is_dir() else ():
            if _LEFT_BEHIND.fullmatch(path.name) and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True) if path.is_dir() else path.unlink(missing_ok=True)


def _statuses(con: Any, folder: Path) -> dict[str, str]:
    """done or failed, by key."""
    there = parts.live(folder)
    if not there:
        return {}
    for part in there:
        part.verify()
    rows = con.execute(f"SELECT key, status FROM ({parts.union(con, there)}) ORDER BY part").fetchall()
    return dict(rows)


def _note(con: Any, folder: Path, sweep: Sweep, points: Sequence[Point]) -> None:
    """Write down what was asked for."""
    parts.write_rows(con, [{"point": p.number, "key": p.key, **p.spec.stored()} for p in points])
    about = {"format": 1, "protocol": sweep.protocol, "varied": list(sweep.varied), "keep": sweep.keep}
    with places.writing(folder):
        for name, write in (
            (POINTS, lambda new: parts.write_table(con, new)),
            (ABOUT, lambda new: new.write_text(json.dumps(about), encoding="utf-8")),
        ):
            new = places.private(folder / "part", "new")
            write(new)
            new.replace(folder / name)
        parts.sync(folder)


def _kept(keep: Path | None, key: str, status: str) -> bool:
    """Whether a whole result is there, where it is wanted and there can be one."""
    return keep is None or status == "failed" or stored.is_there(keep / f"{key}.zarr")


class _Store:
    """Outcomes on their way to the disk."""

    def __init__(self, con: Any, folder: Path, points: dict[str, Point], before: int) -> None:
        self._con, self._folder, self._points, self._before = con, folder, points, before
        self._rows: list[dict[str, Any]] = []
        self._flushed = time.monotonic()
        self.ran = self.failed = 0
        self.compute = 0.0

    @property
    def written(self) -> int:
        """Points that are stored."""
        return self._before + self.ran - len(self._rows)

    def take(self, outcomes: Sequence[Outcome]) -> None:
        for one in outcomes:
            head = {"key": one.key, "status": one.status, "reason": one.reason}
            versions = ", ".join(f"{name} {version}" for name, version in one.versions.items())
            tail = {"wall_s": one.wall, "versions": versions or None}
            self._rows.append({**head, **self._points[one.key].spec.stored(), **one.numbers, **tail})
            self.ran += 1
            self.failed += one.status == "failed"
            self.compute += one.wall
        if self._rows and time.monotonic() - self._flushed > FLUSH_EVERY:
            self.flush()

    def flush(self) -> None:
        if self._rows:
            parts.add(self._con, self._folder, self._rows)
        self._rows = []
        self._flushed = time.monotonic()


def _run(
    sweep: Sweep,
    units: Sequence[Unit],
    store: _Store,
    keep: Path | None,
    options: dict[str, Any],
    tell: Progress,
) -> Effort:
    """Run units."""
    stop = multiprocessing.get_context("spawn").Event()
    told = _Teller(store, len(units), tell)
    folder = None if keep is None else str(keep.resolve())
    lanes: list[Lane] = []
    work = Work(units, lanes, stored.sources(), folder)
    with Patience(told.stopping) as patience:
        try:
            warm_up(units[0].spec, told.preparing)
            patience.end()
            lanes += _lanes(sweep, stop, len(units), **options)
            began, start = time.monotonic(), None
            for outcomes in work.outcomes(patience.end):
                if outcomes and start is None:
                    start = max(0.0, time.monotonic() - began - outcomes[0].wall)
                store.take(outcomes)
                told.now(work.killed, sum(lane.workers for lane in lanes))
            used, wall = sum(lane.workers for lane in lanes), time.monotonic() - began
            return Effort(used, work.killed, wall, start or 0.0)
        except KeyboardInterrupt:
            stop.set()
            with suppress(KeyboardInterrupt):  # a second Ctrl-C does not wait
                store.take(work.remaining(GRACE))
            for lane in lanes:
                lane.abandon()
            raise
        except BaseException:
            stop.set()
            store.flush()
            raise
        finally:
            for lane in lanes:
                lane.close()


def _lanes(
    sweep: Sweep, stop: Any, count: int, workers: int | None, scheduler: str | None, executor: Executor | None
) -> list[Lane]:
    if executor is not None:
        size = workers or getattr(executor, "_max_workers", None) or cores()
        return [Shared(executor, lambda: size)]
    if scheduler is not None:
        from torsade.sweep.schedulers import connected

        return [connected(scheduler, workers, sweep.cluster)]
    return [Local(stop) for _ in range(min(workers or cores(), count))]


def _interrupted(store: _Store) -> str:
    total = len(store._points)
    are = "is" if store.written == 1 else "are"
    return (
        f"interrupted; {store.written} of {counted(total, 'point')} {are} stored in {str(store._folder)!r}; "
        "the same command goes on"
    )


class _Teller:
    """Says how far a sweep has come, and how long the rest may take."""

    def __init__(self, store: _Store, count: int, tell: Progress) -> None:
        self._store, self._count, self._tell = store, count, tell
        self._began = time.monotonic()
        self._note = ""
        self._share = 0.0

    def preparing(self, note: str) -> None:
        self._tell(self._share, note)
        self._began = time.monotonic()

    def stopping(self) -> None:
        self._tell(self._share, STOPPING)

    def now(self, killed: int, workers: int) -> None:
        """Say how many points are through, and how long the others may take."""
        store, total = self._store, len(self._store._points)
        self._share = (total - self._count + store.ran) / total
        note = f"{total - self._count + store.ran} of {counted(total, 'point')}"
        note += f", {store.failed} failed" * bool(
            store.failed
        ) + f", {counted(killed, 'worker')} killed" * bool(killed)
        if store.ran:
            left = (time.monotonic() - self._began) / store.ran * (self._count - store.ran)
            note += f", about {_duration(left)} left"
        self._tell(self._share, note if workers else "waiting for workers of the scheduler")


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"

"""Runs that figures share: made once, two or more at a time, kept in a folder and found there again."""

from __future__ import annotations

import multiprocessing
import re
from collections.abc import Iterator, Mapping
from concurrent.futures import BrokenExecutor, as_completed
from pathlib import Path
from typing import TYPE_CHECKING

from torsade import places
from torsade.errors import TorsadeError, counted, reason_of
from torsade.protocols import stored
from torsade.provenance import cores
from torsade.results import Result
from torsade.sweep.processes import end, heed, kill, pool

if TYPE_CHECKING:
    from torsade.protocols.base import Progress, Spec

__all__ = ["make_folder", "results", "run_path"]

BUSY = "another command is making runs in {out} ({owner}); wait for it or give another --out"


def results(
    specs: Mapping[str, Spec],
    folder: Path,
    *,
    workers: int | None = None,
    fresh: bool = False,
    progress: Progress | None = None,
) -> dict[str, Result]:
    """The results of specifications, by label: read where the folder has them, run where it has not.

    A run that was interrupted is gone on with; one that is damaged is run anew. Results do not depend on the
    number of workers.

    Parameters
    ----------
    specs : what to run, by label
    folder : where results are kept, made when missing and something has to be run
    workers : processes at a time; by default as many as there are cores
    fresh : run all anew
    progress : called as runs come to their end

    Raises
    ------
    TorsadeError
        When the folder cannot be written, something in it has the name of a run and is none, another command
        makes runs in it, or a run fails; what is complete by then is kept.
    KeyboardInterrupt
        On Ctrl-C, saying how many runs are stored.
    """
    if not specs:
        return {}
    tell = progress or (lambda share, note: None)
    make_folder(folder)
    paths = {label: run_path(label, spec, folder) for label, spec in specs.items()}
    for path in paths.values():
        stored.check_ours(path)
    try:
        found = {} if fresh else _found(paths)
        if len(found) < len(specs):
            lock = places.Lock(folder, busy=BUSY)
            try:
                found |= {} if fresh else _found({k: p for k, p in paths.items() if k not in found})
                _run_missing({k: s for k, s in specs.items() if k not in found}, paths, fresh, workers, tell)
            finally:
                lock.release()
        else:
            tell(1.0, _note(0))
        return {label: found.get(label) or stored.opened(path) for label, path in paths.items()}
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_kept(paths, folder, fresh)) from None


def _found(paths: Mapping[str, Path]) -> dict[str, Result]:
    """The runs that are stored whole, by label."""
    every = {label: stored.whole(path) for label, path in paths.items()}
    return {label: result for label, result in every.items() if result is not None}


def _run_missing(
    missing: Mapping[str, Spec],
    paths: Mapping[str, Path],
    fresh: bool,
    workers: int | None,
    tell: Progress,
) -> None:
    """Run what is not stored, telling what share of all is."""
    done = len(paths) - len(missing)
    tell(done / len(paths), _note(len(missing)))
    for label in _run_all(missing, paths, fresh, workers or cores()):
        done += 1
        tell(done / len(paths), label)


def _kept(paths: Mapping[str, Path], folder: Path, fresh: bool) -> str:
    """What to say when all is interrupted."""
    complete = sum(stored.is_there(path) for path in paths.values())
    again = "the same command without --fresh goes on" if fresh else "the same command goes on"
    are = "is" if complete == 1 else "are"
    return f"interrupted; {complete} of {counted(len(paths), 'run')} {are} stored in {str(folder)!r}; {again}"


def make_folder(folder: Path) -> None:
    """Make a folder where it is missing.

    Raises
    ------
    TorsadeError
        When that cannot be done.
    """
    if folder.is_file():
        raise TorsadeError(f"{str(folder)!r} is a file, not a folder; remove it, or give another --out")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TorsadeError(
            f"cannot make the folder {str(folder)!r} ({reason_of(error)}); give another --out"
        ) from None


def run_path(label: str, spec: Spec, folder: Path) -> Path:
    """Where the run of a specification is kept: its label, and a hash of all that decides the result."""
    return folder / f"{re.sub(r'[^A-Za-z0-9.]+', '-', label).strip('-')}-{stored.key(spec)}.zarr"


def _note(missing: int) -> str:
    return f"{counted(missing, 'run')} to do" if missing else "all runs are stored"


def _run_all(
    specs: Mapping[str, Spec], paths: Mapping[str, Path], fresh: bool, workers: int
) -> Iterator[str]:
    """Run all, and name each when it is done; the first failure is raised when the others are through."""
    failures: list[str] = []
    for outcomes in _outcomes(_batches(specs), specs, paths, fresh, workers):
        for label, failure in outcomes.items():
            if failure is not None:
                failures.append(f"{label}: {failure}")
            yield label
    if failures:
        raise TorsadeError("; ".join(failures))


def _batches(specs: Mapping[str, Spec]) -> list[list[str]]:
    """Labels of runs that start from the same drawing, together: one process builds that once."""
    found: dict[object, list[str]] = {}
    for label, spec in specs.items():
        knot = getattr(spec, "knot", None)
        shape = label if knot is None else (knot, getattr(spec, "pulled", None))
        found.setdefault(shape, []).append(label)
    return list(found.values())


def _outcomes(
    batches: list[list[str]],
    specs: Mapping[str, Spec],
    paths: Mapping[str, Path],
    fresh: bool,
    workers: int,
) -> Iterator[dict[str, str | None]]:
    """What failed, or None, by label: in this process, or as processes come to their end."""
    jobs = [{label: (specs[label], paths[label]) for label in batch} for batch in batches]
    if min(workers, len(jobs)) <= 1:
        for job in jobs:
            for label, one in job.items():
                yield _run({label: one}, fresh)
        return
    stop = multiprocessing.get_context("spawn").Event()
    processes = pool(min(workers, len(jobs)), stop)
    waiting = [processes.submit(_run, job, fresh) for job in jobs]
    try:
        for future in as_completed(waiting):
            yield future.result()
    except BrokenExecutor:
        kill(processes)
        raise TorsadeError(
            "a process that makes runs was killed, as it is when memory runs out; the same command goes on, "
            "with --workers 1 if it happens again"
        ) from None
    except BaseException:
        stop.set()
        end(processes, waiting)
        raise
    finally:
        processes.shutdown(cancel_futures=True)


def _run(job: Mapping[str, tuple[Spec, Path]], fresh: bool) -> dict[str, str | None]:
    """Runs, on disk, and what failed of each."""
    failed: dict[str, str | None] = {}
    for label, (spec, path) in job.items():
        part = places.part_of(path)
        # What is complete and yet to be run is damaged.
        anew = fresh or path.exists() or (part.exists() and not stored.goes_on(part))
        try:
            spec.run(heed, path, resume=not anew, overwrite=anew)
            failed[label] = None
        except TorsadeError as error:
            failed[label] = str(error)
    return failed

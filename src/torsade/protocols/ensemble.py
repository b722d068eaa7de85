"""Ensembles: many runs at once in the threads of one process.

Compiled loops let go of the interpreter's lock, so threads that are in them run side by side; what runs do
between them, setting up and recording, takes turns. Runs share no state: each gives the same bits as alone.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING

from torsade.errors import TorsadeError

if TYPE_CHECKING:
    from torsade.protocols.base import Progress, Spec
    from torsade.results import Result

__all__ = ["ensemble"]

THREAD = "torsade-run"
"""What names of threads begin with."""

HEARTBEAT = 0.1
"""Time between looks at Ctrl-C [s]."""


class _Member:
    """A run in a thread, which can be asked to stop, and says how far it has come."""

    def __init__(self, spec: Spec, stop: threading.Event) -> None:
        self._spec, self._stop = spec, stop
        self.share = 0.0

    def run(self) -> Result:
        """The run's result."""
        return self._spec.run(self._heed)

    def _heed(self, share: float, note: str) -> None:
        self.share = share
        if self._stop.is_set():
            raise KeyboardInterrupt


def ensemble(
    specs: Sequence[Spec], threads: int | None = None, progress: Progress | None = None
) -> list[Result]:
    """Run many specifications at once; their results in the same order.

    Each result has the same bits as that of `spec.run()`. Results stay in memory: for many long runs, or more
    than one machine, use a sweep.

    >>> import torsade as ts
    >>> short = [ts.protocols.SnapTwist(twist=f"{t} deg", frames=1) for t in (0, 300)]
    >>> [result.report()["fragments"] for result in ts.protocols.ensemble(short)]
    [6, 2]

    Parameters
    ----------
    threads : how many runs go on at a time; by default as many as there are cores
    progress : called with the mean share done, and how many runs are through

    Raises
    ------
    TorsadeError
        When a run fails, with the place of its specification; runs that have not begun are left out. When
        threads is below 1.
    KeyboardInterrupt
        On Ctrl-C; what runs gave is lost.
    """
    from torsade.provenance import cores

    if threads is not None and threads < 1:
        raise TorsadeError(f"threads is {threads}; give a number of at least 1")
    if not specs:
        return []
    stop = threading.Event()
    members = [_Member(spec, stop) for spec in specs]
    results = [members[0].run()]  # alone, so that kernels are compiled once
    with ThreadPoolExecutor(threads or cores(), THREAD) as pool:
        futures = [pool.submit(member.run) for member in members[1:]]
        try:
            _watch(futures, members, progress)
        except BaseException:
            stop.set()
            pool.shutdown(cancel_futures=True)
            raise
    return results + [future.result() for future in futures]


def _watch(futures: Sequence[Future[Result]], members: Sequence[_Member], progress: Progress | None) -> None:
    """Wait until all runs are through, or one fails."""
    left: set[Future[Result]] = set(futures)
    while left:
        done, left = wait(left, HEARTBEAT, FIRST_COMPLETED)
        for future in done:
            error = future.exception()
            if isinstance(error, TorsadeError):
                place = futures.index(future) + 1
                raise TorsadeError(
                    f"run {place} of {len(members)}, counted from 0, failed: {error}"
                ) from None
            if error is not None:
                raise error
        if progress is not None:
            through = len(members) - len(left)
            share = (1.0 + sum(m.share for m in members[1:])) / len(members)
            progress(share, f"{through} of {len(members)} runs")

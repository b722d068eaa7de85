"""Processes of this machine that run specifications for this one, and stop when it asks them to."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from contextlib import contextmanager, suppress
from multiprocessing import connection
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any

from torsade.stopping import leave

__all__ = ["GRACE", "end", "heed", "kill", "pool"]

HEEDED, GRACE = 0.5, 10.0
"""How long runs take to heed Ctrl-C, between two steps, and may take at most [s]."""

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Workers are as many as cores: each of them uses one."""


def _never() -> bool:
    return False


_asked: Callable[[], bool] = _never
"""Whether the runs of this process are to stop."""


class _Process(SpawnProcess):
    """A fresh interpreter with one thread for arrays, which does not import the main script once more."""

    def start(self) -> None:
        with _spared():
            super().start()


class _Context(SpawnContext):
    Process = _Process


@contextmanager
def _spared() -> Iterator[None]:
    """What a process that starts meanwhile gets from this one."""
    main = sys.modules["__main__"]
    names: dict[str, Any] = {
        name: vars(main)[name] for name in ("__file__", "__spec__") if name in vars(main)
    }
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    try:
        main.__spec__ = None
        vars(main).pop("__file__", None)
        os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
        yield
    finally:
        vars(main).update(names)
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def pool(workers: int, stop: Any = None) -> ProcessPoolExecutor:
    """Processes that are spawned, not forked: forking one that has threads, as compiled kernels do, can hang.

    They leave Ctrl-C to this one, end when it ends, however it does, and end their runs when `stop`, an event
    of `multiprocessing`, is set.
    """
    return ProcessPoolExecutor(workers, _Context(), initializer=_begin, initargs=(stop,))


def _begin(stop: Any) -> None:
    global _asked
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, leave)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    if stop is not None:
        _asked = stop.is_set


def heed(share: float, note: str) -> None:
    """Tell a run, which calls this now and then, to stop: whoever began this process has asked for it."""
    if _asked():
        raise KeyboardInterrupt


def _end_with(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)


def end(workers: ProcessPoolExecutor, given: Sequence[Future[Any]]) -> None:
    """End processes whose runs were asked to stop, as soon as they have, and at a second Ctrl-C at once."""
    workers.shutdown(wait=False, cancel_futures=True)
    running = {future for future in given if future.running()}
    with suppress(KeyboardInterrupt):
        running = wait(running, timeout=HEEDED).not_done
        for process in _of(workers) if running else ():  # what is made ready hears nothing else
            process.terminate()
        running = wait(running, timeout=GRACE).not_done
    if running:
        kill(workers)


def kill(workers: ProcessPoolExecutor) -> None:
    """End processes, whatever they do."""
    for process in _of(workers):
        process.kill()


def _of(workers: ProcessPoolExecutor) -> list[SpawnProcess]:
    # Before Python 3.14 there is no public way.
    return list((getattr(workers, "_processes", None) or {}).values())

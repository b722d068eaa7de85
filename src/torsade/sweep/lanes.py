"""Where batches of a sweep run: processes of this machine, workers of a dask scheduler, any executor."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import connection
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any

from torsade.sweep.unit import Unit, stop_when

__all__ = ["Lane", "Local", "Shared", "deaf", "pool"]

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Workers are as many as cores: each of them uses one."""

AHEAD = 2
"""Batches given to a worker at a time: it has the next when it ends one."""

ASKED_EVERY = 5.0
"""Time between looks at how many workers there are [s]."""


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
    deaf()
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()
    if stop is not None:
        stop_when(stop.is_set)


def deaf() -> None:
    """Leave Ctrl-C to whoever waits for this process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _end_with(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)


class Lane(ABC):
    """An executor and the batches that it has been given, in order.

    Attributes
    ----------
    given : futures and their batches
    """

    def __init__(self) -> None:
        self.given: deque[tuple[Future[Any], list[Unit]]] = deque()

    @property
    def workers(self) -> int:
        """How many batches run at a time."""
        return 1

    @property
    def has_room(self) -> bool:
        """Whether another batch is wanted."""
        return len(self.given) < AHEAD * max(1, self.workers)

    def submit(self, batch: list[Unit], *task: Any) -> None:
        """Give it a batch, to be run as task[0](batch, *task[1:])."""
        function, *arguments = task
        self.given.append((self._executor().submit(function, batch, *arguments), batch))

    @abstractmethod
    def _executor(self) -> Executor:
        """What runs its batches."""

    def remake(self) -> bool:
        """Begin anew after its worker was killed; False where that is not in our hands."""
        return False

    @abstractmethod
    def abandon(self) -> None:
        """End what runs, if it is in our hands."""

    @abstractmethod
    def close(self) -> None:
        """Let what it holds go."""


class Local(Lane):
    """One process of this machine: when it is killed, it is known what it ran, and others go on."""

    def __init__(self, stop: Any) -> None:
        super().__init__()
        self._stop = stop
        self._pool = pool(1, stop)

    def _executor(self) -> Executor:
        return self._pool

    def remake(self) -> bool:
        self._pool.shutdown(wait=False)
        self._pool = pool(1, self._stop)
        return True

    def abandon(self) -> None:
        # Before Python 3.14 there is no public way.
        for process in list((getattr(self._pool, "_processes", None) or {}).values()):
            process.kill()

    def close(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)


class Shared(Lane):
    """An executor with several workers, made elsewhere.

    Parameters
    ----------
    executor : whatever follows `concurrent.futures.Executor`
    count : asks how many workers it has now
    release : called at the end
    """

    def __init__(
        self, executor: Executor, count: Callable[[], int], release: Callable[[], None] = lambda: None
    ) -> None:
        super().__init__()
        self._given_executor = executor
        self._count, self._release = count, release
        self._workers, self._asked = count(), time.monotonic()

    @property
    def workers(self) -> int:
        if time.monotonic() - self._asked > ASKED_EVERY:
            self._workers, self._asked = self._count(), time.monotonic()
        return self._workers

    def _executor(self) -> Executor:
        return self._given_executor

    def abandon(self) -> None:
        """Nothing: its workers are not ours to end."""

    def close(self) -> None:
        for future, _ in self.given:
            future.cancel()
        self._release()

"""Where batches of a sweep run: processes of this machine, workers of a dask scheduler, any executor."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

from torsade.sweep.processes import kill, pool
from torsade.sweep.unit import Unit

__all__ = ["Lane", "Local", "Shared"]

AHEAD = 2
"""Batches given to a worker at a time: it has the next when it ends one."""

ASKED_EVERY = 5.0
"""Time between looks at how many workers there are [s]."""


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
        kill(self._pool)

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

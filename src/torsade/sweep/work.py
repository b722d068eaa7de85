"""The loop of a sweep: batches given to lanes, outcomes taken back, units of killed workers given again."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from typing import Any

from torsade.errors import TorsadeError, counted
from torsade.sweep.lanes import Lane
from torsade.sweep.unit import OTHER_VERSION, Outcome, Unit, run_batch

__all__ = ["BATCH_SECONDS", "Work"]

BATCH_SECONDS = 1.0
"""How long a batch is meant to take [s]: handing one over costs milliseconds."""

MOST_IN_BATCH = 256
LOOK_EVERY = 0.25
"""Longest time between looks at the clock and at Ctrl-C [s]."""

MOST_DEATHS = 3
"""A unit whose worker was killed so often, running it alone, has failed."""

MOST_IN_VAIN = 12
"""Workers that die one after another while nothing gets done: something else is wrong."""


class Work:
    """Units that wait, and what is known of how long one takes.

    Parameters
    ----------
    units : what to run
    lanes : where
    arguments : of `run_batch`, after the units
    """

    def __init__(self, units: Iterable[Unit], lanes: Sequence[Lane], *arguments: Any) -> None:
        self._waiting = deque(units)
        self._lanes = lanes
        self._arguments = arguments
        self._deaths: Counter[str] = Counter()
        self._alone: set[str] = set()
        self._pace: float | None = None
        self._in_vain = 0
        self.killed = 0

    def outcomes(self, look: Callable[[], None]) -> Iterable[list[Outcome]]:
        """Outcomes as they come, an empty list now and then when none do; `look` is called between.

        Raises
        ------
        TorsadeError
            When workers have other sources, or die as soon as they begin.
        """
        while self._waiting or any(lane.given for lane in self._lanes):
            self._hand_out()
            futures = [future for lane in self._lanes for future, _ in lane.given]
            wait(futures, timeout=LOOK_EVERY, return_when=FIRST_COMPLETED)
            found = [outcome for lane in self._lanes for outcome in self._taken(lane)]
            self._hand_out()
            yield found
            look()

    def remaining(self, patience: float) -> list[Outcome]:
        """Outcomes of what runs still, which has been asked to stop, within a time [s]."""
        futures = [future for lane in self._lanes for future, _ in lane.given]
        for future in futures:
            future.cancel()
        wait([future for future in futures if not future.cancelled()], timeout=patience)
        return [
            outcome
            for future in futures
            if future.done() and not future.cancelled() and future.exception() is None
            for outcome in future.result()
        ]

    def _hand_out(self) -> None:
        for lane in self._lanes:
            while self._waiting and lane.has_room:
                batch = self._batch()
                try:
                    lane.submit(batch, run_batch, *self._arguments)
                except BrokenExecutor:
                    self._waiting.extendleft(reversed(batch))
                    if lane.given:
                        break  # what became of the first of these says so too
                    self._mourn(lane)

    def _batch(self) -> list[Unit]:
        """Units for about `BATCH_SECONDS`, fewer towards the end; those that are suspected go alone."""
        batch = [self._waiting.popleft()]
        if batch[0].key in self._alone or self._pace is None:
            return batch
        share = len(self._waiting) // (2 * sum(lane.workers for lane in self._lanes) or 1)
        size = min(int(BATCH_SECONDS / max(self._pace, 1e-6)), MOST_IN_BATCH, share)
        while len(batch) < size and self._waiting and self._waiting[0].key not in self._alone:
            batch.append(self._waiting.popleft())
        return batch

    def _taken(self, lane: Lane) -> list[Outcome]:
        """Outcomes of the batches of a lane that are through."""
        found: list[Outcome] = []
        for future, batch in list(lane.given):
            if not future.done() or (future, batch) not in lane.given:
                continue
            failure = _failure(future)
            if failure is None:
                lane.given.remove((future, batch))
                found += self._settled(future.result(), batch)
            else:
                found += self._lost(lane, future, batch, failure)
        return found

    def _settled(self, outcomes: list[Outcome], batch: list[Unit]) -> list[Outcome]:
        """Outcomes of a batch; units that were not come to are to be run yet."""
        if any(outcome.status == OTHER_VERSION for outcome in outcomes):
            raise TorsadeError(
                "the workers have another version of torsade than this command; give them the same, and "
                "start them anew"
            )
        through = {outcome.key for outcome in outcomes}
        self._waiting.extendleft(unit for unit in reversed(batch) if unit.key not in through)
        for outcome in outcomes:
            self._pace = outcome.wall if self._pace is None else 0.9 * self._pace + 0.1 * outcome.wall
        self._in_vain = 0
        return outcomes

    def _lost(
        self, lane: Lane, future: Future[Any], batch: list[Unit], failure: BaseException
    ) -> list[Outcome]:
        """What to do about a batch whose worker was killed: it is given again, one by one."""
        if isinstance(failure, CancelledError):
            raise TorsadeError(
                "the scheduler let go of the sweep; the same command goes on with what is left"
            )
        if isinstance(failure, BrokenExecutor):
            # All batches of the lane are lost, and the first is what ran.
            future, batch = lane.given.popleft()
            for _, other in reversed(lane.given):
                self._waiting.extendleft(reversed(other))
            lane.given.clear()
            self._mourn(lane)
        else:
            lane.given.remove((future, batch))
            self.killed += 1
        self._alone.update(unit.key for unit in batch)
        if len(batch) > 1:
            self._waiting.extendleft(reversed(batch))
            return []
        (unit,) = batch
        self._deaths[unit.key] += 1
        if self._deaths[unit.key] < MOST_DEATHS and isinstance(failure, BrokenExecutor):
            self._waiting.appendleft(unit)
            return []
        return [Outcome(unit.key, "failed", _reason(failure), {}, 0.0, {})]

    def _mourn(self, lane: Lane) -> None:
        self.killed += 1
        self._in_vain += 1
        if not lane.remake():
            raise TorsadeError(
                "the executor has lost its workers and cannot be used any more; give a new one, which goes "
                "on with what is left"
            )
        if self._in_vain > MOST_IN_VAIN:
            raise TorsadeError(
                f"{counted(self._in_vain, 'worker')} died one after another and nothing got done; see "
                "whether memory is short, or torsade run works"
            )


def _failure(future: Future[Any]) -> BaseException | None:
    try:
        return future.exception()
    except CancelledError as error:
        return error


def _reason(failure: BaseException) -> str:
    """Why a unit failed whose worker did not come back."""
    if isinstance(failure, BrokenExecutor) or type(failure).__name__ == "KilledWorker":
        return (
            f"the process that ran it was killed {MOST_DEATHS} times or more, as it is when memory runs out; "
            "give it more memory or fewer workers"
        )
    return f"{type(failure).__name__}: " + " ".join(str(failure).split()).rstrip(".")[:300]

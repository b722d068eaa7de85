"""Running a specification: fibers set up, moved from frame to frame, measured and recorded."""

from __future__ import annotations

import math
import time
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from torsade import _compile, places
from torsade.arrays import Floats
from torsade.errors import TorsadeError
from torsade.motion.moving import Motion, Outcome
from torsade.protocols.interrupted import Interrupted
from torsade.recording import Recording
from torsade.results import Result
from torsade.stopping import STOPPING, Late, Patience
from torsade.units import evenly
from torsade.variables import SAMPLE

if TYPE_CHECKING:
    from torsade.protocols.base import Driven, Progress, Trial

__all__ = ["Interrupted", "compilation_told", "drive", "preparation"]

READY = "getting ready"
"""What is said before the first step."""

SAMPLE_EVERY = 0.01
"""Greatest time between samples [s]."""

FEWEST_SAMPLES, MOST_SAMPLES = 100, 1_000_000
"""Samples of a run, after the one at t = 0."""


def drive(
    spec: Driven, progress: Progress | None, out: str | Path | None, resume: bool, overwrite: bool
) -> Result:
    """Run a specification; see `Driven.run`."""
    tell = progress or (lambda share, note: None)
    try:
        with compilation_told(tell):
            trial = spec.prepared(tell)
    except KeyboardInterrupt as stopped:
        raise Interrupted(0.0, 0, None, earlier=_begun(out), when=str(stopped)) from None
    motion = trial.motion
    recording = _begin(spec, trial, out, resume, overwrite)
    try:
        if recording.complete:
            return recording.result()
        tell(0.0, READY)
        with compilation_told(tell):
            motion.warm_up()
        if recording.saved is not None:
            recording.recover(motion)
        clock = _Clock(spec.lasting, motion, tell)
        with Patience(clock.stopping) as patience:
            loose_at, over = _record(spec, trial, recording, clock, patience)
            numbers = dict(trial.conclude(recording.samples(), loose_at))
            return recording.finish(numbers | ({"over_at_s": motion.time} if over else {}))
    except Late:
        whole = None if out is None else Path(out)
        raise Interrupted(recording.reached, recording.done, None, whole=whole) from None
    except KeyboardInterrupt:
        recording.stop("interrupted")
        raise Interrupted(recording.reached, recording.done, recording.part) from None
    except TorsadeError as error:
        with suppress(TorsadeError):  # a full disk cannot take the last frames either
            recording.stop("failed")
        if recording.part is None:
            raise
        raise TorsadeError(
            f"{str(error).rstrip('.')} (the frames until then are in {str(recording.part)!r})"
        ) from None
    finally:
        recording.close()


def _begun(out: str | Path | None) -> Path | None:
    """The folder of what is done of an earlier run of that name, if there is one."""
    part = None if out is None else places.part_of(Path(out))
    return part if part is not None and places.attributes(part) else None


def _begin(spec: Driven, trial: Trial, out: str | Path | None, resume: bool, overwrite: bool) -> Recording:
    """A recording for all that this protocol measures."""
    attrs = spec.attributes() | {"start": trial.start} | dict(trial.about)
    samples = [SAMPLE + name for name in ("time", *trial.sampled)] if trial.sampled else []
    counts = {"time": len(_frame_times(spec, trial)), "sample": len(_sample_times(spec, trial))}
    return Recording.begin(
        counts | dict(trial.sizes),
        trial.fixed,
        (*trial.names, *trial.derived, *samples),
        attrs,
        trial.derive,
        tuple(trial.motion.saved()),
        out,
        resume=resume,
        overwrite=overwrite,
    )


def preparation() -> str:
    """What there is to do before the first step, as far as can be seen from what was kept."""
    kept = _compile.CACHE is not None and any(_compile.CACHE.rglob("*.nbc"))
    return READY if kept else _compilation()


def compilation_told(tell: Progress) -> AbstractContextManager[None]:
    """Whatever is done meanwhile, tell when kernels are compiled for it."""
    return _compile.when_compiling(lambda: tell(0.0, _compilation()))


def _compilation() -> str:
    """What is said when kernels are compiled."""
    if _compile.CACHE is None:
        return "compiling the kernels (up to a minute); set TORSADE_CACHE_DIR to a folder to keep them in"
    return "compiling the kernels, this once (up to a minute)"


class _Clock:
    """Tells how far a run has come."""

    def __init__(self, duration: float, motion: Motion, tell: Progress) -> None:
        self._duration, self._motion, self._tell = duration, motion, tell

    def tick(self) -> None:
        """Say what time it is."""
        self._say(f"t = {seconds(self._motion.time, self._duration)}")

    def stopping(self) -> None:
        """Say that Ctrl-C was heard."""
        self._say(STOPPING)

    def _say(self, note: str) -> None:
        self._tell(self._motion.time / self._duration, note)


def seconds(t: float, scale: float) -> str:
    """A time [s] in words, in the unit that suits a scale [s]."""
    return f"{t:.3f} s" if scale >= 0.1 else f"{1e3 * t:.3f} ms"


def _frame_times(spec: Driven, trial: Trial) -> Floats:
    """Times of frames [s]."""
    if trial.frame_times is not None:
        return trial.frame_times
    return np.array(evenly(0.0, spec.lasting, spec.frames))


def _sample_times(spec: Driven, trial: Trial) -> Floats:
    """Times of samples [s], none when nothing is sampled: every 10 ms, or a hundred in a short run."""
    if not trial.sampled:
        return np.empty(0)
    if trial.sample_times is not None:
        return trial.sample_times
    wanted = math.ceil(spec.lasting / SAMPLE_EVERY * (1 - 1e-9))
    return np.array(evenly(0.0, spec.lasting, min(max(wanted, FEWEST_SAMPLES), MOST_SAMPLES)))


def _stops(spec: Driven, trial: Trial) -> list[tuple[float, bool, bool]]:
    """Times at which a run stops [s], and whether for a frame, a sample, both, or other ends and loads."""
    stops: list[tuple[float, bool, bool]] = []
    marked = [(t, True, False) for t in _frame_times(spec, trial).tolist()]
    marked += [(t, False, True) for t in _sample_times(spec, trial).tolist()]
    marked += [(t, False, False) for t in trial.later if t < spec.lasting]
    for t, frame, sample in sorted(marked, key=lambda stop: stop[0]):
        if stops and t - stops[-1][0] <= 1e-9 * spec.lasting:
            t, *before = stops.pop()
            frame, sample = frame or before[0], sample or before[1]
        stops.append((t, frame, sample))
    return stops


def _record(
    spec: Driven, trial: Trial, recording: Recording, clock: _Clock, patience: Patience
) -> tuple[float | None, bool]:
    """Move from stop to stop to the end, or until nothing resists the load, or all is over.

    Returns when nothing resisted the load any more [s], or None, and whether all was over.
    """
    motion = trial.motion
    began = time.perf_counter() - recording.wall
    before = max(recording.reached, motion.time) if recording.done else -math.inf
    if motion.time > 0 and trial.over():
        return None, True
    for t, frame, sample in _stops(spec, trial):
        if t <= before * (1 + 1e-9):  # steps of one length end at a stop or just after it
            continue
        trial.begin(motion.time)
        outcome = Outcome.REACHED if t == 0 else _advance(trial, t, clock, patience)
        ended = outcome in (Outcome.SLIPPED, Outcome.OVER)
        if not ended or motion.time > before:
            if sample or (ended and trial.sampled):
                recording.sample({"time": motion.time} | trial.sample())
            if frame or ended:
                recording.add(trial.frame())
            recording.keep(motion.saved(), motion.steps, time.perf_counter() - began)
        if ended:
            return (motion.time if outcome is Outcome.SLIPPED else None), outcome is Outcome.OVER
        if t > 0 and (frame or sample) and trial.over():
            return None, True
        before = t
        clock.tick()
    return None, False


def _advance(trial: Trial, until: float, clock: _Clock, patience: Patience) -> Outcome:
    """Advance to a time [s], taking up slack whenever nothing resists the load and something still can."""
    motion = trial.motion
    caught_at = -1
    outcome = Outcome.PAUSED
    while outcome is Outcome.PAUSED:
        outcome = motion.advance(until, motion.at_once)
        patience.end()
        if outcome is Outcome.SLIPPED and motion.steps > caught_at:
            steps = motion.steps
            caught = trial.catch(until)
            if caught is not None:
                caught_at, outcome = steps, caught
        if outcome is Outcome.PAUSED:
            clock.tick()
    return outcome

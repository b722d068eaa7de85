"""Running a specification: fibers set up, moved from frame to frame, measured and recorded."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade import _compile, observables
from torsade.arrays import Floats
from torsade.assembly import Assembly, State, assemble, initial_state
from torsade.errors import TorsadeError
from torsade.motion.overdamped import Motion, Outcome, model
from torsade.protocols.patience import Interrupted, Patience
from torsade.protocols.shapes import check_frames
from torsade.recording import SAMPLE, Recording
from torsade.results import Result

if TYPE_CHECKING:
    from torsade.protocols.base import Experiment, Progress, Spec

__all__ = ["Interrupted", "drive"]

NODE_STEPS_AT_ONCE = 60_000
"""Steps times nodes between looks at the screen and at Ctrl-C: about 0.2 s.

A number and not a time, since the stepper makes a new neighbour list whenever it is called, and runs must
repeat to the bit.
"""

SAMPLE_EVERY = 0.01
"""Greatest time between samples [s]."""

FEWEST_SAMPLES, MOST_SAMPLES = 100, 1_000_000
"""Samples of a run, after the one at t = 0."""

SETTLING = 10
"""Fixed steps for which strands that just met are advanced in error-controlled steps instead.

Where few contacts bear the whole load they give way within less than a fixed step. Doubling or tripling
this moves the separation of the built-in bends at 0.3 s by less than 1e-4 of itself.
"""

COMMON = (
    "time",
    "compression",
    "twist",
    "energy_stretch",
    "energy_bend",
    "energy_twist",
    "energy_contact",
    "external_work",
    "dissipation",
    "position",
    "log_strain",
    "velocity",
    "self_torque",
    "strain_stretch",
    "strain_bend",
    "strain_twist",
)
"""What every protocol records."""


def drive(
    spec: Spec, progress: Progress | None, out: str | Path | None, resume: bool, overwrite: bool
) -> Result:
    """Run a specification; see `Spec.run`."""
    tell = progress or (lambda share, note: None)
    shape = spec.configuration()
    check_frames(spec.frames + 1, sum(len(x) for x in shape.strands))
    assembly = assemble(shape.strands, shape.closed)
    state = initial_state(assembly, shape.strands)
    experiment = spec.experiment(assembly, state)
    motion = Motion(
        assembly,
        model(spec.fiber_material, spec.section, spec.laws),
        experiment.boundary,
        state,
        spec.stepping,
    )
    recording = _begin(spec, assembly, state, experiment, out, resume, overwrite)
    try:
        if recording.complete:
            return recording.result()
        tell(0.0, _preparation())
        _warm_up(motion)
        if recording.checkpoint is not None:
            motion.restore(recording.checkpoint)
        clock = _Clock(spec.duration, motion, tell)
        with Patience(clock.stopping) as patience:
            loose_at, over = _record(spec, experiment, motion, recording, clock, patience)
            numbers = experiment.conclude(recording.samples(), loose_at)
            return recording.finish(numbers | ({"over_at_s": motion.time} if over else {}))
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


def _begin(
    spec: Spec,
    assembly: Assembly,
    state: State,
    experiment: Experiment,
    out: str | Path | None,
    resume: bool,
    overwrite: bool,
) -> Recording:
    """A recording for all that this protocol measures."""
    attrs = {
        "protocol": spec.protocol,
        "spec": json.dumps(spec.stored()),
        "knot": spec.shape_name,
        "radius": spec.h,
        "model": json.dumps(_meaning(spec)),
        "start": hashlib.sha256(state.x.tobytes()).hexdigest(),
    } | dict(experiment.about)
    own = experiment.measure(state)
    own |= dict.fromkeys(experiment.observed, 0.0)
    first = {name: np.array([value]) for name, value in ({"time": 0.0} | own).items()}
    samples = [SAMPLE + name for name in ("time", *experiment.sampled)] if experiment.sampled else []
    return Recording.begin(
        assembly,
        spec.frames + 1,
        len(_sample_times(spec, experiment)),
        (*COMMON, *own, *experiment.derive(first), *samples),
        attrs,
        experiment.derive,
        out,
        resume=resume,
        overwrite=overwrite,
    )


def _warm_up(motion: Motion) -> None:
    """Compile or load every kernel, and leave no trace."""
    start = motion.checkpoint()
    motion.advance(0.0)
    motion.measure()
    motion.restore(start)


def _preparation() -> str:
    """What there is to do before the first step."""
    if _compile.CACHE is None:
        return (
            "compiling the kernels (about half a minute); set TORSADE_CACHE_DIR to a folder to keep them in"
        )
    kept = any(_compile.CACHE.rglob("*.nbc"))
    return "getting ready" if kept else "compiling the kernels, this once (about half a minute)"


class _Clock:
    """Tells how far a run has come."""

    def __init__(self, duration: float, motion: Motion, tell: Progress) -> None:
        self._duration, self._motion, self._tell = duration, motion, tell

    def tick(self) -> None:
        """Say what time it is."""
        self._say(f"t = {self._motion.time:.3f} s")

    def stopping(self) -> None:
        """Say that Ctrl-C was heard."""
        self._say("stopping ... (Ctrl-C again to stop at once)")

    def _say(self, note: str) -> None:
        self._tell(self._motion.time / self._duration, note)


def _meaning(spec: Spec) -> dict[str, Any]:
    """The numbers behind the names in a specification, which another version may understand otherwise."""
    laws, stepping, material = (
        dataclasses.asdict(part) for part in (spec.laws, spec.stepping, spec.fiber_material)
    )
    del material["source"]
    return {
        "material": material,
        "radius": spec.h,
        "laws": laws,
        "stepping": stepping,
        "spacing": spec.node_spacing,
    }


def _sample_times(spec: Spec, experiment: Experiment) -> Floats:
    """Times of samples [s], none when nothing is sampled: every 10 ms, or a hundred in a short run."""
    if not experiment.sampled:
        return np.empty(0)
    wanted = math.ceil(spec.duration / SAMPLE_EVERY * (1 - 1e-9))
    return np.linspace(0.0, spec.duration, min(max(wanted, FEWEST_SAMPLES), MOST_SAMPLES) + 1)


def _stops(spec: Spec, experiment: Experiment) -> list[tuple[float, bool, bool]]:
    """Times at which a run stops [s], and whether for a frame, a sample, both, or other ends and loads."""
    frames = np.linspace(0.0, spec.duration, spec.frames + 1)
    stops: list[tuple[float, bool, bool]] = []
    marked = [(t, True, False) for t in frames.tolist()]
    marked += [(t, False, True) for t in _sample_times(spec, experiment).tolist()]
    marked += [(t, False, False) for t, _ in experiment.later if t < spec.duration]
    for t, frame, sample in sorted(marked, key=lambda stop: stop[0]):
        if stops and t - stops[-1][0] <= 1e-9 * spec.duration:
            t, *before = stops.pop()
            frame, sample = frame or before[0], sample or before[1]
        stops.append((t, frame, sample))
    return stops


def _record(
    spec: Spec,
    experiment: Experiment,
    motion: Motion,
    recording: Recording,
    clock: _Clock,
    patience: Patience,
) -> tuple[float | None, bool]:
    """Move from stop to stop to the end, or until nothing resists the load, or all is over.

    Returns when nothing resisted the load any more [s], or None, and whether all was over.
    """
    began = time.perf_counter() - recording.wall
    before = max(recording.reached, motion.time) if recording.done else -math.inf
    if motion.time > 0 and experiment.over(motion.state):
        return None, True
    for t, frame, sample in _stops(spec, experiment):
        if t <= before:
            continue
        motion.boundary = experiment.boundary_at(motion.time)
        outcome = Outcome.REACHED if t == 0 else _advance(experiment, motion, t, clock, patience)
        slipped = outcome is Outcome.SLIPPED
        if not slipped or motion.time > before:
            if sample or (slipped and experiment.sampled):
                now = experiment.measure(motion.state)
                recording.sample({"time": motion.time} | {name: now[name] for name in experiment.sampled})
            if frame or slipped:
                recording.add(_frame(experiment, motion, spec.h))
            recording.keep(motion.checkpoint(), time.perf_counter() - began)
        if slipped:
            return motion.time, False
        if t > 0 and (frame or sample) and experiment.over(motion.state):
            return None, True
        before = t
        clock.tick()
    return None, False


def _advance(
    experiment: Experiment, motion: Motion, until: float, clock: _Clock, patience: Patience
) -> Outcome:
    """Advance to a time [s], taking up slack whenever nothing resists the load and something still can."""
    at_once = max(1, NODE_STEPS_AT_ONCE // len(motion.state.x))
    caught_at = -1
    outcome = Outcome.PAUSED
    while outcome is Outcome.PAUSED:
        outcome = motion.advance(until, at_once)
        patience.end()
        if outcome is Outcome.SLIPPED and motion.steps > caught_at and experiment.catch(motion.state):
            caught_at = motion.steps
            outcome = _settle(motion, until)
        if outcome is Outcome.PAUSED:
            clock.tick()
    return outcome


def _settle(motion: Motion, until: float) -> Outcome:
    """Let strands that just met settle: for `SETTLING` fixed steps the steps are error-controlled."""
    control = motion.control
    if control.fixed_step == 0.0:
        return Outcome.PAUSED
    motion.control = control._replace(fixed_step=0.0)
    try:
        outcome = motion.advance(min(until, motion.time + SETTLING * control.fixed_step))
    finally:
        motion.control = control
    return outcome if motion.time >= until or outcome is Outcome.SLIPPED else Outcome.PAUSED


def _frame(experiment: Experiment, motion: Motion, radius: float) -> dict[str, float | Floats]:
    """Everything recorded at the present time."""
    assembly, state, now = motion.assembly, motion.state, motion.measure()
    strain = observables.surface_strain(assembly, state, radius)
    common: dict[str, float | Floats] = {
        "time": motion.time,
        "compression": now.compression,
        "twist": observables.twist(assembly, state),
        "energy_stretch": now.energies.stretch,
        "energy_bend": now.energies.bend,
        "energy_twist": now.energies.twist,
        "energy_contact": now.energies.contact,
        "external_work": motion.external_work,
        "dissipation": motion.dissipation,
        "position": state.x,
        "log_strain": strain.log,
        "strain_stretch": strain.stretch,
        "strain_bend": strain.bend,
        "strain_twist": strain.twist,
        "velocity": state.v,
        "self_torque": now.self_torque,
    }
    return common | experiment.measure(state) | experiment.observe(state, now)

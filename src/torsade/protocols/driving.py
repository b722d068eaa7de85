"""Running a specification: fibers set up, moved from frame to frame, measured and recorded."""

from __future__ import annotations

import hashlib
import json
import signal
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from torsade import _compile, observables
from torsade.arrays import Floats
from torsade.assembly import Assembly, State, assemble, initial_state
from torsade.centerline import Centerline, check, read_csv
from torsade.curve import length, resample
from torsade.errors import TorsadeError
from torsade.motion.overdamped import Motion, Outcome, model
from torsade.recording import Recording
from torsade.results import Result

if TYPE_CHECKING:
    from torsade.protocols.base import Experiment, Progress, Spec

__all__ = ["Interrupted", "check_count", "drive", "read_centerline"]

STEPS_AT_ONCE = 2000
"""Steps between looks at the clock of the screen and at Ctrl-C. Part of what makes runs repeat to the
bit: the stepper makes a new neighbour list whenever it is called."""


LARGEST_COUNT = 100_000
"""Most nodes of a run: a step then takes about a second."""

LARGEST_RESULT = 4_000_000_000
"""Most that positions and strains of all frames may take in memory [bytes]."""

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
)
"""What every protocol records."""


class Patience:
    """While it lasts, Ctrl-C waits for the next call of `end`, so that no step or write is cut in half.

    A second Ctrl-C does not wait. Another handler than Python's own is left in place.
    """

    def __init__(self) -> None:
        self._asked = False
        self._installed = False

    def __enter__(self) -> Patience:
        ours = threading.current_thread() is threading.main_thread()
        if ours and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, self._note)
            self._installed = True
        return self

    def __exit__(self, *_: object) -> None:
        if self._installed:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def _note(self, *_: object) -> None:
        if self._asked:
            raise KeyboardInterrupt
        self._asked = True

    def end(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C was pressed."""
        if self._asked:
            raise KeyboardInterrupt


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run, after what there is was saved.

    Attributes: `time` reached [s], `frames` recorded, `part`, the folder that holds them, or None.
    """

    def __init__(self, time: float, frames: int, part: Path | None) -> None:
        self.time, self.frames, self.part = time, frames, part
        reached = f"at t = {time:.4g} s" if frames else "before the first frame"
        kept = "nothing is saved" if part is None else f"{frames} frames are saved in {str(part)!r}"
        super().__init__(f"interrupted {reached}; {kept}")


def read_centerline(path: str, spec: Spec, strands: int, wanted: str) -> Centerline:
    """Open strands from a CSV file, checked as given, then resampled as the specification wants."""
    shape = read_csv(path)
    if len(shape.strands) != strands:
        other = {1: "tighten takes one", 2: "prison-escape takes two"}.get(len(shape.strands))
        advice = f"; {other}" if other else ""
        has = "1 strand" if len(shape.strands) == 1 else f"{len(shape.strands)} strands"
        raise TorsadeError(f"{path!r} has {has}, and {wanted}{advice or f'; give {strands}'}")
    check_count(sum(len(x) for x in shape.strands))
    check(shape, spec.h)
    for k, closed in enumerate(shape.closed):
        if closed:
            raise TorsadeError(f"strand {k} in {path!r} is closed and has no ends to pull; cut it open")
    if spec.node_spacing is None:
        return shape
    check_count(sum(length(x) for x in shape.strands) / spec.node_spacing)
    resampled = Centerline(tuple(resample(x, spacing=spec.node_spacing) for x in shape.strands))
    check(resampled, spec.h)
    return resampled


def check_count(nodes: float) -> None:
    """Refuse more nodes than a run can move."""
    if nodes > LARGEST_COUNT:
        raise TorsadeError(
            f"the fibers have {nodes:.0f} nodes, more than the {LARGEST_COUNT} that a run can move; give a "
            "larger spacing, or shorter fibers"
        )


def _check_frames(frames: int, nodes: int) -> None:
    """Refuse more frames than memory holds."""
    size = 16 * nodes
    if frames * size > LARGEST_RESULT:
        raise TorsadeError(
            f"{frames} frames of {nodes} nodes take {frames * size / 1e9:.1f} GB; give at most "
            f"{LARGEST_RESULT // size - 1} frames, or a larger spacing"
        )


def drive(
    spec: Spec, progress: Progress | None, out: str | Path | None, resume: bool, overwrite: bool
) -> Result:
    """Run a specification; see `Spec.run`."""
    tell = progress or (lambda share, note: None)
    shape = spec.configuration()
    _check_frames(spec.frames + 1, sum(len(x) for x in shape.strands))
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
        with Patience() as patience:
            loose_at = _record(spec, experiment, motion, recording, tell, patience)
            return recording.finish(experiment.conclude(recording.histories(), loose_at))
    except KeyboardInterrupt:
        recording.stop("interrupted")
        raise Interrupted(motion.time, recording.done, recording.part) from None
    except TorsadeError as error:
        if recording.part is None:
            raise
        with suppress(TorsadeError):  # a full disk cannot take the last frames either
            recording.stop("failed")
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
        "start": hashlib.sha256(state.x.tobytes()).hexdigest(),
    }
    own = experiment.measure(state)
    first = {name: np.array([value]) for name, value in ({"time": 0.0} | own).items()}
    return Recording.begin(
        assembly,
        spec.frames + 1,
        (*COMMON, *own, *experiment.derive(first)),
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
        return "compiling the kernels (about a minute); set TORSADE_CACHE_DIR to a folder to keep them in"
    kept = any(_compile.CACHE.rglob("*.nbc"))
    return "getting ready" if kept else "compiling the kernels, this once (about a minute)"


def _record(
    spec: Spec,
    experiment: Experiment,
    motion: Motion,
    recording: Recording,
    tell: Progress,
    patience: Patience,
) -> float | None:
    """Move from frame to frame to the end; returns when nothing resisted the load any more [s], or None."""
    times = np.linspace(0.0, spec.duration, spec.frames + 1)
    began = time.perf_counter() - recording.wall
    for k in range(recording.done, len(times)):
        outcome = Outcome.REACHED if k == 0 else _advance(experiment, motion, float(times[k]), patience)
        tell(motion.time / spec.duration, f"t = {motion.time:.3f} s")
        slipped = outcome is Outcome.SLIPPED
        if not slipped or motion.time > times[k - 1]:
            frame = _frame(experiment, motion, spec.h)
            recording.add(frame, motion.checkpoint(), time.perf_counter() - began)
        if slipped:
            return motion.time
    return None


def _advance(experiment: Experiment, motion: Motion, until: float, patience: Patience) -> Outcome:
    """Advance to a time [s], taking up slack whenever nothing resists the load and something still can."""
    caught_at = -1
    outcome = Outcome.PAUSED
    while outcome is Outcome.PAUSED:
        outcome = motion.advance(until, STEPS_AT_ONCE)
        patience.end()
        if outcome is Outcome.SLIPPED and motion.steps > caught_at and experiment.catch(motion.state):
            caught_at = motion.steps
            outcome = _settle(motion, until)
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
        "log_strain": observables.log_strain(assembly, state, radius),
    }
    return common | experiment.measure(state)

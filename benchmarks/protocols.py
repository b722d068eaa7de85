"""Where the time of every protocol's run goes, and integrators and solvers on those that are overdamped.

Every run is taken twice; the second counts, when kernels are loaded. Times are the processor's.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks import common
from torsade.fracture.cascade import Cascade
from torsade.motion import stepping
from torsade.motion.inertial import Inertial
from torsade.motion.moving import Outcome
from torsade.motion.overdamped import Motion, Stepping
from torsade.protocols import (
    Battery,
    BendTwist,
    Pendulum,
    PrisonEscape,
    Reidemeister,
    SnapQuench,
    SnapTwist,
    Spec,
    Suture,
    Tighten,
)
from torsade.protocols.base import Driven, Trial
from torsade.recording import Recording
from torsade.rod.factor import no_factor

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"

TYPICAL: tuple[Spec, ...] = (
    PrisonEscape(knot="reef", duration="0.5 s"),
    Tighten(knot="overhand", duration="0.5 s"),
    Reidemeister(move="R2"),
    Battery(knot="4_1", twist=2.0),
    Suture(throws="5,-3", duration="2 s"),
    BendTwist(end_distance="19 cm", twist="270 deg"),
    SnapTwist(twist="60 deg", disorder=0.05),
    SnapQuench(speed="0.5 m/s"),
    Pendulum(),
)
QUICK: tuple[Spec, ...] = (
    PrisonEscape(knot="reef", duration="1 ms", frames=2),
    SnapTwist(twist="60 deg", duration="0.1 ms", frames=2),
)
SET_UP, MOVED, MEASURED, STORED = "set up", "moved", "measured", "stored"
PHASES = (SET_UP, MOVED, MEASURED, STORED)
HEADS = ("protocol", "time [s]", *PHASES, "all else", "steps", "refused", "evaluations")

OVERDAMPED: tuple[Driven, ...] = (
    PrisonEscape(knot="reef", duration="0.1 s"),
    Tighten(knot="overhand", duration="0.1 s"),
    Reidemeister(move="R2", duration="2 s"),
    Battery(knot="4_1", twist=2.0),
)
SHORT = {"prison-escape": 0.1, "tighten": 0.1, "reidemeister": 2.0, "battery": 0.3}
"""For how long each of them is moved [s]."""

STABLE = 0.9
"""Of the longest stable explicit step, 2 over the spectral radius at the start."""

TAUT = 1e-4
"""How long a fiber is pulled first, until something resists [s]."""

EXACT = 1e-5
"""Tolerance of the motion that the others are compared with."""


class Watch:
    """Processor time by phase; what happens within another phase counts for its own."""

    def __init__(self) -> None:
        self.taken: Counter[str] = Counter()
        self._inside: list[float] = []

    def over(self, phase: str, call: Callable[..., Any]) -> Callable[..., Any]:
        """The same call, timed."""

        def timed(*arguments: Any, **options: Any) -> Any:
            began = common.CLOCK()
            self._inside.append(0.0)
            try:
                return call(*arguments, **options)
            finally:
                whole = common.CLOCK() - began
                self.taken[phase] += whole - self._inside.pop()
                if self._inside:
                    self._inside[-1] += whole

        return timed


def watched(spec: Spec, out: Path) -> dict[str, Any]:
    """Phases of one run, written to disk."""
    watch, motions = Watch(), []

    def prepared(self: Any, tell: Any) -> Trial:
        trial: Trial = original(self, tell)
        motions.append(trial.motion)
        return trial._replace(
            frame=watch.over(MEASURED, trial.frame),
            sample=watch.over(MEASURED, trial.sample),
            conclude=watch.over(MEASURED, trial.conclude),
        )

    with ExitStack() as patches:
        if isinstance(spec, Driven):
            original = type(spec).prepared
            patches.enter_context(patch.object(type(spec), "prepared", watch.over(SET_UP, prepared)))
        for kind in (Motion, Inertial, Cascade):
            patches.enter_context(patch.object(kind, "advance", watch.over(MOVED, kind.advance)))
        for name in ("begin", "sample", "add", "keep", "finish"):
            patches.enter_context(patch.object(Recording, name, watch.over(STORED, getattr(Recording, name))))
        began = common.CLOCK()
        spec.run(out=out)
        whole = common.CLOCK() - began
    motion = getattr(motions[0], "motion", motions[0]) if motions else None
    counts = getattr(motion, "counts", {"steps": getattr(motion, "steps", None)})
    return {
        "protocol": spec.protocol,
        "time": whole,
        **{phase: watch.taken[phase] / whole for phase in PHASES},
        "rest": 1.0 - sum(watch.taken.values()) / whole,
        **{name: counts.get(name) for name in ("steps", "refused", "evaluations")},
    }


def start(spec: Driven) -> Motion:
    """The motion of a specification, its strands taut; of a battery, the closed fiber at its start."""
    if isinstance(spec, Battery):
        from torsade.motion import ends

        assembly, state = spec.tied()
        return Motion(assembly, spec.model(), ends.free(assembly), state, spec.stepping)
    trial = spec.trial()
    trial.begin(0.0)
    motion = getattr(trial.motion, "motion", trial.motion)
    assert isinstance(motion, Motion)
    for _ in range(100):
        if motion.advance(TAUT) is not Outcome.SLIPPED:
            break
        trial.catch(TAUT)
    return motion


def moved(motion: Motion, how: Stepping, until: float, direct: bool) -> dict[str, Any]:
    """Time and end of a motion from its start, with one integrator and one solver."""
    again = Motion(motion.assembly, motion.model, motion.boundary, motion.state, how)
    factor: Any = no_factor() if direct else ()
    arguments = (again.assembly, again.model, again.boundary, again.control, again.state, again._clock)
    stepping.advance(*arguments, 0.0, 1, again._scratch, factor)  # compiles
    began = common.CLOCK()
    status = stepping.advance(*arguments, until, 2**62, again._scratch, factor)
    return {"time": common.CLOCK() - began, "x": again.state.x, "ended": status, **again.counts}


def compared(spec: Driven, until: float, exact: float) -> list[dict[str, Any]]:
    """Integrators and solvers on one protocol: time over that of the default, and error [radii]."""
    motion = start(spec)
    usual = motion_stepping(spec)
    reference = moved(motion, Stepping(tolerance=exact), until, True)["x"]
    probe = Motion(motion.assembly, motion.model, motion.boundary, motion.state, usual)
    probe.advance(until, 1)
    stable = STABLE * 2.0 / float(probe.checkpoint().time[4])
    ways = {
        "controlled, 1e-2, direct": (Stepping(), True),
        "controlled, 1e-3, direct": (Stepping(tolerance=1e-3), True),
        "controlled, 1e-1, direct": (Stepping(tolerance=1e-1), True),
        "explicit, longest stable, direct": (Stepping(fixed_step=stable), True),
        "controlled, 1e-2, conjugate gradients": (Stepping(), False),
    }
    rows: list[dict[str, Any]] = []
    for name, (how, direct) in ways.items():
        found = moved(motion, how, until, direct)
        off = float(np.abs(found["x"] - reference).max()) / spec.h
        rows.append(
            {
                "protocol": spec.protocol,
                "way": name,
                "time": found["time"],
                "ratio": found["time"] / rows[0]["time"] if rows else 1.0,
                "steps": found["steps"],
                "evaluations": found["evaluations"],
                "off_radii": off if found["ended"] == stepping.REACHED else None,
            }
        )
    return rows


def motion_stepping(spec: Driven) -> Stepping:
    """How time advances by default in a specification."""
    return getattr(spec, "stepping", Stepping())


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    given = options.parse_args(arguments)
    rows = []
    with TemporaryDirectory() as folder:
        for k, spec in enumerate(QUICK if given.quick else TYPICAL):
            spec.run()
            rows.append(watched(spec, Path(folder) / f"{k}.zarr"))
    ways: list[dict[str, Any]] = []
    for spec in OVERDAMPED[:1] if given.quick else OVERDAMPED:
        until = 1e-3 if given.quick else SHORT[spec.protocol]
        ways += compared(spec, until, 1e-3 if given.quick else EXACT)
    shares = (*PHASES, "rest")
    profile = common.table(
        HEADS,
        [
            [
                r["protocol"],
                r["time"],
                *(_percent(r[s]) for s in shares),
                r["steps"],
                r["refused"],
                r["evaluations"],
            ]
            for r in rows
        ],
    )
    choice = common.table(
        ("protocol", "steps, solver", "time [s]", "ratio", "steps", "evaluations", "off by [radii]"),
        [list(r.values()) for r in ways],
    )
    if given.write:
        common.put(profile, PAGE, "protocols")
        common.put(choice, PAGE, "integrators")
    return common.show({"runs": rows, "ways": ways}, [profile, choice], given.json)


if __name__ == "__main__":
    main()

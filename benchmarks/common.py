"""What the benchmarks share: fibers to move, clocks and tables."""

from __future__ import annotations

import argparse
import json
import math
import statistics
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np

from torsade.assembly import assemble, initial_state
from torsade.errors import TorsadeError
from torsade.material import preset
from torsade.motion import ends, near, rates, scheme
from torsade.motion.overdamped import Motion, Outcome, Stepping, model
from torsade.protocols.prison_escape import PrisonEscape
from torsade.rod.contact import find_drag
from torsade.rod.factor import WORTH, Factor, no_factor, pattern
from torsade.rod.kinematics import edge_geometry
from torsade.rod.neighbours import edge_midpoints

NYLON = preset("nylon")

CLOCK = time.process_time
WALL = time.perf_counter
"""Processor time [s]: what others do on the machine counts less than on the clock on the wall."""

BENDS = ("reef", "granny", "grief", "thief", "carrick14", "zeppelin14", "alpine24")
"""Centerlines that `--data` may hold, as NAME.csv."""

BUILT_IN = ("reef", "granny", "grief", "thief")


def parser(description: str | None) -> argparse.ArgumentParser:
    """Options that every benchmark has."""
    options = argparse.ArgumentParser(description=(description or "").splitlines()[0])
    options.add_argument("--json", action="store_true", help="print numbers as JSON instead of a table")
    options.add_argument("--quick", action="store_true", help="a run of seconds that shows that it works")
    return options


def show(found: dict[str, Any], tables: Sequence[str], as_json: bool) -> dict[str, Any]:
    """Print numbers as JSON, or their tables; returns the numbers."""
    print(json.dumps(found, indent=1) if as_json else "\n\n".join(tables))
    return found


def table(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table; numbers to three digits."""
    lines = [heads, ["---"] * len(heads), *[[_text(cell) for cell in row] for row in rows]]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _text(cell: object) -> str:
    if cell is None:
        return "-"
    if isinstance(cell, float):
        if not math.isfinite(cell):
            return "-"
        return f"{cell:.0f}" if abs(cell) >= 1000 else f"{cell:.3g}"
    return f"{cell:,}" if isinstance(cell, int) else str(cell)


def put(text: str, page: Path, name: str) -> None:
    """Replace what stands between the marks of this name in a page of the docs.

    Raises
    ------
    TorsadeError
        When the page has no such marks.
    """
    begin, end = f"<!-- {name}:begin -->", f"<!-- {name}:end -->"
    old = page.read_text(encoding="utf-8")
    if not 0 <= old.find(begin) < old.find(end):
        raise TorsadeError(f"{page} lacks the marks {begin} and {end}; put them where the table belongs")
    before, rest = old.split(begin, 1)
    after = rest.split(end, 1)[1]
    page.write_text(f"{before}{begin}\n{text}\n{end}{after}", encoding="utf-8")


def seconds(call: Callable[[], object], repeats: int, clock: Callable[[], float] = CLOCK) -> float:
    """Median time of a call [s], after one that is not counted; of this process unless by another clock."""
    call()
    taken = []
    for _ in range(repeats):
        began = clock()
        call()
        taken.append(clock() - began)
    return statistics.median(taken)


def rope(
    nodes: int, spacing: float = 0.6, strain: float = 0.03, fixed_step: float = 0.0, speed: float = 1e-3
) -> Motion:
    """A taut rope of two strands, nodes in sum, in contact all along; its ends are drawn apart.

    A double helix of pitch 20 radii, spacing [radii] between nodes, strained from the start so that
    tension presses the strands together; a longer rope is more of the same. speed [m/s] of the far ends.
    """
    h, n = NYLON.radius, nodes // 2
    pitch, off_axis = 20 * h, 0.97 * h
    turn = 2 * math.pi / math.hypot(pitch, 2 * math.pi * off_axis) * spacing * h * np.arange(n)
    strands = [
        np.column_stack([pitch / (2 * math.pi) * turn, c * np.cos(turn), c * np.sin(turn)])
        for c in (off_axis, -off_axis)
    ]
    rest = [np.linalg.norm(np.diff(x, axis=0), axis=1) / (1 + strain) for x in strands]
    a = assemble(strands, rest_lengths=rest)
    boundary = ends.free(a)
    for fiber in range(2):
        boundary = ends.clamp(boundary, a, fiber, 0, tangent=True)
        boundary = ends.move(boundary, a, fiber, 1, np.array([speed, 0.0, 0.0]), tangent=True)
    how = Stepping(fixed_step=fixed_step)
    return Motion(a, model(NYLON.material, NYLON.section), boundary, initial_state(a, strands), how)


def pulled_bend(knot: str, spacing: float, until: float) -> Motion:
    """A built-in bend, spacing [radii] between nodes, pulled for a time [s] with 15 N."""
    spec = PrisonEscape(knot=knot, spacing=spacing * NYLON.radius)
    shape = spec.configuration()
    a = assemble(shape.strands, shape.closed)
    state = initial_state(a, shape.strands)
    experiment = spec.experiment(a, state)
    m = model(spec.fiber_material, spec.section, spec.laws)
    motion = Motion(a, m, experiment.boundary, state, spec.stepping)
    for _ in range(100):
        if motion.advance(until) is not Outcome.SLIPPED:
            return motion
        experiment.catch(motion.state)
    raise TorsadeError(f"the {knot} does not hold for {until:g} s; give a shorter time.")


class Moment(NamedTuple):
    """One moment of a motion, ready for kernels: what is near, and scratch filled by an evaluation."""

    near: near.Near
    factor: Factor
    stages: scheme.Stages
    guess: np.ndarray

    @property
    def contacts(self) -> int:
        return int(self.near.contacts.count[0])


def capture(motion: Motion) -> Moment:
    """The present moment; the guess of the velocities is that of one step before."""
    a, m, bc, control = motion.assembly, motion.model, motion.boundary, motion.control
    guess = motion.state.v.copy()
    motion.advance(motion.time + 1.0, 1)
    state, g = motion.state, scheme.stage_work(a)
    edge_geometry(a, state.x, g.length, g.tangent)
    edge_midpoints(state.x, a.edges, g.mid)
    beside = near.find_near(a, m, control, g.mid, g.length)
    g.x[:], g.theta[:], g.v[:] = state.x, state.theta, state.v
    factor = no_factor()
    for _ in range(2):
        status = rates.rates(
            a, m, bc, g.x, g.theta, g.tangent, state.reference_twist, beside.contacts, factor,
            control.solver_tolerance, g.v, g.omega, g.angular, g.work,
        )  # fmt: skip
        if status == rates.STALE:
            factor = pattern(a, beside.contacts, g.work.mid, m.diameter, WORTH)
    find_drag(a, m, state.x, g.work.length, g.work.mid, beside.contacts)
    g.v0[:], g.angular0[:] = g.v, g.angular
    return Moment(beside, factor, g, guess)


def loop(kernel: Any, returns_number: bool = False) -> Callable[..., None]:
    """A compiled loop that calls a kernel so often: called from Python, it costs microseconds more.

    Kernels that only return a number are kept from being left out or called but once.
    """
    trace = np.zeros(1)

    @numba.njit
    def many(times, arguments, trace):  # type: ignore[no-untyped-def]
        for k in range(times):
            if returns_number:
                trace[0] = k + 1e-300 * kernel(*arguments)
            else:
                kernel(*arguments)

    return lambda times, arguments: many(times, arguments, trace)


def passes(call: Callable[[int], object], at_least: float) -> int:
    """How many passes of call(times) take at least so long [s]."""
    call(1)
    times = 1
    while True:
        began = CLOCK()
        call(times)
        taken = CLOCK() - began
        if taken >= at_least or times > 10**7:
            return times
        times = max(2 * times, int(1.2 * times * at_least / max(taken, 1e-9)))


def in_loop(call: Callable[[int], object], at_least: float, repeats: int = 7) -> float:
    """Median time of one pass [s] of call(times), in loops that take at least so long [s]."""
    times = passes(call, at_least)
    return seconds(lambda: call(times), repeats) / times


def data_files(folder: str | None, names: Sequence[str]) -> tuple[dict[str, Path], str]:
    """Centerlines found in a folder, and one sentence about those that are not there."""
    if folder is None:
        return {}, "No --data folder of centerlines is given; only the built-in bends are pulled."
    paths = {name: Path(folder) / f"{name}.csv" for name in names}
    found = {name: path for name, path in paths.items() if path.is_file()}
    missing = [name for name in names if name not in found]
    return found, f"Not in {folder}, so left out: {', '.join(missing)}." if missing else ""

"""The loop that advances overdamped fibers in time, compiled."""

from __future__ import annotations

from typing import NamedTuple

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index, Ints
from torsade.assembly import Assembly, State
from torsade.motion.ends import Boundary
from torsade.motion.guard import first_crossing, largest_move
from torsade.motion.rates import LOOSE, OK, Near, list_near, powers
from torsade.motion.scheme import (
    ONE_STAGE,
    SPECTRUM,
    START,
    STEP,
    Control,
    Stages,
    copy,
    copy_flat,
    embedded_error,
    evaluate,
    stages_for,
)
from torsade.rod.contact import Model
from torsade.rod.kinematics import edge_geometry, reference_twist, transport_directors
from torsade.rod.neighbours import edge_midpoints, neighbour_pairs

REACHED = 0
SLIPPED = 1
CROSSING = 2
STUCK = 3
UNSOLVABLE = 4
PAUSED = 5

STEPS_PER_SPECTRUM = 25


class Clock(NamedTuple):
    """What a run carries from step to step, in arrays so that kernels can write them.

    time (5,): t [s], next step [s], external work [J], dissipation [J], spectral radius [1/s].
    count (5,): steps, refused steps, evaluations of the rates, neighbour lists made, steps since the
    spectral radius was estimated. culprit (2,): the edges that stopped the run.
    """

    time: Floats
    count: Ints  # type: ignore[assignment]  # hides tuple.count
    culprit: Ints


def _commit(a: Assembly, state: State, g: Stages) -> None:
    """Accept g.x, g.theta: carry the directors along and unwrap the reference twist."""
    transport_directors(state.director, g.tangent, g.work.tangent)
    copy_flat(g.work.change, state.reference_twist)
    reference_twist(state.director, g.work.tangent, a.hinges, state.reference_twist)
    copy(g.work.tangent, g.tangent)
    copy_flat(g.work.length, g.length)
    copy(g.work.mid, g.mid)
    copy(g.x, state.x)
    copy_flat(g.theta, state.theta)
    _take_rates(state, g)


def _take_rates(state: State, g: Stages) -> None:
    """The rates just found are those at the start of the next step; at a base tangent they are spins."""
    copy(g.v, state.v)
    copy_flat(g.omega, state.omega)
    copy(g.v, g.v0)
    copy_flat(g.omega, g.angular0)


def _list_near(a: Assembly, m: Model, control: Control, state: State, g: Stages, clock: Clock) -> Near:
    """A new Verlet list around the present positions."""
    copy(state.x, g.listed)
    edge_midpoints(state.x, a.edges, g.mid)
    clock.count[3] += 1
    return list_near(a, m, g.mid, g.length, control.skin)


def _take_spectrum(g: Stages, clock: Clock) -> None:
    """Note the spectral radius just estimated, and choose a first step from it."""
    clock.count[2] += int(g.estimate[1])
    clock.time[4] = max(1.1 * g.estimate[0], 1e-300)
    clock.count[4] = 0
    if clock.time[1] <= 0.0:
        clock.time[1] = 1.0 / clock.time[4]


def _next_step(control: Control, clock: Clock, until: float) -> tuple[float, bool]:
    """The step to try [s], and whether it ends at the time until."""
    remaining = until - clock.time[0]
    dt = control.fixed_step if control.fixed_step > 0.0 else clock.time[1]
    if dt >= remaining * (1.0 - 1e-9):
        return remaining, True
    if control.fixed_step == 0.0 and dt > 0.5 * remaining:
        return 0.5 * remaining, False
    return dt, False


def _crossing(
    a: Assembly, m: Model, control: Control, state: State, near: Near, g: Stages, move: float
) -> tuple[Index, Index]:
    """Edges that would pass through each other in the step to g.x, or (-1, -1)."""
    pairs = near.guarded
    if move > control.move:
        reach = m.diameter
        for e in range(g.length.shape[0]):
            reach = max(reach, g.length[e])
        pairs = neighbour_pairs(a, g.mid, reach + control.skin + 2.0 * move, 1, 0.0)
    k = first_crossing(a, pairs, state.x, g.x, g.length, g.mid)
    return (pairs[k, 0], pairs[k, 1]) if k >= 0 else (-1, -1)


def _try_step(
    a: Assembly,
    m: Model,
    bc: Boundary,
    state: State,
    near: Near,
    control: Control,
    dt: float,
    g: Stages,
    clock: Clock,
) -> tuple[float, float, int]:
    """Take a step dt [s] into g; returns the step taken, its error over the tolerance and a verdict.

    A verdict of REACHED accepts the step; SLIPPED, CROSSING, STUCK and UNSOLVABLE refuse it.
    """
    ratio = 0.0
    stages: Index = ONE_STAGE
    if control.fixed_step == 0.0:
        stages, dt = stages_for(dt, clock.time[4])
    status = evaluate(STEP, a, m, bc, state, near, control, dt, stages, g)
    clock.count[2] += stages
    if status == OK and control.fixed_step == 0.0:
        ratio = embedded_error(state, g, dt, control.radius) / control.tolerance
    if status != OK:
        return dt, 8.0, SLIPPED if status == LOOSE else UNSOLVABLE
    if not ratio <= 1.0:
        return dt, ratio, STUCK
    move = largest_move(state.x, g.x)
    if not move < 1e300:
        return dt, 8.0, UNSOLVABLE
    clock.culprit[0], clock.culprit[1] = _crossing(a, m, control, state, near, g, move)
    if clock.culprit[0] >= 0:
        return dt, 8.0, CROSSING
    if control.fixed_step == 0.0 and move > control.move:
        return dt, min(8.0, (1.25 * move / control.move) ** 3), STUCK
    return dt, ratio, REACHED


def _adapt(tried: float, dt: float, ratio: float, growth: float, clock: Clock) -> None:
    """Choose the next step from the error of the last; a step cut short may not shorten it."""
    proposal = dt * min(growth, max(0.2, 0.8 * max(ratio, 1e-9) ** (-1.0 / 3.0)))
    clock.time[1] = max(clock.time[1], proposal) if tried < clock.time[1] else proposal


def advance(
    a: Assembly,
    m: Model,
    bc: Boundary,
    control: Control,
    state: State,
    clock: Clock,
    until: float,
    max_steps: int,
    g: Stages,
) -> int:
    """Advance state (in place) to the time until [s] in at most max_steps steps; returns why it stopped.

    REACHED, PAUSED (max_steps taken), SLIPPED (a pulled body that nothing holds any more), CROSSING
    (strands would pass through each other), STUCK (no step is short enough), UNSOLVABLE.
    """
    edge_geometry(state.x, a.edges, g.length, g.tangent)
    if until <= clock.time[0]:
        return REACHED
    near = _list_near(a, m, control, state, g, clock)
    begin = True
    supplied = 0.0
    lost = 0.0
    for _ in range(max_steps):
        if begin:
            status = evaluate(START, a, m, bc, state, near, control, 0.0, ONE_STAGE, g)
            clock.count[2] += 1
            if status != OK:
                return SLIPPED if status == LOOSE else UNSOLVABLE
            _take_rates(state, g)
            supplied, lost = powers(a, m, bc, g.v, g.omega, near.contacts, g.work)
        if until - clock.time[0] <= 1e-12 * until:
            clock.time[0] = until
            return REACHED
        if control.fixed_step == 0.0 and (clock.count[4] >= STEPS_PER_SPECTRUM or clock.time[4] == 0.0):
            evaluate(SPECTRUM, a, m, bc, state, near, control, 0.0, ONE_STAGE, g)
            _take_spectrum(g, clock)
        growth = 2.0
        while True:
            tried, last = _next_step(control, clock, until)
            dt, ratio, verdict = _try_step(a, m, bc, state, near, control, tried, g, clock)
            if verdict == REACHED:
                break
            clock.count[1] += 1
            growth = 1.0
            if control.fixed_step > 0.0 or dt < 1e-13 * until:
                return verdict
            clock.time[1] = dt * max(0.1, 0.8 * ratio ** (-1.0 / 3.0))
        clock.time[0] = until if last and dt == tried else clock.time[0] + dt
        clock.count[0] += 1
        clock.count[4] += 1
        if control.fixed_step == 0.0:
            _adapt(tried, dt, ratio, growth, clock)
        supplied_before = supplied
        lost_before = lost
        supplied, lost = powers(a, m, bc, g.v, g.omega, near.contacts, g.work)
        clock.time[2] += 0.5 * dt * (supplied_before + supplied)
        clock.time[3] += 0.5 * dt * (lost_before + lost)
        _commit(a, state, g)
        moved = largest_move(g.listed, state.x)
        begin = moved > 0.5 * control.skin  # a fixed step that outran the list: find contacts again
        if moved > 0.25 * control.skin:
            near = _list_near(a, m, control, state, g, clock)
    return PAUSED


compile_kernels(__name__)

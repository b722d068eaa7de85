"""The loop that advances overdamped fibers in time, compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index, Ints
from torsade.assembly import Assembly, State
from torsade.motion.ends import Boundary
from torsade.motion.guard import largest_move
from torsade.motion.near import Near, crossing, find_near, list_near
from torsade.motion.piercing import pierced
from torsade.motion.rates import DENSE, LOOSE, OK, STALE
from torsade.motion.scheme import (
    ANEW,
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
from torsade.rod.factor import Factor, renewed, usable
from torsade.rod.kinematics import carry_directors, edge_geometry, spread_directors
from torsade.rod.neighbours import edge_midpoints

REACHED = 0
SLIPPED = 1
CROSSING = 2
STUCK = 3
UNSOLVABLE = 4
PAUSED = 5
CROWDED = 6

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


def _commit(a: Assembly, state: State, g: Stages, now: float, clock: Clock) -> None:
    """Accept g.x, g.theta at the time now [s]: carry directors and reference twist along."""
    clock.time[0] = now
    clock.time[2] += g.ledger[0, 0]
    clock.time[3] += g.ledger[0, 1]
    clock.count[0] += 1
    clock.count[4] += 1
    carry_directors(a.edge_start, state.director, g.tangent, g.work.tangent)
    copy_flat(g.work.change, state.reference_twist)
    copy(g.work.tangent.T, g.tangent.T)
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
    for c in range(2):
        g.ledger[4, c] = g.ledger[3, c]


def _find_near(a: Assembly, m: Model, control: Control, state: State, g: Stages, clock: Clock) -> Near:
    """Look for pairs around the present positions."""
    copy(state.x, g.searched)
    copy(state.x, g.listed)
    clock.count[3] += 1
    return find_near(a, m, control, g.mid, g.length)


def _take_spectrum(g: Stages, clock: Clock) -> None:
    """Note the spectral radius just estimated, and choose a first step from it."""
    clock.time[4] = max(1.1 * g.estimate[0], 1e-300)
    clock.count[4] = 0
    if clock.time[1] <= 0.0:
        clock.time[1] = 1.0 / clock.time[4]


def _next_job(control: Control, clock: Clock, begin: bool, again: bool) -> Index:
    """What to evaluate: the rates to begin with, now and then the spectral radius, else a step."""
    if begin:
        return START
    if control.fixed_step > 0.0 or again:
        return STEP
    return SPECTRUM if clock.count[4] >= STEPS_PER_SPECTRUM or clock.time[4] == 0.0 else STEP


def _next_step(control: Control, clock: Clock, until: float) -> tuple[float, bool]:
    """The step to try [s], and whether it ends at the time until."""
    remaining = until - clock.time[0]
    dt = control.fixed_step if control.fixed_step > 0.0 else clock.time[1]
    if dt >= remaining * (1.0 - 1e-9):
        return remaining, True
    if control.fixed_step == 0.0 and dt > 0.5 * remaining:
        return 0.5 * remaining, False
    return dt, False


def _verdict(status: int) -> int:
    """What a status of the rates other than OK means for the run."""
    if status == LOOSE:
        return SLIPPED
    return CROWDED if status == DENSE else UNSOLVABLE


def _judge(
    a: Assembly,
    bc: Boundary,
    state: State,
    near: Near,
    control: Control,
    status: int,
    dt: float,
    g: Stages,
    clock: Clock,
) -> tuple[float, int]:
    """Error over the tolerance of the step dt [s] in g, and a verdict.

    A verdict of REACHED accepts the step, any other refuses it.
    """
    ratio = 0.0
    if status != OK:
        return 8.0, _verdict(status)
    if control.fixed_step == 0.0:
        ratio = embedded_error(state, g, dt, control.radius) / control.tolerance
    if not ratio <= 1.0:
        return ratio, STUCK
    move = largest_move(state.x, g.x)
    if not move < 1e300:
        return 8.0, UNSOLVABLE
    clock.culprit[0], clock.culprit[1] = crossing(a, control, near, state.x, g.x, g.length, g.mid, move)
    if clock.culprit[0] < 0:
        clock.culprit[0], clock.culprit[1] = pierced(a, bc.skin, state.x, g.x)
    if clock.culprit[0] >= 0:
        return 8.0, CROSSING
    if control.fixed_step == 0.0 and move > control.move:
        return min(8.0, (1.25 * move / control.move) ** 3), STUCK
    return ratio, REACHED


def _evaluate(
    job: Index,
    a: Assembly,
    m: Model,
    bc: Boundary,
    state: State,
    near: Near,
    factor: Factor | tuple[()],
    control: Control,
    dt: float,
    stages: Index,
    g: Stages,
) -> tuple[int, Factor | tuple[()]]:
    """Do a job, with a new factor whenever the old one will not do; its status, and the factor."""
    status: int = STALE
    resumed: bool | np.bool_ = ANEW
    while status == STALE:
        status = evaluate(job, resumed, a, m, bc, state, near.contacts, factor, control, dt, stages, g)
        resumed = status == STALE
        if resumed:
            factor = renewed(factor, a, near.contacts, g.work.mid, m.diameter)
            status = STALE if usable(factor) else DENSE
    return status, factor


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
    factor: Factor | tuple[()],
) -> int:
    """Advance state (in place) to the time until [s] in at most max_steps steps; returns why it stopped.

    REACHED, PAUSED (max_steps taken), SLIPPED (a pulled body that nothing holds any more), CROSSING
    (strands would pass through each other), STUCK (no step is short enough), UNSOLVABLE, CROWDED (contacts
    couple so much that solving without a factor is faster). The factor is one not made yet, or ().
    """
    edge_geometry(a, state.x, g.length, g.tangent)
    edge_midpoints(state.x, a.edges, g.mid)
    if until <= clock.time[0]:
        return REACHED
    near = _find_near(a, m, control, state, g, clock)
    unmade = factor
    adaptive = control.fixed_step == 0.0
    begin, again = True, False
    verdict = PAUSED
    left = max_steps
    stages: Index = ONE_STAGE
    tried, dt, last = 0.0, 0.0, False
    while verdict == PAUSED:
        job = _next_job(control, clock, begin, again)
        if job != START and until - clock.time[0] <= 1e-12 * until:
            clock.time[0] = until
            verdict = REACHED
            break
        if job != START and left == 0:
            break
        if job == STEP:
            tried, last = _next_step(control, clock, until)
            stages, dt = stages_for(tried, clock.time[4]) if adaptive else (ONE_STAGE, tried)
        status, factor = _evaluate(job, a, m, bc, state, near, factor, control, dt, stages, g)
        clock.count[2] += int(g.estimate[1])
        if status == DENSE or (job == START and status != OK):
            verdict = _verdict(status)
            break
        if job == START:
            _take_rates(state, g)
            begin = False
            continue
        if job == SPECTRUM:
            _take_spectrum(g, clock)
            continue
        ratio, judged = _judge(a, bc, state, near, control, status, dt, g, clock)
        if judged != REACHED:
            clock.count[1] += 1
            clock.time[1] = dt * max(0.1, 0.8 * ratio ** (-1.0 / 3.0))
            again = True
            if not adaptive or not dt > 1e-13 * (clock.time[0] + dt):
                verdict = judged
            continue
        if adaptive:
            _adapt(tried, dt, ratio, 1.0 if again else 2.0, clock)
        _commit(a, state, g, until if last and dt == tried else clock.time[0] + dt, clock)
        left -= 1
        again = False
        moved = largest_move(g.listed, state.x)
        begin = moved > 0.5 * control.skin  # a fixed step that outran the list: find contacts again
        if largest_move(g.searched, state.x) > control.roam:
            near = _find_near(a, m, control, state, g, clock)
            factor = unmade
        elif moved > 0.25 * control.skin:
            copy(state.x, g.listed)
            list_near(m, control, g.mid, g.length, near)
    spread_directors(a.hinges, g.tangent, state.reference_twist, state.director)
    return verdict


compile_kernels(
    __name__,
    splice=("_judge", "_find_near", "_evaluate"),
    owning=("_judge", "_find_near", "_evaluate", "advance"),
)

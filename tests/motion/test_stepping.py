"""Order of the integrators, measured by regression, and what the error control promises."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest

from rod.helpers import toy_model
from torsade.assembly import assemble, initial_state
from torsade.errors import TorsadeError
from torsade.motion import ends, scheme, stepping
from torsade.motion.overdamped import Motion, Outcome, Stepping
from torsade.motion.rates import OK, STALE
from torsade.rod.contact import contacts_among
from torsade.rod.factor import no_factor, pattern

TAU = 0.01  # eta/E of the toy material [s]


def smooth_motion(how):
    """A bent, stretched, twisted open fiber, one end clamped and one moved and turned; no contact."""
    s = np.linspace(0, 1, 13)
    x = np.stack([s, 0.2 * np.sin(3 * s), 0.15 * np.cos(4 * s)], axis=1)
    a = assemble([x])
    rest = a.rest_length * (1 + 0.1 * np.sin(5 * s[1:]))
    a = assemble([x], [False], [rest])
    state = initial_state(a, [x])
    state.theta[:] = 2 * np.sin(3 * s[1:])
    bc = ends.clamp(ends.free(a), a, 0, 0, tangent=True)
    bc = ends.move(bc, a, 0, 1, np.array([-5.0, 3.0, 2.0]), spin=20.0)
    return Motion(a, toy_model(0.03, exclusion_length=1e9), bc, state, how)


def after(how, until, dt=None):
    """State vector at a time; with dt, in Chebyshev steps of exactly that length."""
    motion = smooth_motion(how)
    if dt is None:
        assert motion.advance(until) is Outcome.REACHED
    else:
        checkpoint = motion.checkpoint()
        checkpoint.time[1] = dt  # the step to try next
        motion.restore(checkpoint)
        n = round(until / dt)
        for k in range(1, n + 1):
            motion.advance(until * k / n)
        assert motion.steps == n
        assert motion.counts["refused"] == 0
    s = motion.state
    return np.concatenate([s.x.ravel(), 0.03 * (s.theta - s.theta[0])]), motion


FORCED = Stepping(tolerance=1e9, move=1e9, skin=1e3, solver_tolerance=1e-13)


@pytest.fixture(scope="module")
def exact():
    """The answer at two relaxation times, by 4096 small steps."""
    return after(FORCED, 2 * TAU, 2 * TAU / 4096)[0]


def order(steps, errors):
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


def test_fixed_steps_are_of_first_order(exact):
    """Explicit Euler: halving the step halves the error; slope 1 within 0.05."""
    steps = np.array([100, 200, 400, 800])
    errors = [
        np.abs(after(Stepping(fixed_step=2 * TAU / n, solver_tolerance=1e-13), 2 * TAU)[0] - exact).max()
        for n in steps
    ]
    assert order(steps, errors) == pytest.approx(1.0, abs=0.05)


def test_chebyshev_steps_are_of_second_order(exact):
    """Runge-Kutta-Chebyshev (Sommeijer, Shampine, Verwer 1998): slope 2 within 0.1.

    Frames are carried over every stage, so a wrong rate of the material angle, a wrong reference twist
    within a step or a wrong stage weight shows as slope 1.
    """
    steps = np.array([16, 32, 64, 128])
    errors = [np.abs(after(FORCED, 2 * TAU, 2 * TAU / n)[0] - exact).max() for n in steps]
    assert order(steps, errors) == pytest.approx(2.0, abs=0.1)


def test_order_holds_where_many_stages_are_taken():
    """Steps of up to ten relaxation times, late in the motion, keep slope 2 within 0.25."""
    start, until = 20 * TAU, 80 * TAU

    def late(n):
        motion = smooth_motion(Stepping(tolerance=1e-6, move=1e9, skin=1e3, solver_tolerance=1e-13))
        motion.boundary = ends.clamp(ends.free(motion.assembly), motion.assembly, 0, 0, tangent=True)
        motion.advance(start)
        forced = Motion(motion.assembly, motion.model, motion.boundary, motion.state, FORCED)
        checkpoint = forced.checkpoint()
        checkpoint.time[1] = (until - start) / n
        forced.restore(checkpoint)
        for k in range(1, n + 1):
            forced.advance((until - start) * k / n)
        assert forced.steps == n
        return forced.state.x.copy()

    exact = late(1024)
    steps = np.array([8, 16, 32])
    errors = [np.abs(late(n) - exact).max() for n in steps]
    assert order(steps, errors) == pytest.approx(2.0, abs=0.25)


def test_error_falls_with_the_tolerance(exact):
    """Local error of third order: global error proportional to tolerance^(2/3), slope within 0.05."""
    tolerances = np.array([1e-4, 1e-5, 1e-6, 1e-7])
    errors, steps = [], []
    for tolerance in tolerances:
        how = Stepping(tolerance=tolerance, move=1e9, skin=1e3, solver_tolerance=1e-13)
        x, motion = after(how, 2 * TAU)
        errors.append(np.abs(x - exact).max())
        steps.append(motion.steps)
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(2 / 3, abs=0.05)
    assert errors[0] < 10 * 1e-4 * 0.03
    assert steps[-1] > 5 * steps[0]


def test_the_move_limit_binds():
    """No node goes farther than `move` radii in one error-controlled step."""
    motion = smooth_motion(Stepping(tolerance=1e3, move=0.05))
    while motion.time < TAU:
        before = motion.state.x.copy()
        motion.advance(TAU, max_steps=1)
        moved = np.linalg.norm(motion.state.x - before, axis=1).max()
        assert moved <= 0.05 * 0.03 * (1 + 1e-12)


def test_times_are_reached_exactly():
    """advance(t) ends at t itself, in whatever pieces, and a time already passed takes no step."""
    motion = smooth_motion(Stepping())
    for t in (1e-7, 0.1 * TAU, np.pi * TAU):
        assert motion.advance(t) is Outcome.REACHED
        assert motion.time == t
    steps = motion.steps
    assert motion.advance(np.pi * TAU) is Outcome.REACHED
    assert motion.steps == steps


def test_fixed_steps_are_counted():
    """Frames that are multiples of the fixed step cost exactly as many steps as they hold."""
    motion = smooth_motion(Stepping(fixed_step=1e-4))
    for k in range(1, 21):
        motion.advance(k * 1e-3)
    assert motion.steps == 200


def test_time_does_not_go_back():
    """A time already passed is refused or takes no step; it never rewinds the clock."""
    motion = smooth_motion(Stepping())
    motion.advance(TAU)
    before = motion.state.copy()
    with contextlib.suppress(TorsadeError):
        motion.advance(0.5 * TAU)
    assert motion.time == TAU
    assert np.array_equal(motion.state.x, before.x)


@pytest.mark.slow
def test_an_iterative_solve_gives_the_same_motion():
    """Without a factor the system is solved by conjugate gradients; a tight tolerance shows no difference."""
    ends_at = []
    for factor in (no_factor(), ()):
        motion = smooth_motion(Stepping(solver_tolerance=1e-12))
        clock, scratch = motion._clock, motion._scratch
        stepping.advance(
            motion.assembly, motion.model, motion.boundary, motion.control, motion.state, clock, TAU, 10**6,
            scratch, factor,
        )  # fmt: skip
        ends_at.append(motion.state.x.copy())
    assert np.abs(ends_at[1] - ends_at[0]).max() < 1e-8


@pytest.mark.parametrize("job", [scheme.STEP, scheme.SPECTRUM])
def test_a_job_that_waited_for_a_pattern_goes_on_as_if_it_had_been_there(job):
    """Stopped before its first stage and resumed, or never stopped: the same rates to the bit."""
    motion = smooth_motion(None)
    motion.advance(1e-3)
    a, m, bc, state, control = motion.assembly, motion.model, motion.boundary, motion.state, motion.control
    contacts = contacts_among(np.empty((0, 2), np.int64))
    made = pattern(a, contacts, motion._scratch.mid, m.diameter, np.inf)
    found = []
    for stops in (False, True):
        g = scheme.stage_work(a)
        for name in ("tangent", "v0", "angular0", "ledger"):
            getattr(g, name)[:] = getattr(motion._scratch, name)

        def evaluate(resumed, factor, g=g):
            stages = np.int64(5)
            return scheme.evaluate(job, resumed, a, m, bc, state, contacts, factor, control, 1e-4, stages, g)

        if stops:
            assert evaluate(False, no_factor()) == STALE
        assert evaluate(stops, made) == OK
        found.append((g.x.copy(), g.v.copy(), g.angular.copy(), g.ledger.copy(), g.estimate.copy()))
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other)

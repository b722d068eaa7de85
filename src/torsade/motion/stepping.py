"""Explicit time stepping of overdamped fibers, compiled.

The default is the stabilised Runge-Kutta-Chebyshev method of second order with its embedded error
estimate (Sommeijer, Shampine and Verwer 1998): s stages are stable up to a step of about 0.65 s^2
over the spectral radius, so steps are as long as accuracy allows. The fixed step is explicit Euler.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade._compile import compile_kernels
from torsade.motion.guard import first_crossing, largest_move
from torsade.motion.rates import LOOSE, OK, Work, powers, rate_work, rates
from torsade.rod.contact import contacts_among
from torsade.rod.kinematics import edge_geometry, reference_twist, transport_directors
from torsade.rod.neighbours import edge_midpoints, neighbour_pairs

REACHED = 0
SLIPPED = 1
CROSSING = 2
STUCK = 3
UNSOLVABLE = 4
PAUSED = 5

MAX_STAGES = 40
STEPS_PER_SPECTRUM = 25


class Control(NamedTuple):
    """How to step: fixed step [s] (0: error-controlled), tolerance [m] and [rad h], solver tolerance.

    tolerance is the local error allowed per step in any node position, and, divided by the radius,
    in any material angle. skin [m] is the reach of the Verlet list beyond the diameter, move [m] the
    farthest any node may go in one step.
    """

    fixed_step: float
    tolerance: float
    radius: float
    solver_tolerance: float
    skin: float
    move: float


class Clock(NamedTuple):
    """What a run carries from step to step, in arrays so that kernels can write them.

    time (4,): t [s], next step [s], external work [J], dissipation [J].
    count (5,): steps, refused steps, evaluations of the rates, Verlet lists made, solver iterations.
    culprit (2,): the edges that stopped the run.
    """

    time: NDArray[np.float64]
    count: NDArray[np.int64]
    culprit: NDArray[np.int64]


class Stages(NamedTuple):
    """Rates at the start and the end of a step, and two running stages."""

    x: NDArray[np.float64]
    theta: NDArray[np.float64]
    x1: NDArray[np.float64]
    theta1: NDArray[np.float64]
    x2: NDArray[np.float64]
    theta2: NDArray[np.float64]
    v0: NDArray[np.float64]
    angular0: NDArray[np.float64]
    v: NDArray[np.float64]
    angular: NDArray[np.float64]
    omega: NDArray[np.float64]
    tangent: NDArray[np.float64]
    tangent1: NDArray[np.float64]
    length: NDArray[np.float64]
    mid: NDArray[np.float64]
    listed: NDArray[np.float64]
    mode_x: NDArray[np.float64]
    mode_theta: NDArray[np.float64]
    work: Work


def stage_work(a):
    """Scratch of a run."""
    n = a.node_length.shape[0]
    n_edges = a.edges.shape[0]
    return Stages(
        np.empty((n, 3)),
        np.empty(n_edges),
        np.empty((n, 3)),
        np.empty(n_edges),
        np.empty((n, 3)),
        np.empty(n_edges),
        np.empty((n, 3)),
        np.empty(n_edges),
        np.empty((n, 3)),
        np.empty(n_edges),
        np.empty(n_edges),
        np.empty((n_edges, 3)),
        np.empty((n_edges, 3)),
        np.empty(n_edges),
        np.empty((n_edges, 3)),
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty(n_edges),
        rate_work(a),
    )


def _evaluate(a, m, bc, state, contacts, control, x, theta, g):
    """Rates at (x, theta) into g.v, g.angular, g.omega; g.v holds the guess."""
    return rates(
        a, m, bc, x, theta, g.tangent, state.reference_twist, contacts, control.solver_tolerance,
        g.v, g.omega, g.angular, g.work,
    )  # fmt: skip


def _combine(out, p, q, r, cp, cq, cr, d, cd, f, cf):
    """out = cp p + cq q + cr r + cd d + cf f, elementwise on flat arrays."""
    for i in range(out.shape[0]):
        out[i] = cp * p[i] + cq * q[i] + cr * r[i] + cd * d[i] + cf * f[i]


def _spectral_radius(a, m, bc, state, contacts, control, g, rough):
    """Estimate the spectral radius [1/s] of the rates at the start of a step by power iteration.

    g.mode_x, g.mode_theta hold the latest direction; rough asks for the first estimate of a run.
    """
    n = g.mode_theta.shape[0]
    scale = 1e-4 * control.radius
    estimate = 0.0
    for iteration in range(30 if rough else 8):
        norm = 0.0
        for i in range(g.mode_x.shape[0]):
            for c in range(3):
                norm += g.mode_x[i, c] ** 2
        for e in range(n):
            norm += (g.mode_theta[e] * control.radius) ** 2
        factor = scale * math.sqrt(g.mode_x.shape[0]) / math.sqrt(norm)
        for i in range(g.mode_x.shape[0]):
            for c in range(3):
                g.x1[i, c] = state.x[i, c] + factor * g.mode_x[i, c]
        for e in range(n):
            g.theta1[e] = state.theta[e] + factor * g.mode_theta[e]
        g.v[:] = g.v0
        if _evaluate(a, m, bc, state, contacts, control, g.x1, g.theta1, g) != OK:
            break
        change = 0.0
        for i in range(g.mode_x.shape[0]):
            for c in range(3):
                g.mode_x[i, c] = g.v[i, c] - g.v0[i, c]
                change += g.mode_x[i, c] ** 2
        for e in range(n):
            g.mode_theta[e] = g.angular[e] - g.angular0[e]
            change += (g.mode_theta[e] * control.radius) ** 2
        previous = estimate
        estimate = math.sqrt(change / norm) / factor
        if iteration > 1 and abs(estimate - previous) < 0.02 * estimate:
            break
    return estimate


def _seed_mode(g, radius):
    """A rough direction that holds every mode; the same for every run."""
    seed = np.uint64(88172645463325252)
    for i in range(g.mode_x.shape[0]):
        for c in range(3):
            seed ^= seed << np.uint64(13)
            seed ^= seed >> np.uint64(7)
            seed ^= seed << np.uint64(17)
            g.mode_x[i, c] = (float(seed >> np.uint64(11)) / 9007199254740992.0 - 0.5) * radius
    for e in range(g.mode_theta.shape[0]):
        g.mode_theta[e] = 0.5 if e % 2 == 0 else -0.5


def _chebyshev_step(a, m, bc, state, contacts, control, dt, stages, g):
    """One step of the second-order Runge-Kutta-Chebyshev method into g.x, g.theta.

    Starts from state with rates g.v0, g.angular0. Returns a status of the rates.
    """
    w0 = 1.0 + 2.0 / (13.0 * stages * stages)
    t1 = w0
    t0 = 1.0
    d1 = 1.0
    d0 = 0.0
    e1 = 0.0
    e0 = 0.0
    for _ in range(2, stages + 1):
        t1, t0 = 2.0 * w0 * t1 - t0, t1
        d1, d0 = 2.0 * w0 * d1 - d0 + 2.0 * t0, d1
        e1, e0 = 2.0 * w0 * e1 - e0 + 4.0 * d0, e1
    w1 = d1 / e1
    b2 = 1.0 / (4.0 * w0 * w0)
    b_1 = b2
    b_2 = b2
    x0 = state.x.ravel()
    v0 = g.v0.ravel()
    g.x2[:] = state.x
    g.theta2[:] = state.theta
    _combine(g.x1.ravel(), x0, x0, x0, 1.0, 0.0, 0.0, v0, b2 * w1 * dt, v0, 0.0)
    angular0 = g.angular0
    theta0 = state.theta
    _combine(g.theta1, theta0, theta0, theta0, 1.0, 0.0, 0.0, angular0, b2 * w1 * dt, angular0, 0.0)
    t_1, t_2 = w0, 1.0
    d_1, d_2 = 1.0, 0.0
    e_1, e_2 = 0.0, 0.0
    a_1 = 1.0 - b2 * w0
    for j in range(2, stages + 1):
        t = 2.0 * w0 * t_1 - t_2
        d = 2.0 * w0 * d_1 - d_2 + 2.0 * t_1
        e = 2.0 * w0 * e_1 - e_2 + 4.0 * d_1
        b = e / (d * d)
        mu = 2.0 * b * w0 / b_1
        nu = -b / b_2
        step = 2.0 * b * w1 / b_1 * dt
        back = -a_1 * step
        if j == 2:
            g.v[:] = g.v0
        status = _evaluate(a, m, bc, state, contacts, control, g.x1, g.theta1, g)
        if status != OK:
            return status
        _combine(
            g.x.ravel(), x0, g.x1.ravel(), g.x2.ravel(), 1.0 - mu - nu, mu, nu, g.v.ravel(), step, v0, back
        )
        _combine(g.theta, theta0, g.theta1, g.theta2, 1.0 - mu - nu, mu, nu, g.angular, step, angular0, back)
        g.x2[:] = g.x1
        g.theta2[:] = g.theta1
        g.x1[:] = g.x
        g.theta1[:] = g.theta
        b_2 = b_1
        b_1 = b
        a_1 = 1.0 - b * t
        t_2, t_1 = t_1, t
        d_2, d_1 = d_1, d
        e_2, e_1 = e_1, e
    return _evaluate(a, m, bc, state, contacts, control, g.x, g.theta, g)


def _euler_step(a, m, bc, state, contacts, control, dt, g):
    """One explicit Euler step into g.x, g.theta, and the rates there."""
    x0 = state.x.ravel()
    v0 = g.v0.ravel()
    _combine(g.x.ravel(), x0, x0, x0, 1.0, 0.0, 0.0, v0, dt, v0, 0.0)
    theta0 = state.theta
    _combine(g.theta, theta0, theta0, theta0, 1.0, 0.0, 0.0, g.angular0, dt, g.angular0, 0.0)
    g.v[:] = g.v0
    return _evaluate(a, m, bc, state, contacts, control, g.x, g.theta, g)


def _error(state, g, dt, radius):
    """Largest embedded error estimate of positions and of material angles times radius [m]."""
    largest = 0.0
    for i in range(g.x.shape[0]):
        total = 0.0
        for c in range(3):
            estimate = 0.8 * (state.x[i, c] - g.x[i, c]) + 0.4 * dt * (g.v0[i, c] + g.v[i, c])
            total += estimate * estimate
        largest = max(largest, total)
        if not total < 1e300:
            return math.inf
    largest = math.sqrt(largest)
    for e in range(g.theta.shape[0]):
        estimate = 0.8 * (state.theta[e] - g.theta[e]) + 0.4 * dt * (g.angular0[e] + g.angular[e])
        largest = max(largest, abs(estimate) * radius)
        if not abs(estimate) < 1e300:
            return math.inf
    return largest


def _commit(a, state, g):
    """Accept g.x, g.theta: carry the directors along and unwrap the reference twist."""
    g.tangent1[:] = g.work.tangent
    transport_directors(state.director, g.tangent, g.tangent1)
    state.reference_twist[:] = g.work.change
    reference_twist(state.director, g.tangent1, a.hinges, state.reference_twist)
    g.tangent[:] = g.tangent1
    g.length[:] = g.work.length
    g.mid[:] = g.work.mid
    state.x[:] = g.x
    state.theta[:] = g.theta
    state.v[:] = g.v
    state.omega[:] = g.omega
    g.v0[:] = g.v
    g.angular0[:] = g.omega


def _list_contacts(a, m, control, state, g, clock):
    """A new Verlet list around the present positions."""
    g.listed[:] = state.x
    edge_midpoints(state.x, a.edges, g.mid)
    clock.count[3] += 1
    cutoff = m.diameter + control.skin
    return contacts_among(neighbour_pairs(a, g.mid, cutoff, m.exclusion_edges, m.exclusion_length))


def advance(a, m, bc, control, state, clock, until, max_steps, g):
    """Advance state (in place) to the time until [s] in at most max_steps steps; returns why it stopped.

    REACHED, PAUSED (max_steps taken), SLIPPED (a pulled body that nothing holds any more), CROSSING
    (strands would pass through each other), STUCK (no step is short enough), UNSOLVABLE.
    """
    edge_geometry(state.x, a.edges, g.length, g.tangent)
    contacts = _list_contacts(a, m, control, state, g, clock)
    g.v[:] = state.v
    status = _evaluate(a, m, bc, state, contacts, control, state.x, state.theta, g)
    clock.count[2] += 1
    if status != OK:
        return SLIPPED if status == LOOSE else UNSOLVABLE
    g.v0[:] = g.v
    g.angular0[:] = g.angular
    state.v[:] = g.v
    state.omega[:] = g.omega
    supplied, lost = powers(a, m, bc, g.v, g.omega, contacts, g.work)
    _seed_mode(g, control.radius)
    spectrum = 0.0
    age = STEPS_PER_SPECTRUM
    shortest = 1e-13 * until
    for _ in range(max_steps):
        remaining = until - clock.time[0]
        if remaining <= 1e-12 * until:
            clock.time[0] = until
            return REACHED
        if control.fixed_step == 0.0 and age >= STEPS_PER_SPECTRUM:
            before = g.work.iterations[0]
            spectrum = 1.1 * _spectral_radius(a, m, bc, state, contacts, control, g, spectrum == 0.0)
            clock.count[2] += g.work.iterations[0] - before
            age = 0
            if clock.time[1] <= 0.0:
                clock.time[1] = 1.0 / max(spectrum, 1e-300)
        while True:
            dt = control.fixed_step if control.fixed_step > 0.0 else clock.time[1]
            cut = dt >= remaining * (1.0 - 1e-9)
            if cut:
                dt = remaining
            elif control.fixed_step == 0.0 and dt > 0.5 * remaining:
                dt = 0.5 * remaining
            if control.fixed_step > 0.0:
                status = _euler_step(a, m, bc, state, contacts, control, dt, g)
                clock.count[2] += 1
                ratio = 0.0
            else:
                stages = 1 + math.ceil(math.sqrt(1.0 + 1.54 * dt * spectrum))
                if stages > MAX_STAGES:
                    stages = MAX_STAGES
                    dt = (stages * stages - 2.0 * stages) / (1.54 * spectrum)
                    cut = False
                stages = max(2, stages)
                status = _chebyshev_step(a, m, bc, state, contacts, control, dt, stages, g)
                clock.count[2] += stages
                ratio = _error(state, g, dt, control.radius) / control.tolerance if status == OK else 8.0
            risk = -1
            pairs = contacts.pairs
            if status == OK and ratio <= 1.0:
                move = largest_move(state.x, g.x)
                if move > control.move:
                    cutoff = m.diameter + control.skin + 2.0 * move
                    pairs = neighbour_pairs(a, g.mid, cutoff, m.exclusion_edges, m.exclusion_length)
                risk = first_crossing(a, pairs, state.x, g.x, g.length, g.mid)
                if risk < 0 and (move <= control.move or control.fixed_step > 0.0):
                    break
                ratio = 8.0
            clock.count[1] += 1
            if control.fixed_step > 0.0 or dt < shortest:
                if risk >= 0:
                    clock.culprit[0] = pairs[risk, 0]
                    clock.culprit[1] = pairs[risk, 1]
                    return CROSSING
                if status == LOOSE:
                    return SLIPPED
                return STUCK if status == OK else UNSOLVABLE
            clock.time[1] = dt * max(0.1, 0.8 * ratio ** (-1.0 / 3.0))
            age += 1
        clock.time[0] = until if cut else clock.time[0] + dt
        clock.count[0] += 1
        age += 1
        if control.fixed_step == 0.0:
            growth = min(4.0, 0.8 * max(ratio, 1e-12) ** (-1.0 / 3.0))
            proposal = dt * max(0.2, growth)
            clock.time[1] = max(clock.time[1], proposal) if dt < clock.time[1] else proposal
        old_supplied = supplied
        old_lost = lost
        supplied, lost = powers(a, m, bc, g.v, g.omega, contacts, g.work)
        clock.time[2] += 0.5 * dt * (old_supplied + supplied)
        clock.time[3] += 0.5 * dt * (old_lost + lost)
        _commit(a, state, g)
        if largest_move(g.listed, state.x) > 0.25 * control.skin:
            contacts = _list_contacts(a, m, control, state, g, clock)
    return PAUSED


compile_kernels(__name__)

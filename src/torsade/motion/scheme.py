"""Explicit schemes for overdamped fibers: stabilised second order with error estimate, and Euler.

The Runge-Kutta-Chebyshev method (Sommeijer, Shampine and Verwer 1998) takes s stages that are stable up
to a step of about 0.65 s^2 over the spectral radius, so steps are as long as accuracy allows. Every
evaluation of the rates passes through one place, `evaluate`, which keeps compilation short.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index, columns
from torsade.assembly import Assembly, State
from torsade.motion.ends import Boundary
from torsade.motion.rates import OK, Work, powers, rate_work, rates
from torsade.rod.contact import Contacts, Model
from torsade.rod.factor import Factor

MAX_STAGES = 200
"""Of one step: so many go 65 times as far as so many Euler steps. Round-off grows as
their square, to 1e-11."""

START = np.int64(0)
SPECTRUM = np.int64(1)
STEP = np.int64(2)
ONE_STAGE = np.int64(1)
ANEW = np.bool_(False)
"""Not literals: a kernel would be compiled again for every literal that it is called with."""


class Control(NamedTuple):
    """How to step: fixed step [s] (0: error-controlled), tolerance [m] and [rad h], solver tolerance.

    tolerance is the local error allowed per step in any node position, and, divided by the radius,
    in any material angle. skin [m] is how far beyond the diameter pairs are listed as contacts to come,
    roam [m] how far nodes may go until pairs are looked for anew, move [m] the farthest any node may go
    in one step.
    """

    fixed_step: float
    tolerance: float
    radius: float
    solver_tolerance: float
    skin: float
    roam: float
    move: float


class Stages(NamedTuple):
    """Scratch of a run: the newest stage (x, theta) and two before it, with rates v, angular, omega.

    v0, angular0 are the rates at the start of the step; table (MAX_STAGES + 1, 5) holds the weights of
    a step's stages; ledger (5, 2) external work and dissipation [J] since the start of the step, of the
    newest stage and two before it, and their powers [W] at the newest stage and at the start; tangent,
    length, mid belong to the last completed step; searched and listed (n_nodes, 3) are positions when
    pairs were last looked for and last listed; estimate[0] the spectral radius [1/s], estimate[1] the
    number of evaluations it took.
    """

    x: Floats
    theta: Floats
    x1: Floats
    theta1: Floats
    x2: Floats
    theta2: Floats
    v0: Floats
    angular0: Floats
    v: Floats
    angular: Floats
    omega: Floats
    tangent: Floats
    length: Floats
    mid: Floats
    searched: Floats
    listed: Floats
    table: Floats
    ledger: Floats
    estimate: Floats
    work: Work


def stage_work(a: Assembly) -> Stages:
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
        columns(n_edges),
        np.empty(n_edges),
        np.empty((n_edges, 3)),
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty((MAX_STAGES + 1, 5)),
        np.zeros((5, 2)),
        np.zeros(2),
        rate_work(a),
    )


def flat(x: Floats) -> Floats:
    """All numbers of an array (n, 3) in a row, not copied."""
    return x.reshape(x.size)


def copy(source: Floats, out: Floats) -> None:
    """out = source, arrays (n, 3)."""
    copy_flat(flat(source), flat(out))


def copy_flat(source: Floats, out: Floats) -> None:
    """out = source, arrays (n,)."""
    for i in range(out.shape[0]):
        out[i] = source[i]


def stages_for(dt: float, spectrum: float) -> tuple[int, float]:
    """Stages that a step dt [s] needs to be stable, and the step, shortened when that is too many."""
    stages = 1 + math.ceil(math.sqrt(1.0 + 1.54 * dt * spectrum))
    if stages > MAX_STAGES:
        return MAX_STAGES, (MAX_STAGES * MAX_STAGES - 2.0 * MAX_STAGES) / (1.54 * spectrum)
    return max(2, stages), dt


def _set_row(table: Floats, j: int, c0: float, c1: float, c2: float, cv: float, cv0: float) -> None:
    """Row j of a table (n, 5)."""
    table[j, 0] = c0
    table[j, 1] = c1
    table[j, 2] = c2
    table[j, 3] = cv
    table[j, 4] = cv0


def chebyshev_table(stages: Index, dt: float, table: Floats) -> None:
    """Weights of stage j in row j of table: of x_0, x_(j-1), x_(j-2), v_(j-1) and v_0.

    One stage is explicit Euler.
    """
    _set_row(table, 1, 1.0, 0.0, 0.0, dt, 0.0)
    if stages == 1:
        return
    w0 = 1.0 + 2.0 / (13.0 * stages * stages)
    t1, t0, d1, d0, e1, e0 = w0, 1.0, 1.0, 0.0, 0.0, 0.0
    for _ in range(2, stages + 1):
        t1, t0, d1, d0, e1, e0 = (
            2.0 * w0 * t1 - t0,
            t1,
            2.0 * w0 * d1 - d0 + 2.0 * t1,
            d1,
            2.0 * w0 * e1 - e0 + 4.0 * d1,
            e1,
        )
    w1 = d1 / e1
    b1 = b0 = 1.0 / (4.0 * w0 * w0)
    a1 = 1.0 - b1 * w0
    table[1, 3] = b1 * w1 * dt
    t1, t0, d1, d0, e1, e0 = w0, 1.0, 1.0, 0.0, 0.0, 0.0
    for j in range(2, stages + 1):
        t = 2.0 * w0 * t1 - t0
        d = 2.0 * w0 * d1 - d0 + 2.0 * t1
        e = 2.0 * w0 * e1 - e0 + 4.0 * d1
        b = e / (d * d)
        mu = 2.0 * b * w0 / b1
        nu = -b / b0
        step = 2.0 * b * w1 / b1 * dt
        _set_row(table, j, 1.0 - mu - nu, mu, nu, step, -a1 * step)
        b1, b0, a1 = b, b1, 1.0 - b * t
        t1, t0, d1, d0, e1, e0 = t, t1, d, d1, e, e1


def _next_stage(weights: Floats, state: State, g: Stages) -> None:
    """Make (g.x, g.theta) the next stage, and the one before it (g.x1, g.theta1)."""
    c0, c1, c2, cv, cv0 = weights[0], weights[1], weights[2], weights[3], weights[4]
    x0, x, x1, x2, v, v0 = flat(state.x), flat(g.x), flat(g.x1), flat(g.x2), flat(g.v), flat(g.v0)
    copy_flat(x1, x2)
    copy_flat(x, x1)
    for i in range(x.shape[0]):
        x[i] = c0 * x0[i] + c1 * x1[i] + c2 * x2[i] + cv * v[i] + cv0 * v0[i]
    p0, p, p1, p2, r, r0 = state.theta, g.theta, g.theta1, g.theta2, g.angular, g.angular0
    copy_flat(p1, p2)
    copy_flat(p, p1)
    for e in range(p.shape[0]):
        p[e] = c0 * p0[e] + c1 * p1[e] + c2 * p2[e] + cv * r[e] + cv0 * r0[e]


def _next_entry(weights: Floats, ledger: Floats) -> None:
    """External work and dissipation until the next stage, integrated as positions are."""
    c1, c2, cv, cv0 = weights[1], weights[2], weights[3], weights[4]
    for c in range(2):
        ledger[2, c] = ledger[1, c]
        ledger[1, c] = ledger[0, c]
        ledger[0, c] = c1 * ledger[1, c] + c2 * ledger[2, c] + cv * ledger[3, c] + cv0 * ledger[4, c]


def _seed_mode(mode_x: Floats, mode_theta: Floats) -> None:
    """A rough direction that holds every mode; the same for every run."""
    seed = np.uint64(88172645463325252)
    for i in range(mode_x.shape[0]):
        for c in range(3):
            seed ^= seed << np.uint64(13)
            seed ^= seed >> np.uint64(7)
            seed ^= seed << np.uint64(17)
            mode_x[i, c] = float(seed >> np.uint64(11)) / 9007199254740992.0 - 0.5
    for e in range(mode_theta.shape[0]):
        mode_theta[e] = 0.5 if e % 2 == 0 else -0.5


def _size(mode_x: Floats, mode_theta: Floats) -> float:
    """Euclidean norm of a mode: positions in radii, angles in radians."""
    total = 0.0
    for i in range(mode_x.shape[0]):
        for c in range(3):
            total += mode_x[i, c] ** 2
    for e in range(mode_theta.shape[0]):
        total += mode_theta[e] ** 2
    return math.sqrt(total)


def _perturb(state: State, radius: float, g: Stages) -> float:
    """Make (g.x, g.theta) the state displaced along the mode in g.x2, g.theta2; returns how far."""
    factor = 1e-4 * math.sqrt(g.x.shape[0]) / _size(g.x2, g.theta2)
    x0, x, mode_x = state.x, g.x, g.x2
    for i in range(x.shape[0]):
        for c in range(3):
            x[i, c] = x0[i, c] + factor * radius * mode_x[i, c]
    theta0, theta, mode_theta = state.theta, g.theta, g.theta2
    for e in range(theta.shape[0]):
        theta[e] = theta0[e] + factor * mode_theta[e]
    return factor


def _response(radius: float, factor: float, g: Stages) -> float:
    """Make the mode the change of the rates; returns its growth [1/s]."""
    mode_x, mode_theta = g.x2, g.theta2
    before = _size(mode_x, mode_theta)
    v, v0, angular, angular0 = g.v, g.v0, g.angular, g.angular0
    for i in range(mode_x.shape[0]):
        for c in range(3):
            mode_x[i, c] = (v[i, c] - v0[i, c]) / radius
    for e in range(mode_theta.shape[0]):
        mode_theta[e] = angular[e] - angular0[e]
    return _size(mode_x, mode_theta) / (before * factor)


def _prepare(job: Index, dt: float, stages: Index, state: State, g: Stages) -> None:
    """Set up the running stages of a job."""
    if job == START:
        copy(state.v, g.v)
    else:
        copy(g.v0, g.v)
        copy_flat(g.angular0, g.angular)
    copy(state.x, g.x)
    copy_flat(state.theta, g.theta)
    copy(state.x, g.x1)
    copy_flat(state.theta, g.theta1)
    if job == SPECTRUM:
        _seed_mode(g.x2, g.theta2)
        g.estimate[0] = 0.0
    if job == STEP:
        chebyshev_table(stages, dt, g.table)
        for c in range(2):
            g.ledger[0, c] = 0.0
            g.ledger[1, c] = 0.0
            g.ledger[3, c] = g.ledger[4, c]


def evaluate(
    job: Index,
    resumed: bool | np.bool_,
    a: Assembly,
    m: Model,
    bc: Boundary,
    state: State,
    contacts: Contacts,
    factor: Factor | tuple[()],
    control: Control,
    dt: float,
    stages: Index,
    g: Stages,
) -> int:
    """Evaluate the rates as often as a job needs, into g; returns their status.

    START: at the present state. STEP: at every stage of a step dt [s] (one stage: explicit Euler); the
    last stage, in g.x and g.theta, is the result. SPECTRUM: at small displacements, to estimate the
    spectral radius by power iteration, always from the same direction; stretch waves of every length
    decay at E/eta, so few iterations find it. Resumed after the status STALE, a job goes on where it was.
    """
    first = int(g.estimate[1]) - 1 if resumed else 0
    if not resumed:
        _prepare(job, dt, stages, state, g)
    most = stages if job == STEP else (12 if job == SPECTRUM else 1)
    x, theta, v, omega, angular = g.x, g.theta, g.v, g.omega, g.angular
    tangent, ledger, estimate, work = g.tangent, g.ledger, g.estimate, g.work
    twist = state.reference_twist
    for k in range(first, most):
        displaced = 0.0
        if job == STEP and (k > first or not resumed):
            _next_stage(g.table[k + 1], state, g)
            _next_entry(g.table[k + 1], ledger)
        elif job == SPECTRUM:
            displaced = _perturb(state, control.radius, g)
            copy(g.v0, v)
        status = rates(
            a, m, bc, x, theta, tangent, twist, contacts, factor, control.solver_tolerance,
            v, omega, angular, work,
        )  # fmt: skip
        estimate[1] = k + 1.0
        if status != OK:
            return status
        if job == SPECTRUM:
            previous = estimate[0]
            estimate[0] = _response(control.radius, displaced, g)
            if k > 1 and abs(estimate[0] - previous) < 0.05 * estimate[0]:
                return OK
        else:
            ledger[3, 0], ledger[3, 1] = powers(a, m, bc, v, omega, contacts, work)
    return OK


def embedded_error(state: State, g: Stages, dt: float, radius: float) -> float:
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


compile_kernels(__name__, inline=("copy", "copy_flat", "_set_row"), splice=("flat",), plain=("stage_work",))

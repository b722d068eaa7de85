"""Steps of inextensible fibers with inertia, compiled: Verlet with edge lengths kept, and damped twist.

One step of length dt, from forces and torques at its start to those at its end (Andersen 1983 for the
lengths, the symmetric splitting for the damping):

    omega <- exp(-b dt) omega          half of the damping, exact
    v, omega <- half a kick by forces and torques
    x <- x + dt v                      then along the old tangents until |e| = l; v takes its share
    theta <- theta + dt omega
    v, omega <- half a kick by the new forces and torques
    v <- v without what would change lengths
    omega <- exp(-b dt) omega

Without damping it is time-reversible and symplectic, so that energy does not drift. Impulses lie in the
edges, so they change neither the momentum nor the angular momentum of the nodes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Ints, columns
from torsade.assembly import Assembly, State
from torsade.motion.ends import Boundary
from torsade.rod.constraint import add_impulses, factor_constraint, project_positions, project_velocities
from torsade.rod.elasticity import add_elastic_forces, bend_energy, hinge_twist, twist_energy
from torsade.rod.kinematics import carry_directors, edge_geometry, reference_twist_change, spread_directors

REACHED = 0
PAUSED = 5
STRETCHED = 8

MOST_ITERATIONS = 30
"""Of the projection: it takes three or four when nodes move by a hundredth of an edge."""


class Rod(NamedTuple):
    """Coefficients: stiffness in bending B and in twist C [N m^2], step dt [s].

    tolerance is how far an edge may be off its length, as a share of it.
    """

    B: float
    C: float
    dt: float
    tolerance: float


class Inertia(NamedTuple):
    """What moves, and what slows it.

    Attributes
    ----------
    mass : (n_nodes,) [kg]
    moment : (n_edges,) moments of inertia about the tangents [kg m^2]
    kept : (n_edges,) share of its spin that damping leaves an edge in half a step, exp(-b dt)
    """

    mass: Floats
    moment: Floats
    kept: Floats


class Work(NamedTuple):
    """Scratch of a run; force, torque, tangent, below and inverse belong to the present state.

    Attributes
    ----------
    w : (n_nodes,) inverse masses [1/kg], 0 where held
    force, torque : (n_nodes, 3) [N], (n_edges,) [N m]
    tangent, length : (n_edges, 3), (n_edges,) [m]
    below, inverse : (n_edges,) factors of the constraint
    p : (n_edges,) scratch of the projection
    pull : (n_edges,) impulses of a step times its length [kg m]
    new_tangent, change, m : of the step: tangents, changes of reference twist, twists of hinges
    edge_force : (n_edges, 3) elastic forces in the edges [N]
    """

    w: Floats
    force: Floats
    torque: Floats
    tangent: Floats
    length: Floats
    below: Floats
    inverse: Floats
    p: Floats
    pull: Floats
    new_tangent: Floats
    change: Floats
    m: Floats
    edge_force: Floats


class Clock(NamedTuple):
    """steps (2,): steps taken, iterations of the projection. dissipation (1,): lost to twist damping [J]."""

    steps: Ints
    dissipation: Floats


def verlet_work(a: Assembly) -> Work:
    """Scratch for an assembly."""
    n, n_edges, n_hinges = len(a.node_length), len(a.edges), len(a.hinges)
    return Work(
        w=np.zeros(n),
        force=np.zeros((n, 3)),
        torque=np.zeros(n_edges),
        tangent=columns(n_edges),
        length=np.zeros(n_edges),
        below=np.zeros(n_edges),
        inverse=np.zeros(n_edges),
        p=np.zeros(n_edges),
        pull=np.zeros(n_edges),
        new_tangent=columns(n_edges),
        change=np.zeros(n_hinges),
        m=np.zeros(n_hinges),
        edge_force=columns(n_edges),
    )


def _forces(a: Assembly, rod: Rod, bc: Boundary, state: State, g: Work, tangent: Floats) -> None:
    """Forces and torques at the state, whose tangents (n_edges, 3) and lengths are known."""
    hinge_twist(state.theta, state.reference_twist, a.hinges, g.m)
    force, torque = g.force, g.torque
    for i in range(force.shape[0]):
        for c in range(3):
            force[i, c] = bc.force[i, c]
    for e in range(torque.shape[0]):
        torque[e] = bc.torque[e]
    add_elastic_forces(a, 0.0, rod.B, rod.C, False, g.length, tangent, g.m, g.edge_force, force, torque)


def _damp(inertia: Inertia, turned: Bools, omega: Floats, clock: Clock) -> None:
    """Damp all spins but those of turned edges for half a step; what is lost counts as dissipation."""
    moment, kept = inertia.moment, inertia.kept
    for e in range(omega.shape[0]):
        if not turned[e]:
            before = omega[e]
            omega[e] *= kept[e]
            clock.dissipation[0] += 0.5 * moment[e] * (before * before - omega[e] * omega[e])


def _kick(inertia: Inertia, bc: Boundary, state: State, g: Work, half: float) -> None:
    """Velocities and spins after forces and torques have acted for the time half [s]."""
    v, w, force, held, velocity = state.v, g.w, g.force, bc.held, bc.velocity
    for i in range(v.shape[0]):
        s = half * w[i]
        for c in range(3):
            v[i, c] = velocity[i, c] if held[i] else v[i, c] + s * force[i, c]
    omega, torque, moment, turned, spin = state.omega, g.torque, inertia.moment, bc.turned, bc.spin
    for e in range(omega.shape[0]):
        omega[e] = spin[e] if turned[e] else omega[e] + half * torque[e] / moment[e]


def _drift(a: Assembly, rod: Rod, state: State, g: Work) -> int:
    """Move nodes and angles for one step, lengths kept; returns iterations, or -1 when it cannot be done."""
    x, v = state.x, state.v
    for i in range(x.shape[0]):
        for c in range(3):
            x[i, c] += rod.dt * v[i, c]
    iterations = project_positions(
        a, g.w, g.tangent, g.below, g.inverse, rod.tolerance, MOST_ITERATIONS, x, g.p, g.pull
    )
    add_impulses(a, g.w, g.tangent, g.pull, 1.0 / rod.dt, v)
    for e in range(state.theta.shape[0]):
        state.theta[e] += rod.dt * state.omega[e]
    return iterations


def _turn_frames(a: Assembly, state: State, g: Work) -> None:
    """Carry frames along with the tangents of the new positions."""
    edge_geometry(a, state.x, g.length, g.new_tangent)
    reference_twist_change(a, g.tangent, g.new_tangent, g.change)
    for k in range(g.change.shape[0]):
        state.reference_twist[k] += g.change[k]
    carry_directors(a.edge_start, state.director, g.tangent, g.new_tangent)
    for e in range(g.tangent.shape[0]):
        for c in range(3):
            g.tangent[e, c] = g.new_tangent[e, c]


def begin(a: Assembly, rod: Rod, inertia: Inertia, bc: Boundary, state: State, g: Work) -> None:
    """Find forces and factors at the state, and make its velocities fit boundary and lengths."""
    for i in range(g.w.shape[0]):
        g.w[i] = 0.0 if bc.held[i] else 1.0 / inertia.mass[i]
        if bc.held[i]:
            for c in range(3):
                state.v[i, c] = bc.velocity[i, c]
    for e in range(state.omega.shape[0]):
        if bc.turned[e]:
            state.omega[e] = bc.spin[e]
    edge_geometry(a, state.x, g.length, g.tangent)
    _forces(a, rod, bc, state, g, g.tangent)
    factor_constraint(a, g.w, g.tangent, g.below, g.inverse)
    project_velocities(a, g.w, g.tangent, g.below, g.inverse, state.v, g.p)


def step(a: Assembly, rod: Rod, inertia: Inertia, bc: Boundary, state: State, clock: Clock, g: Work) -> bool:
    """Take one step, state in place after `begin`; returns False where edge lengths cannot be kept."""
    half = 0.5 * rod.dt
    _damp(inertia, bc.turned, state.omega, clock)
    _kick(inertia, bc, state, g, half)
    iterations = _drift(a, rod, state, g)
    if iterations < 0:
        return False
    _turn_frames(a, state, g)
    _forces(a, rod, bc, state, g, g.tangent)
    _kick(inertia, bc, state, g, half)
    factor_constraint(a, g.w, g.tangent, g.below, g.inverse)
    project_velocities(a, g.w, g.tangent, g.below, g.inverse, state.v, g.p)
    _damp(inertia, bc.turned, state.omega, clock)
    clock.steps[0] += 1
    clock.steps[1] += iterations
    return True


def advance(
    a: Assembly,
    rod: Rod,
    inertia: Inertia,
    bc: Boundary,
    state: State,
    clock: Clock,
    until: int,
    most: int,
    g: Work,
) -> int:
    """Take steps until their count is `until`, at most `most` of them: REACHED, PAUSED or STRETCHED."""
    begin(a, rod, inertia, bc, state, g)
    status = REACHED
    last = min(until, clock.steps[0] + most)
    while clock.steps[0] < last and status == REACHED:
        if not step(a, rod, inertia, bc, state, clock, g):
            status = STRETCHED
    finish(a, state, g)
    return PAUSED if status == REACHED and clock.steps[0] < until else status


def finish(a: Assembly, state: State, g: Work) -> None:
    """Make all directors of the first ones after the last step."""
    spread_directors(a.hinges, g.tangent, state.reference_twist, state.director)


def energies(a: Assembly, rod: Rod, inertia: Inertia, state: State, g: Work, out: Floats) -> None:
    """Kinetic energy of nodes and of spins, bending and twist energy [J], into out (4,)."""
    edge_geometry(a, state.x, g.length, g.new_tangent)
    hinge_twist(state.theta, state.reference_twist, a.hinges, g.m)
    out[0] = 0.0
    for i in range(state.v.shape[0]):
        vx, vy, vz = state.v[i, 0], state.v[i, 1], state.v[i, 2]
        out[0] += 0.5 * inertia.mass[i] * (vx * vx + vy * vy + vz * vz)
    out[1] = 0.0
    for e in range(state.omega.shape[0]):
        out[1] += 0.5 * inertia.moment[e] * state.omega[e] * state.omega[e]
    out[2] = bend_energy(a, rod.B, False, g.length, g.new_tangent)
    out[3] = twist_energy(a, rod.C, g.m)


compile_kernels(__name__, plain=("verlet_work",))

"""Inertial steps until a rod breaks somewhere, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Ints
from torsade.assembly import Assembly, State
from torsade.fracture.criteria import Criterion
from torsade.fracture.stress_kernels import squared_stress
from torsade.motion.ends import Boundary
from torsade.motion.verlet import PAUSED, REACHED, STRETCHED, Clock, Inertia, Rod, Work, begin, finish, step
from torsade.rod.elasticity import hinge_twist
from torsade.rod.kinematics import edge_geometry

BROKEN = 9


class Bearing(NamedTuple):
    """What the rod bears.

    Attributes
    ----------
    criterion : coefficients of the stress criterion
    Eh, muh : moduli in bending and in shear times the radius [N/m]
    strength : (n_hinges,) stress at which hinges break [Pa], infinite where they cannot
    stress : (n_hinges,) scratch, then the stress after the last step [Pa]
    worst : (n_fibers,) the hinge that breaks, or -1
    """

    criterion: Criterion
    Eh: float
    muh: float
    strength: Floats
    stress: Floats
    worst: Ints


def hinge_stress(a: Assembly, b: Bearing, tangent: Floats, m: Floats) -> None:
    """Stress at every hinge, into b.stress, from tangents (n_edges, 3) and twists m (n_hinges,) [rad].

    Curvature is 2 tan(phi/2)/lbar and twist density m/lbar, lbar at rest.
    """
    hinges, hinge_length, stress = a.hinges, a.hinge_length, b.stress
    for k in range(hinges.shape[0]):
        p = hinges[k, 0]
        q = hinges[k, 1]
        dx = tangent[q, 0] - tangent[p, 0]
        dy = tangent[q, 1] - tangent[p, 1]
        dz = tangent[q, 2] - tangent[p, 2]
        half = 0.5 * (dx * dx + dy * dy + dz * dz)
        kappa = 2.0 * math.sqrt(half / (2.0 - half)) / hinge_length[k]
        twist = abs(m[k]) / hinge_length[k]
        stress[k] = math.sqrt(squared_stress(b.criterion, b.Eh * kappa, b.muh * twist))


def weakest(a: Assembly, b: Bearing) -> bool:
    """The hinge of every fiber where stress over strength is largest, if it is 1 or more, into b.worst.

    Fibers that bear their stress get -1; returns whether any does not.
    """
    hinge_start, stress, strength, worst = a.hinge_start, b.stress, b.strength, b.worst
    found = False
    for f in range(hinge_start.shape[0] - 1):
        worst[f] = -1
        largest = 1.0
        for k in range(hinge_start[f], hinge_start[f + 1]):
            ratio = stress[k] / strength[k]
            if ratio >= largest:
                largest = ratio
                worst[f] = k
                found = True
    return found


def advance_unbroken(
    a: Assembly,
    rod: Rod,
    inertia: Inertia,
    bc: Boundary,
    b: Bearing,
    state: State,
    clock: Clock,
    until: int,
    most: int,
    g: Work,
) -> int:
    """As `torsade.motion.verlet.advance`, or BROKEN after the step in which a hinge comes to its strength."""
    begin(a, rod, inertia, bc, state, g)
    status = REACHED
    last = min(until, clock.steps[0] + most)
    while clock.steps[0] < last and status == REACHED:
        if not step(a, rod, inertia, bc, state, clock, g):
            status = STRETCHED
        else:
            hinge_stress(a, b, g.tangent, g.m)
            if weakest(a, b):
                status = BROKEN
    finish(a, state, g)
    return PAUSED if status == REACHED and clock.steps[0] < until else status


def stress_of_state(a: Assembly, b: Bearing, state: State, g: Work) -> None:
    """Stress at every hinge of a state, into b.stress."""
    edge_geometry(a, state.x, g.length, g.new_tangent)
    hinge_twist(state.theta, state.reference_twist, a.hinges, g.m)
    hinge_stress(a, b, g.new_tangent, g.m)


compile_kernels(__name__)

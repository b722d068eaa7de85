"""Second derivatives are exact: fourth-order differences of the exact forces, and laws they must obey."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import Probe, three_cases, toy_model
from torsade.arrays import Floats
from torsade.assembly import Assembly
from torsade.rod.elasticity import hinge_twist
from torsade.rod.hessian import elastic_derivatives

ALONE = {
    "stretch": {"EA": 3.0, "B": 0.0, "C": 0.0},
    "bend": {"EA": 0.0, "B": 2e-3, "C": 0.0},
    "twist": {"EA": 0.0, "B": 0.0, "C": 1.5e-3},
    "all": {"EA": 3.0, "B": 2e-3, "C": 1.5e-3},
}


def derivatives(probe: Probe, present: bool) -> tuple[Floats, Floats]:
    """Gradient and Hessian by nodes and material angles, (3 n_nodes + n_edges,) and its square."""
    a, m, state = probe.a, probe.m, probe.state
    n, k = len(a.edges), len(a.hinges)
    twist = np.empty(k)
    hinge_twist(state.theta, state.reference_twist, a.hinges, twist)
    gradient, own, beside = np.empty((n, 4)), np.empty((n, 4, 4)), np.empty((k, 4, 4))
    elastic_derivatives(
        a, m.EA, m.B, present, probe.length, probe.tangent,
        m.C * twist / a.hinge_length, m.C / a.hinge_length, gradient, own, beside,
    )  # fmt: skip
    by_node = incidence(a, len(state.x))
    full = np.zeros((4 * n, 4 * n))
    for e in range(n):
        full[4 * e : 4 * e + 4, 4 * e : 4 * e + 4] += own[e]
    for h, (p, q, _) in enumerate(a.hinges):
        full[4 * p : 4 * p + 4, 4 * q : 4 * q + 4] += beside[h]
        full[4 * q : 4 * q + 4, 4 * p : 4 * p + 4] += beside[h].T
    return by_node.T @ gradient.ravel(), by_node.T @ full @ by_node


def incidence(a: Assembly, n_nodes: int) -> Floats:
    """Edges and angles from nodes and angles: (e, theta) of every edge, (4 n_edges, 3 n_nodes + n_edges)."""
    out = np.zeros((4 * len(a.edges), 3 * n_nodes + len(a.edges)))
    for e, (i, j) in enumerate(a.edges):
        for c in range(3):
            out[4 * e + c, 3 * j + c] += 1.0
            out[4 * e + c, 3 * i + c] -= 1.0
        out[4 * e + 3, 3 * n_nodes + e] = 1.0
    return out


def differences(probe: Probe) -> Floats:
    """Change of minus the forces with nodes and angles, by fourth-order differences."""
    x, theta = probe.state.x, probe.state.theta
    size = x.size + theta.size

    def gradient(change: Floats) -> Floats:
        force, torque = probe.forces(x + change[: x.size].reshape(x.shape), theta + change[x.size :])
        return -np.concatenate([force.ravel(), torque])

    columns = []
    for i in range(size):
        unit = np.zeros(size)
        unit[i] = 1e-5 if i < x.size else 1e-3
        v = [gradient(k * unit) for k in (-2, -1, 1, 2)]
        columns.append((v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * unit[i]))
    return np.array(columns).T


@pytest.mark.parametrize("case", range(3))
@pytest.mark.parametrize("present", [False, True])
@pytest.mark.parametrize("part", list(ALONE))
def test_the_hessian_is_the_change_of_the_gradient(case: int, present: bool, part: str) -> None:
    """To 1e-9 of its largest entry, for open and closed fibers.

    Forces are along directors carried with the motion, whose holonomy makes their change unsymmetric where
    angles are held; along great circles from the state, which the Hessian is by, it is the symmetric part.
    """
    a, state = three_cases()[case]
    probe = Probe(a, toy_model(h=1e-3, bend_present=present, **ALONE[part]), state)
    force, torque = (f.copy() for f in probe.forces(state.x, state.theta))
    probe.forces(state.x, state.theta)
    gradient, hessian = derivatives(probe, present)
    assert np.abs(gradient + np.concatenate([force.ravel(), torque])).max() < 1e-13 * np.abs(gradient).max()
    change = differences(probe)
    largest = np.abs(hessian).max()
    assert largest > 0
    assert np.abs(hessian - hessian.T).max() < 1e-12 * largest
    assert np.abs(hessian - 0.5 * (change + change.T)).max() < 1e-9 * largest


@pytest.mark.parametrize("case", range(3))
def test_translations_cost_nothing(case: int) -> None:
    """All nodes moved alike: H u = 0 exactly, whatever the state."""
    a, state = three_cases()[case]
    probe = Probe(a, toy_model(h=1e-3), state)
    probe.forces(state.x, state.theta)
    _, hessian = derivatives(probe, False)
    for c in range(3):
        shift = np.zeros(len(hessian))
        shift[c : 3 * len(state.x) : 3] = 1.0
        assert np.abs(hessian @ shift).max() < 1e-11 * np.abs(hessian).max()

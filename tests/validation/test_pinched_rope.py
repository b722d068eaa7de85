"""A rope pulled through a pinch (thesis 4.2): 4 eta A v a/l^2 = 2F + F^2/(EA), from collision drag alone."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import Probe, straight
from torsade.assembly import assemble, initial_state
from torsade.material import Material, Section
from torsade.motion import ends
from torsade.motion.overdamped import PUBLISHED, STANDARD, Motion, Outcome, Stepping, model

H = 0.1
PINCH = 12 * H
APART = 1.2 * H


def rope_profile(n, l, strain, start):
    """Nodes of a rope with rest lengths l, unstrained before the pinch, strained after, linear within."""
    x, nodes = start, [start]
    for _ in range(n - 1):
        x += l * (1 + strain * np.clip((x + l / 2) / PINCH + 0.5, 0, 1))
        nodes.append(x)
    return np.array(nodes)


def pinched(F_over_EA, l_rope, l_pinch, slide):
    """Velocities before and after the pinch and the drag per length, k = sum eta_f A .. over the pinch."""
    material = Material("rope", E=1e3, E_b=1e3, nu=0.3, rho=1.0, eta=10.0)
    m = model(material, Section(H))._replace(K=0.0)
    n = int(np.ceil((3.5 * PINCH) / l_rope))
    rope = np.zeros((n, 3))
    rope[:, 0] = rope_profile(n, l_rope, F_over_EA, -2.3 * PINCH)
    cheeks = []
    for angle in (0, np.pi / 2, np.pi, 3 * np.pi / 2):
        cheek = straight(round(PINCH / l_pinch) + 1, PINCH)
        cheek += np.array([-PINCH / 2, APART * np.cos(angle), APART * np.sin(angle)])
        cheeks.append(cheek)
    strands = [rope, *cheeks]
    at_rest = assemble(strands)
    rest = np.split(at_rest.rest_length, at_rest.edge_start[1:-1])
    rest[0] = np.full(n - 1, l_rope)
    a = assemble(strands, None, rest)
    F = F_over_EA * m.EA
    bc = ends.pull(ends.free(a), a, 0, 1, np.array([F, 0, 0]))
    held = bc.held.copy()
    held[n:] = True
    bc = bc._replace(held=held)
    motion = Motion(a, m, bc, initial_state(a, strands), Stepping(tolerance=1e-3))
    reach = np.sqrt(4 * H**2 - APART**2)
    k = 4 * m.eta_f_A * 2 * reach / (APART**2 * 2 * H)
    speed = F / (k * PINCH)
    assert motion.advance(0.3 * slide / speed) is Outcome.REACHED
    before, t = motion.state.x.copy(), motion.time
    assert motion.advance(slide / speed) is Outcome.REACHED
    v = (motion.state.x - before)[:n, 0] / (motion.time - t)
    assert np.abs(motion.state.x[:n, 1:]).max() < 1e-6 * H
    assert motion.state.x[0, 0] < -PINCH / 2 - 2 * H
    return v[0], v[-1], k, F, m.EA


@pytest.mark.parametrize("pull", [0.1, 0.4])
def test_pinched_rope(pull):
    """The thesis's relation to 2 %, with 2 eta A/l^2 = k the drag per rest length of rope in the pinch.

    The pinch is four parallel fibers held fixed around the rope, at 1.2 h, without contact stiffness: the
    rope is held by collision drag (4.8) alone. Its drag per length, derived here, is the integral of
    eta_f A/R^3 over the reach of contact, 4 x 2 eta_f A c/(d^2 2h), c^2 = 4h^2 - d^2.

    The thesis seeks the same velocity v everywhere; a rope that stretches cannot have that: what leaves the
    pinch is faster by 1 + F/EA than what enters. Steady sliding is exactly k a v_in = F, k a v_out = F +
    F^2/EA; the thesis's relation, 2 k a v = 2F + F^2/EA, holds for the mean of the two.
    """
    v_in, v_out, k, F, EA = pinched(pull, 0.5 * H, 0.17 * H, 0.3 * PINCH)
    assert 2 * k * PINCH * 0.5 * (v_in + v_out) == pytest.approx(2 * F + F**2 / EA, rel=0.02)
    assert k * PINCH * v_in == pytest.approx(F, rel=0.02)
    assert k * PINCH * v_out == pytest.approx(F + F**2 / EA, rel=0.02)


def drag_per_length(laws, l):
    """Drag force per length and speed on a long strand that slides along one held beside it."""
    n = round(4.0 / l) + 1
    strands = [straight(n, 4.0), straight(n, 4.0, 0, (l / 3, APART, 0))]
    a = assemble(strands)
    m = model(Material("rope", E=1e3, E_b=1e3, nu=0.3, rho=1.0, eta=10.0), Section(H), laws)
    state = initial_state(a, strands)
    bc = ends.clamp(ends.free(a), a, 1, 0)
    probe = Probe(a, m, state, bc)
    M = probe.drag_matrix(state.x, state.theta)
    inside = (state.x[:, 0] > 1) & (state.x[:, 0] < 3)
    first = np.arange(len(state.x)) < n
    force = M[np.ix_(inside & first, ~first)].sum()
    return -force / (a.node_length[inside & first].sum() * m.eta_f_A)


def test_continuum_drag_converges_and_node_pair_drag_does_not():
    """ERRATA on (4.6) and (4.8): the sum over neighbours of (4.6) grows as 1/l, that of (4.8) has a limit.

    The limit is 2c/(d^2 2h), c^2 = 4h^2 - d^2; (4.6) sums 1/r^2 over 2c/l neighbours.
    """
    meshes = [0.2 * H, 0.1 * H, 0.05 * H]
    reach = np.sqrt(4 * H**2 - APART**2)
    smooth = [drag_per_length(STANDARD, l) for l in meshes]
    rough = np.array([drag_per_length(PUBLISHED, l) for l in meshes])
    assert smooth[-1] == pytest.approx(2 * reach / (APART**2 * 2 * H), rel=0.01)
    assert abs(smooth[1] / smooth[0] - 1) < 0.03
    assert np.allclose(rough[1:] / rough[:-1], 2, rtol=0.1)
    assert rough[-1] == pytest.approx(2 * np.arctan(reach / APART) / APART / meshes[-1], rel=0.05)

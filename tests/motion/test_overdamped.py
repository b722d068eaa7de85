"""Runs of `Motion`: energy, link, repeatability, and what must not matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rod.helpers import (
    random_loop,
    straight,
    tangle,
    total_twist,
    touching_loop,
    toy_model,
    twist_closed,
    writhe,
)
from torsade.assembly import assemble, initial_state
from torsade.errors import TorsadeError
from torsade.material import preset
from torsade.motion import ends
from torsade.motion.overdamped import PUBLISHED, STANDARD, Motion, Outcome, Stepping, model

TAU = 0.01  # eta/E of the toy material [s]


def tangled_motion(seed=0, laws=STANDARD, how=None, drive=None, turns=0.0, link=0):
    a, state, h = tangle(seed)
    state = twist_closed(state, slice(0, 60), link)
    state.theta[60:] += turns * np.linspace(0, 2 * np.pi, 49)
    bc = ends.free(a) if drive is None else drive(a)
    return Motion(a, toy_model(h, laws), bc, state, how), h


def pulled(a):
    return ends.clamp(ends.pull(ends.free(a), a, 1, 1, np.array([1.0, -0.5, 0.7])), a, 1, 0)


def moved(a):
    return ends.clamp(ends.move(ends.free(a), a, 1, 1, np.array([3.0, -2.0, 1.0]), tangent=True), a, 1, 0)


def turned(a):
    return ends.turn(ends.turn(ends.free(a), a, 1, 1, 40.0), a, 1, 0, -30.0)


# --- energy


@pytest.mark.parametrize("ratio", [1e-3, 0.1, 3.3, 50.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_energy_never_grows_by_itself(seed, ratio):
    """Twisted tangles in contact, left alone: no step adds energy, contact energy included (DESIGN 5)."""
    motion, _ = tangled_motion(seed, replace(STANDARD, eta_f_ratio=ratio), turns=2.0, link=2)
    energy = start = motion.energies().total
    assert motion.energies().contact > 0
    for _ in range(20):
        motion.advance(TAU * 100, max_steps=4)
        after = motion.energies().total
        assert after < energy + 1e-6 * start
        energy = after
    assert energy < 0.999 * start
    assert motion.external_work == 0.0


@pytest.mark.parametrize("drive", [None, pulled, moved, turned])
def test_work_is_stored_or_dissipated(drive):
    """W_ext = dissipation + change of energy, to the step tolerance.

    Both integrals are taken by the scheme itself, of second order, with steps whose local error, of third
    order, is the tolerance: ten times finer means steps 2.15 times shorter and an imbalance 4.6 times
    smaller. What there is comes from the first crushing of contacts that start deep.
    """
    imbalance = []
    for tolerance in (1e-2, 1e-3, 1e-4):
        motion, _ = tangled_motion(0, how=Stepping(tolerance=tolerance), drive=drive, turns=0.5)
        start = motion.energies().total
        assert motion.advance(30 * TAU) is Outcome.REACHED
        stored = motion.energies().total - start
        imbalance.append(abs(motion.external_work - motion.dissipation - stored) / motion.dissipation)
    assert imbalance[0] < 3e-2
    assert imbalance[1] < 8e-3
    assert imbalance[2] < 2e-3
    assert imbalance[2] < imbalance[1] / 2.5 < imbalance[0] / 2.5**2


def test_dissipation_and_work_of_a_fiber_pulled_straight():
    """Closed form: x(t) = F L/(EA) (1 - exp(-t/tau)); W = F x, half is stored in the end."""
    n, F = 11, 0.5
    x = straight(n, 1.0)
    a = assemble([x])
    m = toy_model()
    bc = ends.clamp(ends.pull(ends.free(a), a, 0, 1, np.array([F, 0, 0])), a, 0, 0)
    motion = Motion(a, m, bc, initial_state(a, [x]), Stepping(tolerance=1e-6))
    for t in (0.5 * TAU, TAU, 3 * TAU):
        motion.advance(t)
        moved = F / m.EA * (1 - np.exp(-t / TAU))
        assert motion.state.x[-1, 0] - 1 == pytest.approx(moved, rel=1e-3)
        assert motion.external_work == pytest.approx(F * moved, rel=2e-3)
        assert motion.energies().total == pytest.approx(0.5 * m.EA * moved**2, rel=2e-3)
        assert motion.dissipation == pytest.approx(F * moved - 0.5 * m.EA * moved**2, rel=2e-3)


def test_work_and_twist_of_a_turned_fiber():
    """Closed form: spun at rate S by one end, twist S t spread evenly; W = C (S t)^2/2L + eta J S^2 t/L."""
    n, S, t = 21, 30.0, 5 * TAU
    x = straight(n, 1.0)
    a = assemble([x])
    m = toy_model()
    bc = ends.turn(ends.clamp(ends.free(a), a, 0, 0), a, 0, 1, S)
    motion = Motion(a, m, bc, initial_state(a, [x]), Stepping(tolerance=1e-5))
    motion.advance(t)
    twist, L = S * t, 1.0 - 1.0 / (n - 1)  # between the middles of the first and the last edge
    assert total_twist(a, motion.state) == pytest.approx(twist, rel=1e-12)
    assert np.allclose(np.diff(motion.state.theta), twist / (n - 2), rtol=1e-9)
    assert motion.energies().twist == pytest.approx(0.5 * m.C * twist**2 / L, rel=1e-9)
    assert motion.dissipation == pytest.approx(m.eta_J * S**2 * t / L, rel=1e-9)
    assert motion.external_work == pytest.approx(motion.dissipation + motion.energies().twist, rel=1e-9)


# --- link


@pytest.mark.parametrize("link", [0, 1, -3])
@pytest.mark.parametrize("seed", range(3))
def test_link_of_a_moving_loop_is_constant(seed, link):
    """Lk = Tw + Wr to 1e-9 (DESIGN 4) while a twisted loop relaxes, in contact with itself."""
    x, h = touching_loop(seed, 80)
    a = assemble([x], [True])
    state = twist_closed(initial_state(a, [x]), slice(0, 80), link)
    motion = Motion(a, toy_model(h), ends.free(a), state)
    assert len(motion.measure().contacts) > 0
    start = total_twist(a, state) / (2 * np.pi) + writhe(x)
    assert start == pytest.approx(round(start), abs=1e-10)
    for k in range(1, 9):
        motion.advance(k * 50 * TAU)
        s = motion.state
        assert total_twist(a, s) / (2 * np.pi) + writhe(s.x) == pytest.approx(start, abs=1e-9)
    assert abs(writhe(motion.state.x) - writhe(x)) > 0.01


def test_link_without_contact_and_with_fixed_steps():
    """The same for an open curve of the loop kind, free of contact, in plain Euler steps."""
    x = random_loop(3, 60)
    a = assemble([x], [True])
    state = twist_closed(initial_state(a, [x]), slice(0, 60), 4)
    motion = Motion(a, toy_model(0.01), ends.free(a), state, Stepping(fixed_step=0.3 * TAU))
    start = total_twist(a, state) / (2 * np.pi) + writhe(x)
    for k in range(1, 6):
        motion.advance(k * 100 * TAU)
        s = motion.state
        assert total_twist(a, s) / (2 * np.pi) + writhe(s.x) == pytest.approx(start, abs=1e-9)


def test_directors_stay_orthonormal_and_tell_the_reference_twist():
    """After many steps directors are unit and normal to their edge to round-off."""
    motion, _ = tangled_motion(1, drive=moved, turns=1.0)
    motion.advance(20 * TAU)
    s, a = motion.state, motion.assembly
    edge = s.x[a.edges[:, 1]] - s.x[a.edges[:, 0]]
    assert np.abs(np.einsum("ij,ij->i", s.director, s.director) - 1).max() < 1e-14
    assert np.abs(np.einsum("ij,ij->i", s.director, edge)).max() < 1e-14


# --- what must not matter


def same(a, b):
    return all(np.array_equal(p, q) for p, q in zip(a, b, strict=True))


@pytest.mark.parametrize("how", [Stepping(), Stepping(fixed_step=1e-4)])
@pytest.mark.parametrize("laws", [STANDARD, replace(PUBLISHED, exclusion_edges=3)])
def test_same_run_twice_is_bit_identical(how, laws):
    """DESIGN 8: same input, same result, bit for bit, clocks included."""
    runs = []
    for _ in range(2):
        motion, _ = tangled_motion(0, laws, how, pulled)
        motion.advance(5 * TAU)
        motion.advance(10 * TAU)
        runs.append(motion)
    assert same(runs[0].state, runs[1].state)
    assert runs[0].counts == runs[1].counts
    assert runs[0].external_work == runs[1].external_work
    assert runs[0].dissipation == runs[1].dissipation


@pytest.mark.parametrize("how", [Stepping(), Stepping(fixed_step=1e-4)])
def test_restored_run_is_the_uninterrupted_one(how):
    """From a checkpoint a new Motion goes on as if nothing had happened, bit for bit."""
    whole, _ = tangled_motion(0, how=how, drive=pulled)
    whole.advance(5 * TAU)
    checkpoint = whole.checkpoint()
    whole.advance(10 * TAU)
    whole.advance(12 * TAU)
    resumed, _ = tangled_motion(0, how=how, drive=pulled)
    resumed.advance(1 * TAU)
    resumed.restore(checkpoint)
    assert resumed.time == pytest.approx(5 * TAU, rel=1e-15)
    resumed.advance(10 * TAU)
    resumed.energies()  # looking must not touch
    resumed.advance(12 * TAU)
    assert same(whole.state, resumed.state)
    assert whole.counts == resumed.counts
    assert whole.external_work == resumed.external_work
    assert same(checkpoint.state, checkpoint.state.copy())


def test_looking_changes_nothing():
    """Energies, compression and pairs between advances leave the run as it is."""
    runs = []
    for look in (False, True):
        motion, _ = tangled_motion(0, drive=pulled)
        for k in range(1, 5):
            motion.advance(k * 2 * TAU)
            if look:
                motion.measure(), motion.checkpoint()
        runs.append(motion)
    assert same(runs[0].state, runs[1].state)


def test_the_neighbour_list_does_not_show():
    """Lists that reach 0.1 radii (made often) and 6 (made once) give the same motion."""
    ends_at = []
    for skin, roam in ((0.1, 0.1), (0.8, 1.6), (6.0, 12.0)):
        how = Stepping(skin=skin, roam=roam, tolerance=1e-4, solver_tolerance=1e-9)
        motion, _ = tangled_motion(1, how=how, drive=moved)
        motion.advance(20 * TAU)
        ends_at.append((motion.state.x.copy(), motion.counts["neighbour_lists"]))
    assert ends_at[0][1] > 2 * ends_at[2][1]
    travelled = 20 * TAU * np.sqrt(14)
    for x, _ in ends_at[:2]:
        assert np.abs(x - ends_at[2][0]).max() < 1e-5 * travelled


def test_moving_the_origin_does_not_show():
    """Translation by many diameters moves the result by as much and nothing else."""
    a, state, h = tangle(0)
    far = np.array([17.0, -5.0, 31.0])
    result = []
    for shift in (0 * far, far):
        s = state._replace(x=state.x + shift)
        motion = Motion(a, toy_model(h), pulled(a), s, Stepping(tolerance=1e-4, solver_tolerance=1e-9))
        motion.advance(10 * TAU)
        result.append(motion.state.x - shift)
    assert np.abs(result[0] - result[1]).max() < 1e-5 * h


def test_a_mirror_image_moves_as_the_mirror_image():
    """Parity: mirrored nodes with opposite twist stay mirrored (a wrong sign anywhere would show)."""
    a, state, h = tangle(0)
    rng = np.random.default_rng(0)
    theta = rng.normal(size=len(state.theta))
    flip = np.array([1.0, 1.0, -1.0])
    out = []
    for sign, factor in ((1, np.ones(3)), (-1, flip)):
        s = state._replace(
            x=state.x * factor,
            director=state.director * factor,
            theta=sign * theta,
            reference_twist=sign * state.reference_twist,
        )
        motion = Motion(a, toy_model(h), ends.free(a), s, Stepping(tolerance=1e-4, solver_tolerance=1e-9))
        motion.advance(10 * TAU)
        out.append((motion.state.x * factor, sign * motion.state.theta))
    assert np.abs(out[0][0] - out[1][0]).max() < 1e-5 * h
    assert np.abs(out[0][1] - out[1][1]).max() < 1e-4


# --- outcomes


def test_two_ropes_pulled_apart_have_slipped():
    """Once nothing holds the pulled strand the run says SLIPPED and keeps the time.

    The last two contacts are mirror images of each other and open at one time.
    """
    h = 0.1
    left, right = straight(21, 2.0), straight(21, 2.0, 0, (1.0, 1.9 * h, 0))
    a = assemble([left, right])
    bc = ends.clamp(ends.pull(ends.free(a), a, 1, 1, np.array([1.0, 0, 0])), a, 0, 0)
    motion = Motion(a, toy_model(h), bc, initial_state(a, [left, right]))
    assert motion.advance(1e3) is Outcome.SLIPPED
    assert 0 < motion.time < 1e3
    assert len(motion.measure().contacts) <= 2
    assert motion.measure().compression < 1e-6 * motion.model.EA


def spoilt(record):
    """The record with all its arrays filled with NaN, the largest integer or True."""
    fill = {"f": np.nan, "i": np.iinfo(np.int64).max, "b": True}
    for part in record:
        if isinstance(part, np.ndarray):
            part[...] = fill[part.dtype.kind]
        else:
            spoilt(part)
    return record


def test_what_scratch_holds_does_not_matter():
    """Nothing is read before it is written: scratch and freed memory full of NaN change no bit."""
    clean, _ = tangled_motion(0)
    clean.advance(TAU)
    for _ in range(3):
        junk = [np.full(size, np.nan) for size in range(1, 4000, 3)]
        del junk
        motion, _ = tangled_motion(0)
        spoilt(motion._scratch)
        motion.advance(TAU)
        assert all(np.array_equal(p, q) for p, q in zip(motion.state, clean.state, strict=True))
        assert motion.counts == clean.counts
        assert motion.energies() == clean.energies()


def test_pausing_counts_steps():
    """max_steps stops early, says so, and the clock counts what was done."""
    motion, _ = tangled_motion(0)
    assert motion.advance(TAU, max_steps=3) is Outcome.PAUSED
    assert motion.steps == 3
    assert motion.counts["steps"] == 3
    assert motion.advance(TAU) is Outcome.REACHED
    assert motion.time == TAU


def test_a_material_without_viscosity_is_refused():
    """Overdamped motion needs eta; the message says so and what to do."""
    with pytest.raises(TorsadeError, match="eta > 0"):
        model(preset("spaghetti").material, preset("spaghetti").section)

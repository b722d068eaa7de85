"""Sutures against closed forms, symmetry, and the balance of forces and of work."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from torsade.assembly import assemble, initial_state
from torsade.errors import TorsadeError
from torsade.material import Section, preset
from torsade.motion import ends
from torsade.motion.overdamped import Laws, Motion, Outcome, Stepping, model
from torsade.motion.wound import Tissue, measure_skin, tied_around
from torsade.protocols import Suture
from torsade.rod.skin import SETTLED, weigh_skin

FIBER = preset("optomechanical")
H, H_S = FIBER.radius, 10 * FIBER.radius


@lru_cache
def run(throws: str, **more):
    return Suture(throws=throws, frames=40, **more).run().dataset


def hung(left: float, right: float, friction: float = 0.0, drag: float = 1.0, stiffness: float = 50.0):
    """A fiber over a cylinder, its ends pulled down with two forces [N]."""
    reach = H_S + 0.98 * H
    turn = np.linspace(0, np.pi, 127)
    bow = reach * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    down = np.arange(H / 2, 10 * H, H / 2)[:, None] * [0.0, -1.0, 0.0]
    x = np.concatenate([bow[0] + down[::-1], bow, bow[-1] + down])
    a = assemble([x])
    bc = ends.pull(ends.free(a), a, 0, 0, np.array([0.0, -right, 0.0]))
    bc = ends.pull(bc, a, 0, 1, np.array([0.0, -left, 0.0]))
    tissue = Tissue(H_S, stiffness, 0.1 * stiffness, drag, friction)
    a, state, bc = tied_around(a, initial_state(a, [x]), bc, np.zeros((1, 3)), tissue)
    return Motion(a, model(FIBER.material, Section(H), Laws()), bc, state, Stepping())


def test_a_loop_under_tension_presses_with_twice_the_tension():
    """A half turn of tension T presses its cylinder with 2T, along its arc with T (pi - bending) in sum."""
    T = 0.01
    motion = hung(T, T)
    assert motion.advance(3.0) is Outcome.REACHED
    motion.measure()
    skin = measure_skin(motion)
    assert skin.total[0] == pytest.approx([0, -2 * T, 0], rel=1e-4, abs=1e-7)
    assert skin.spring[0] == pytest.approx([0, 2 * T, 0], rel=1e-4, abs=1e-7)
    pressing = float(skin.normal[0] @ motion.assembly.rest_length)
    # Force per length (T - B kappa^2/2)/r on the arc of radius r, and a line force at each of its ends.
    assert pressing == pytest.approx(np.pi * T, rel=0.02)
    assert np.abs(skin.around).max() < 1e-4 * skin.normal.max()


@pytest.mark.parametrize(("share", "slides"), [(0.9, False), (1.1, True)])
def test_a_capstan_holds_up_to_euler_and_eytelwein(share, slides):
    """Dry friction mu on half a turn holds a tension ratio of exp(pi mu), and no more."""
    mu, T = 0.3, 0.005
    motion = hung(T, share * T * np.exp(np.pi * mu), friction=mu, drag=0.05)
    motion.advance(0.5)
    before = motion.state.x[0, 1]
    motion.advance(0.7)
    speed = (before - motion.state.x[0, 1]) / 0.2
    assert (speed > 3e-4) if slides else (speed < 3e-5)


def test_forces_on_the_skin_are_those_of_the_springs():
    """Fiber and spring leave what drags a side through the ground; together sides are lifted as ends are."""
    data = run("3,-3", duration=1.0, skin_stiffness=60.0)
    assert float(data["gap"].min()) > 0
    w, t = data["skin_position"].values, data["time"].values
    moving = 60.0 * 0.1 * np.gradient(w, t, axis=0)
    left = data["skin_force"].values + data["spring_force"].values - moving
    assert np.abs(left[20:]).max() < 1e-3 * np.abs(data["skin_force"].values).max()
    lift = data["skin_force"].values[-1, :, 1].sum()
    assert lift == pytest.approx(2 * 0.01 * np.sin(np.pi / 6), rel=1e-3)
    l = np.linalg.norm(np.diff(Suture(throws="3,-3").stitch().strand, axis=0), axis=1)
    assert data["skin_normal"].values @ l == pytest.approx(data["skin_pressing"].values, rel=1e-5, abs=1e-9)


def test_the_mirror_image_moves_as_the_mirror_image():
    """(-b, -t) is (b, t) with z turned over, all the way; ends exchanged, a suture is itself."""
    one, other = run("5,-3", duration=1.0), run("-5,3", duration=1.0)
    x, y = one["position"].values, other["position"].values
    assert np.abs(x - y * (1, 1, -1)).max() < 0.02 * H  # as far as steps are exact
    z = one["skin_position"].values[:, :, 2]
    assert np.abs(z).max() > 0.01 * H
    assert np.abs(z + other["skin_position"].values[:, :, 2]).max() < 0.03 * np.abs(z).max()
    assert np.abs(z.sum(axis=1)).max() < 1e-6 * np.abs(z).max()
    assert np.abs(x - x[:, ::-1] * (-1, 1, -1)).max() < 1e-6 * H


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_work_is_stored_or_dissipated(friction):
    """That of the pull, fibers laid on the skin included, within half a per cent at every frame."""
    data = run("3,3", duration=1.0, friction=friction)
    kinds = ("stretch", "bend", "twist", "contact", "skin", "springs")
    stored = sum(data[f"energy_{kind}"] for kind in kinds)
    missing = data["external_work"] - data["dissipation"] - (stored - stored[0])
    assert float(abs(missing).max()) < 5e-3 * float(data["external_work"][-1])
    assert bool((data["dissipation"].diff("time") >= 0).all())


@pytest.mark.parametrize("friction", [0.3, 1.0])
def test_dry_friction_agrees_with_the_velocities(friction):
    """At every stop the velocities solved for are those by which the friction was weighed."""
    trial = Suture(throws="3,3", friction=friction).trial()
    motion, touching = trial.motion, 0
    skin = motion.boundary.skin
    for until in np.linspace(0.02, 0.6, 30):
        while motion.advance(until) is Outcome.SLIPPED:
            assert trial.catch(until) is Outcome.PAUSED
        touching += int(skin.count[0])
        assert weigh_skin(motion.assembly, motion.model, skin, motion.state.v) < SETTLED
    assert touching > 1000


def test_let_go_energy_falls():
    """Without a pull nothing does work, and the springs open the wound again."""
    data = run("3,-3", duration=2.0, release=1.0)
    kinds = ("stretch", "bend", "twist", "contact", "skin", "springs")
    stored = sum(data[f"energy_{kind}"] for kind in kinds).values
    let_go = data["time"].values >= 2.0
    assert np.all(np.diff(stored[let_go]) < 0)
    assert np.ptp(data["external_work"].values[let_go]) == 0
    assert float(data["gap"][-1]) > float(data["gap"].values[let_go][0]) + 1e-4


def test_nothing_goes_into_the_skin():
    """The axis of the fiber stays outside at every frame, and hardly dips in where it presses."""
    data = run("3,3", duration=1.0)
    x, w = data["position"].values, data["skin_position"].values
    apart = np.linalg.norm((x[:, None] - w[:, :, None])[..., :2], axis=-1)
    assert apart.min() > H_S + 0.8 * H


@pytest.mark.slow
def test_throws_of_one_hand_shear_the_skin_most():
    """Thesis Fig 6-2B, found again: granny and surgeon's granny move the skin along z more than others."""
    opposite = [run(t)["skin_position"].values[-1, 0, 2] for t in ("3,-3", "5,-3", "3,-5", "5,-5")]
    same = [run(t)["skin_position"].values[-1, 0, 2] for t in ("3,3", "5,3")]
    assert min(np.abs(same)) > 1.5 * max(np.abs(opposite))


@pytest.mark.parametrize("frames", [True, 2.5, 1])
def test_frames_of_a_suture_are_whole_and_two_at_least(frames: object) -> None:
    with pytest.raises(TorsadeError, match="frames"):
        Suture(throws="3,-3", frames=frames)

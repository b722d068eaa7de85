"""Reidemeister moves: against the planar elastica, clamped beams that press on each other, mirror images."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import nnls

import torsade as ts
from torsade.protocols import Reidemeister
from torsade.protocols.driving import Interrupted
from torsade.protocols.moves import LOOP, MOVES, planar_loop
from torsade.protocols.reidemeister import elastic_energy
from torsade.topology import writhe

C_OVER_B = 1 / 1.3


@cache
def moved(move: str, **fields: Any) -> ts.Result:
    """A short, coarse run; slow enough to be in equilibrium to a percent."""
    usual = {"length": "12 mm", "duration": "200 s", "frames": 80}
    return Reidemeister(move=move, **(usual | fields)).run()


def energies(result: ts.Result) -> np.ndarray:
    """Stored energy at every frame in units of B/L."""
    return elastic_energy(result) / Reidemeister.report(result)["B_over_L_J"]


# --- the planar loop in closed form


def test_the_loop_is_a_circle_where_its_ends_meet() -> None:
    assert planar_loop(1e-6).energy == pytest.approx(2 * math.pi**2, rel=1e-6)


def test_the_loop_in_a_long_fiber_has_the_energy_of_its_slack() -> None:
    """Slack 4 √(B/T), bending energy 4 √(BT) = 16 B/slack; with the work of T it is 8 √(BT)."""
    loop = planar_loop(0.97)
    slack = 1 - loop.distance
    assert loop.energy == pytest.approx(16 / slack, rel=1e-9)
    assert loop.energy + loop.tension * slack == pytest.approx(8 * math.sqrt(loop.tension), rel=1e-9)


@pytest.mark.parametrize("distance", [0.1, 0.4, 0.8])
def test_the_tension_of_the_loop_is_the_slope_of_its_energy(distance: float) -> None:
    step = 1e-5
    slope = (planar_loop(distance + step).energy - planar_loop(distance - step).energy) / (2 * step)
    assert planar_loop(distance).tension == pytest.approx(slope, rel=1e-7)


def test_the_loop_solves_the_elastica() -> None:
    """theta'² = (c - cos theta) 2T/B through one turn: length, distance and energy by quadrature."""
    loop = planar_loop(0.3)
    least = 4 * loop.K**2 * 4 * (1 - loop.m)  # theta'² where the ends are held
    rate = lambda a: math.sqrt(least + 2 * loop.tension * (1 - math.cos(a)))  # noqa: E731
    integral = lambda f: quad(lambda a: f(a) / rate(a), 0, 2 * math.pi)[0]  # noqa: E731
    assert integral(lambda a: 1.0) == pytest.approx(1, rel=1e-9)
    assert integral(math.cos) == pytest.approx(0.3, rel=1e-9)
    assert integral(lambda a: 0.5 * rate(a) ** 2) == pytest.approx(loop.energy, rel=1e-9)


def test_nodes_of_the_loop_are_even_and_its_ends_on_the_axis() -> None:
    (x,) = MOVES["R1"](1e-6, 0.004).strands
    l = np.linalg.norm(np.diff(x, axis=0), axis=1)
    np.testing.assert_allclose(l, 0.004, rtol=1e-3)
    ends = 0.5 * (x[[0, -1]] + x[[1, -2]])
    np.testing.assert_allclose(ends, [[-LOOP[0] / 2, 0, 0], [LOOP[0] / 2, 0, 0]], atol=2e-5)


def test_strands_begin_clear_of_each_other() -> None:
    for move in MOVES:
        shape = Reidemeister(move=move).configuration()
        assert ts.curve.clearance(shape.strands, shape.closed, 8 * 2e-4).distance > 4e-4


# --- R1


def test_the_path_of_r1_is_the_elastica_until_the_loop_turns_out_of_its_plane() -> None:
    """At distances of 0.25 to 0.3, past the contact at its foot and before 0.30, where the plane is left."""
    result = moved("R1", length="40 mm", duration="1200 s", spacing="0.2 mm")
    distance = LOOP[0] + result.dataset["displacement"].values / 40e-3
    planar = (distance > 0.24) & (distance < 0.3)
    assert planar.sum() >= 4
    expected = [planar_loop(d).energy for d in distance[planar]]
    np.testing.assert_allclose(energies(result)[planar], expected, rtol=4e-3)


def test_gripped_ends_turn_the_loop_into_twist() -> None:
    """In the end ½ C Tw²/L, where Tw/2π is the writhe that the loop had: held ends keep Tw/2π + Wr."""
    result = moved("R1")
    data, spec = result.dataset, Reidemeister(**result.spec)
    twist = data["twist"].values[:, 0]
    x = data["position"].values.astype(float)
    link = [twist[k] / (2 * math.pi) + writhe([_led_out(x[k])], False) for k in (0, -1)]
    assert link[1] == pytest.approx(link[0], abs=5e-3)
    unit = Reidemeister.report(result)["B_over_L_J"]
    stored = 0.5 * C_OVER_B * twist[-1] ** 2 * spec.free_length / data_length(result)
    assert data["energy_twist"].values[-1] / unit == pytest.approx(stored, rel=0.02)
    assert 0.8 < twist[-1] / (2 * math.pi) < 1


def _led_out(x: np.ndarray) -> np.ndarray:
    """The curve with ends led far out along x, where what is open adds no writhe."""
    far = 100 * np.ptp(x[:, 0])
    out = np.array([[far, 0.0, 0.0]])
    return np.concatenate([x[:1] - out, x, x[-1:] + out])


def data_length(result: ts.Result) -> float:
    """Rest length between the middles of the edges at the grips [m]."""
    x = result.dataset["position"].values[0].astype(float)
    l = np.linalg.norm(np.diff(x, axis=0), axis=1)
    return float(l.sum() - 0.5 * (l[0] + l[-1]))


def test_ends_that_spin_keep_no_twist() -> None:
    result = moved("R1", ends="swivel")
    assert np.abs(result.dataset["twist"]).max() < 0.1
    assert energies(result)[-1] < 0.1 * energies(result)[0]
    assert Reidemeister.report(result)["energy_top_J"] < Reidemeister.report(moved("R1"))["energy_top_J"]


def test_r1_loses_its_crossing_once_and_costs_far_more_than_the_others() -> None:
    reports = {move: Reidemeister.report(moved(move)) for move in MOVES}
    barrier = {
        move: (report["energy_top_J"] - min(report["energy_start_J"], report["energy_end_J"]))
        / report["B_over_L_J"]
        for move, report in reports.items()
    }
    assert barrier["R1"] > 9
    assert max(barrier["R2"], barrier["R3"]) < 0.7
    crossings = {move: np.array(report["crossings"]) for move, report in reports.items()}
    assert crossings["R1"][0] == 1
    assert (np.diff(crossings["R1"]) != 0).sum() == 1
    assert (crossings["R2"][0], crossings["R2"][-1]) == (0, 2)
    assert (np.diff(crossings["R2"]) != 0).sum() == 1
    assert set(crossings["R3"]) == {3}


@pytest.mark.parametrize("move", MOVES)
def test_the_mirror_image_has_the_same_energies(move: str) -> None:
    over, under = (moved(move, side=side) for side in ("over", "under"))
    np.testing.assert_allclose(energies(under), energies(over), rtol=2e-3, atol=1e-3)
    np.testing.assert_allclose(under.dataset["twist"], -over.dataset["twist"], atol=0.03)


# --- R2 and R3: clamped beams that press on each other


def yielding(x: float, a: float) -> float:
    """Deflection at x of a clamped beam under a unit force at a, in L³/B."""
    if x > a:
        x, a = a, x
    return x**2 * (1 - a) ** 2 * (3 * a - x * (1 + 2 * a)) / 6


def set_down_energy(slide: float, slant: float) -> float:
    """Bending energy, in B h²/L³, of three straight strands that are set down on each other.

    A below B below C; A and B cross in their middles, C crosses both off theirs; each pair is 2h apart. Small
    deflections, forces N ≥ 0 at crossings: gaps W N ≥ 2, equal where N > 0, energy ½ N W N.
    """
    near = 0.5 - slide / math.cos(slant)
    off = slide * math.tan(slant)
    on = {"A": [(0, 0.5), (1, near)], "B": [(0, 0.5), (2, near)], "C": [(1, 0.5 - off), (2, 0.5 + off)]}
    push = {("A", 0): -1, ("B", 0): 1, ("A", 1): -1, ("C", 1): 1, ("B", 2): -1, ("C", 2): 1}
    gaps = np.zeros((3, 3))
    for strand, places in on.items():
        for i, x in places:
            for j, a in places:
                gaps[i, j] += push[strand, i] * push[strand, j] * yielding(x, a)
    root = np.linalg.cholesky(gaps)
    forces = nnls(root.T, np.linalg.solve(root, [2.0, 2.0, 2.0]))[0]
    return float(forces @ gaps @ forces / 2)


@pytest.mark.slow
def test_strands_set_down_on_each_other_bend_as_clamped_beams() -> None:
    """Soft in stretch, so that small deflections bend only; before the slide, at 40 % of the time."""
    result = moved("R3", length="20 mm", E="0.05 MPa", E_b="1 MPa", duration="600 s", frames=10)
    expected = set_down_energy(0.15, math.pi / 6) * 1e-4
    assert energies(result)[4] == pytest.approx(expected, rel=0.04)


@pytest.mark.slow
@pytest.mark.parametrize("move", ["R2", "R3"])
def test_pressing_strands_costs_the_square_of_their_slenderness(move: str) -> None:
    rise = {}
    for length, duration in (("8 mm", "200 s"), ("16 mm", "800 s")):
        found = energies(moved(move, length=length, duration=duration, frames=10))
        rise[length] = found[-1] - found[0]
    assert rise["8 mm"] / rise["16 mm"] == pytest.approx(4, rel=0.04)


# --- runs


def test_what_is_lost_on_the_way_falls_with_the_speed() -> None:
    """Between equilibria work is stored; what drag takes from it is proportional to speed."""
    lost = {}
    for duration in ("200 s", "400 s"):
        data = moved("R1", duration=duration, ends="swivel").dataset
        began = (data.sizes["time"] - 1) // 10
        lost[duration] = float(data["dissipation"][-1] - data["dissipation"][began])
    assert lost["200 s"] / lost["400 s"] == pytest.approx(2, rel=0.2)


def test_resuming_between_two_legs_changes_no_bit(tmp_path: Any) -> None:
    spec = Reidemeister(move="R3", length="8 mm", duration="20 s", frames=7)
    whole = spec.run()

    def stop(share: float, note: str) -> None:
        if share > 0.37:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        spec.run(stop, tmp_path / "r3.zarr")
    resumed = spec.run(out=tmp_path / "r3.zarr", resume=True)
    assert resumed.dataset.equals(whole.dataset)
    np.testing.assert_array_equal(
        ts.open(tmp_path / "r3.zarr").dataset["position"], whole.dataset["position"]
    )


def test_displacement_follows_the_legs() -> None:
    data = Reidemeister(move="R2", length="8 mm", duration="1 s", frames=10).run().dataset
    way = data["displacement"].values
    moved_end = data["position"].values[:, -1]
    gone = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(moved_end, axis=0), axis=1))])
    np.testing.assert_allclose(way, gone, atol=1e-8)


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({}, "move is missing; give a Reidemeister move to make"),
        ({"move": "R4"}, "move is 'R4'; choose one of R1, R2, R3"),
        ({"move": "R1", "length": "2 mm"}, "10 radii; give a length of at least 40 radii, 8 mm"),
        ({"move": "R1", "force": "1 N"}, "moves ends at a given speed, so there is no field 'force'"),
        ({"move": "R1", "knot": "reef"}, "makes the strands that it moves, so there is no field 'knot'"),
        ({"move": "R1", "ends": "free"}, "choose one of gripped, swivel"),
        ({"move": "R1", "length": "20 m"}, "more than the 100000 that a run can move"),
    ],
)
def test_bad_fields_are_refused_in_one_sentence(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(ts.TorsadeError) as caught:
        Reidemeister(**fields).configuration()
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)

"""Specifications of rods: what is refused, what is recorded, and interrupted runs that go on."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.protocols import Pendulum, SnapQuench, SnapTwist
from torsade.protocols.driving import Interrupted

SHORT = SnapTwist(twist="60 deg", duration="0.4 ms", frames=20)


@pytest.mark.parametrize(
    ("protocol", "fields", "says"),
    [
        (SnapTwist, {"twist": "270 mm"}, r"twist '270 mm' is a length, not an angle; give an angle"),
        (SnapTwist, {"edges": 51}, r"edges is 51; give an even number, so that a node lies in the middle"),
        (SnapTwist, {"min_fragment": "30 cm"}, r"min_fragment is 300 mm, more than the whole rod of 240 mm"),
        (SnapTwist, {"length": "5 mm"}, r"too thick to be a rod; give a length of at least 20 radii"),
        (SnapTwist, {"disorder": -1}, r"disorder is -1; give a number of at least 0"),
        (SnapTwist, {"lambda": "3 mm"}, r"no field 'lambda'; did you mean 'min_fragment'"),
        (SnapTwist, {"knot": "reef"}, r"takes a straight rod, so there is no field 'knot'"),
        (SnapTwist, {"criterion": "mises"}, r"criterion is 'mises'; did you mean 'von_mises'\?"),
        (SnapQuench, {"speed": 0}, r"speed is 0; give a velocity above 0 m/s"),
        (SnapQuench, {"speed": "1 m/s", "approach": "1 s"}, r"an approach of 1 s at 1000 mm/s is longer"),
        (SnapQuench, {"twist": 1}, r"snap-quench bends a rod without twist"),
        (Pendulum, {"mass": "1 mg", "mass_radius": "1 mm"}, r"moment of inertia is 5e-13 .* less than"),
        (Pendulum, {"turn": 0}, r"turn is 0; give an angle above 0 rad"),
        (Pendulum, {"angle": 1}, r"no field 'angle'; did you mean 'turn'\?"),
    ],
)
def test_unfit_specifications_are_refused_in_a_sentence(protocol: type, fields: dict, says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        protocol(**fields)


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        (SnapTwist(twist="400 deg"), r"a twist of 400 deg breaks the straight rod, .* less than 361"),
        (SnapTwist(sigma_c="1 GPa"), r"would break at a curvature of 751.9 1/m, .* give a smaller sigma_c"),
        (SnapTwist(sigma_c="1 kPa"), r"breaks all but straight, .* give a larger sigma_c"),
        (SnapTwist(step="10 us"), r"a step of 1e-05 s is not stable with edges of 4.8 mm"),
        (SnapTwist(frames=5000), r"5000 frames in 0.002057 s are .* less than a step of 1e-06 s; give fewer"),
    ],
)
def test_what_only_the_run_can_know_is_refused_there(spec: SnapTwist, says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        spec.run()


def test_young_s_modulus_is_that_of_bending_unless_that_is_given_too() -> None:
    assert SnapTwist(E="4 GPa").fiber_material.E_b == 4e9
    assert SnapTwist(E="4 GPa", E_b="3 GPa").fiber_material.E_b == 3e9
    assert SnapTwist(rho="2 g/cm^3", twist_damping=5.0).fiber_material.rho == 2000.0


def test_snap_twist_reports_what_is_asked_for() -> None:
    """Li = mu Tw/(E kappa_c L), and the elastica's end distance at zero twist: 17.595 cm at 14.2857 1/m."""
    report = SnapTwist.report(SnapTwist(duration="0.5 ms", frames=5).run())
    assert report["critical_curvature_per_m"] == pytest.approx(14.285714, rel=1e-6)
    assert report["end_distance_m"] == pytest.approx(0.17595, rel=3e-4)
    assert report["li"] == 0.0
    assert report["fragments"] == len(report["lengths_m"]) == len(report["breaks"]) + 1 == 6
    assert sum(report["lengths_m"]) == pytest.approx(0.24)
    first = report["breaks"][0]
    assert (first["time_s"], first["place_m"]) == (0.0, pytest.approx(0.12))
    assert first["stress_ratio"] == pytest.approx(1.0, abs=1e-6)
    twisted = SnapTwist.report(SnapTwist(twist="270 deg", duration="10 us", frames=1).run())
    kappa = 2 * 1.9e7 / (3.8e9 * 7e-4) * math.sqrt(1 - (270 / 361.155) ** 2)
    assert twisted["critical_curvature_per_m"] == pytest.approx(kappa, rel=1e-4)
    assert twisted["li"] == pytest.approx(1.5 * math.pi / 0.24 / 2.6 / kappa, rel=1e-4)


def test_frames_hold_the_pieces_and_their_places() -> None:
    result = SHORT.run()
    data = result.dataset
    starts = data["piece_start"].values.astype(int)
    counts = [len(np.unique(row)) - 1 for row in starts]
    assert counts[0] == 2
    assert counts == sorted(counts)
    assert counts[-1] == result.dataset.attrs["fragments"] == 6
    last = data["position"].values[-1]
    pieces = [last[i:j] for i, j in zip(starts[-1][:-1], starts[-1][1:], strict=True) if j > i]
    lengths = [np.linalg.norm(np.diff(x, axis=0), axis=1).sum() for x in pieces]
    np.testing.assert_allclose(lengths, data.attrs["lengths_m"], rtol=1e-5)
    assert np.isnan(last[starts[-1][-1] :]).all()
    assert data["energy_released"].values[-1] > 0


def test_frames_change_nothing(tmp_path: Path) -> None:
    """Steps all have one length, whatever is looked at on the way."""
    few, many = (SHORT.model_copy(update={"frames": n}).run() for n in (1, 37))
    assert few.dataset.attrs["break_times_s"] == many.dataset.attrs["break_times_s"]
    assert np.array_equal(few.dataset["position"][-1], many.dataset["position"][-1], equal_nan=True)


@pytest.mark.parametrize(
    "spec",
    [SHORT, SnapQuench(speed="0.5 m/s", approach="0.5 ms", after="0.4 ms", frames=40, disorder=0.02)],
    ids=["snap-twist", "snap-quench"],
)
def test_an_interrupted_run_goes_on_to_the_same_bits(spec: SnapTwist, tmp_path: Path) -> None:
    whole = spec.run(out=tmp_path / "whole.zarr")
    seen = []

    def stop(share: float, note: str) -> None:
        seen.append(share)
        if len(seen) == 14:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        spec.run(stop, out=tmp_path / "cut.zarr")
    resumed = spec.run(out=tmp_path / "cut.zarr", resume=True)
    for name, values in whole.dataset.variables.items():
        assert np.array_equal(values, resumed.dataset[name], equal_nan=True), name
    for name in ("break_times_s", "break_places_m", "lengths_m", "fragments", "steps"):
        assert whole.dataset.attrs[name] == resumed.dataset.attrs[name], name
    assert ts.open(tmp_path / "cut.zarr").dataset.attrs["fragments"] == whole.dataset.attrs["fragments"]


@pytest.mark.parametrize("speed", ["3 mm/s", "500 mm/s"])
def test_a_quench_starts_on_its_way_and_breaks_where_it_would_if_bent_slowly(speed: str) -> None:
    """Speed hardly changes the limit curvature (thesis Fig 3-7C): inertia adds less than 1e-4 here."""
    spec = SnapQuench(speed=speed, approach="5 ms", after="0.5 ms", frames=10)
    report = SnapQuench.report(spec.run())
    assert report["critical_curvature_per_m"] == pytest.approx(14.285714, rel=1e-4)
    assert report["breaks"][0]["time_s"] == pytest.approx(5e-3, rel=1e-2)
    assert report["fragments"] == 6


@pytest.mark.parametrize("speed", ["3 m/s", "5 m/s", "10 m/s"])
def test_a_quench_that_begins_nearly_straight_bends_to_one_side(speed: str) -> None:
    """Its ends are up to 99.9 % of the length apart, and near each other at the speed given."""
    spec = SnapQuench(speed=speed)
    cascade = spec.driven()
    x, v = cascade.motion.state.x, cascade.motion.state.v
    assert x[:, 1].min() >= -1e-12
    assert x[25, 1] > 1e-3
    assert v[0, 0] - v[-1, 0] == pytest.approx(spec.speed, rel=1e-3)
    assert v[25, 1] > spec.speed


def test_the_least_fragment_falls_with_speed_where_that_is_asked_for() -> None:
    law = {"fragment_law": "quarter-power"}
    assert SnapQuench(speed="3 mm/s", **law).least_fragment == pytest.approx(0.03)
    assert SnapQuench(speed="48 mm/s", **law).least_fragment == pytest.approx(0.015)
    assert SnapQuench(speed="500 mm/s", **law).least_fragment == 0.01
    assert SnapQuench(speed="500 mm/s").least_fragment == 0.03


def test_a_pendulum_tells_the_modulus_and_the_damping_of_its_rod() -> None:
    """omega^2 = mu J/(L I_0), and decay 2 b rho I L/(3 I_0): drag along the rod, a third of it at the bob."""
    spec = Pendulum(duration="0.4 s", frames=50)
    report = Pendulum.report(spec.run())
    rod = spec.fiber_material
    omega = math.sqrt(spec.stiffness / spec.moment)
    assert report["frequency_Hz"] == pytest.approx(omega / (2 * math.pi), rel=1e-3)
    rate = 2 * rod.twist_damping * rod.rho * spec.section.I * 0.24 / 3 / spec.moment
    assert report["decay_per_s"] == pytest.approx(rate, rel=1e-2)
    assert report["mu_Pa"] == pytest.approx(rod.mu, rel=1e-3)
    assert report["twist_damping_per_s"] == pytest.approx(rod.twist_damping, rel=1e-2)
    free = Pendulum.report(Pendulum(twist_damping=0.0, duration="0.4 s", frames=50).run())
    assert abs(free["decay_per_s"]) < 1e-3

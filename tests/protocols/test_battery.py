"""Batteries: what is refused, what is recorded, what is conserved, and interrupted runs that go on."""

from __future__ import annotations

import itertools
import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade import places
from torsade.observables import hinge_twist
from torsade.protocols import Battery, discharge
from torsade.protocols.battery import KINDS
from torsade.protocols.charging import trembled
from torsade.protocols.discharge import crossing_losses, discharge_times, hinge_to_cut, mean_on_the_way
from torsade.protocols.driving import Interrupted

SHORT = Battery(knot="4_1", twist=1.0, nodes=60, charging="0.3 s", duration="0.3 s", frames=12)


@pytest.fixture(scope="module")
def short():
    return SHORT.run()


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({}, r"knot is missing; give a closed knot by name or code"),
        ({"knot": "reef"}, r"'reef' is a bend, and one closed strand is wanted; give a knot such as 4_1"),
        ({"knot": "3_9"}, r"no knot or link is called '3_9'"),
        ({"knot": "4_1", "twist": "90 deg"}, r"twist '90 deg' is an angle, not a number"),
        ({"knot": "4_1", "twist": 11}, r"twist is 11; give a number of at most 10"),
        ({"knot": "4_1", "cut_at": 1}, r"cut_at is 1; give a number below 1"),
        ({"knot": "4_1", "stop": "charged", "cut_at": 0.5}, r"nothing is cut, so cut_at means nothing"),
        ({"knot": "4_1", "stop": "uncut"}, r"stop is 'uncut'; .*choose one of discharged, charged"),
        ({"knot": "4_1", "uncut": True}, r"there is no field 'uncut'; give 'stop', with the value charged"),
        ({"knot": "4_1", "length": "1 cm"}, r"no field 'length'; give 'slenderness', L/h"),
        ({"knot": "4_1", "material": "spaghetti"}, r"material 'spaghetti' has no viscosity"),
        ({"knot": "4_1", "nodes": True}, r"nodes is True; give a whole number"),
        ({"knot": "4_1", "eta_f_ratio": 0}, r"eta_f_ratio is 0; give a number above 0"),
    ],
)
def test_unfit_specifications_are_refused_in_a_sentence(fields: dict, says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        Battery(**fields)


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        (
            {"knot": "7_1", "slenderness": 30},
            r"stretched by 105 %; give a slenderness of at least 41",
        ),
        (
            {"knot": "4_1", "nodes": 20},
            r"20 nodes are 2\.5 radii apart, .* give at least 34 nodes",
        ),
        ({"knot": "4_1", "frames": 1_000_000}, r"1000001 frames of 101 nodes take .* give at most"),
    ],
)
def test_what_only_the_run_can_know_is_refused_there(fields: dict, says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        Battery(**fields).run()


def test_units_are_those_of_the_thesis() -> None:
    """T_0 = 2 L eta/(h E_b), E_0 = E_b h^2 L; silicone: nu = 0.3, E/E_b = 5, eta = 10 kPa s, E_b = 10 MPa."""
    spec = Battery(knot="4_1")
    material = spec.fiber_material
    assert (material.nu, material.E / material.E_b, material.eta, material.E_b) == (0.3, 5.0, 1e4, 1e7)
    assert spec.unit_time == pytest.approx(0.1)
    assert spec.unit_energy == pytest.approx(1e7 * 4e-8 * 0.01)
    assert (spec.laws.eta_f_ratio, spec.laws.torque, spec.node_count) == (0.1, False, 100)


def test_twist_energy_at_the_start_is_that_of_even_twist(short) -> None:
    """pi/(8 (1 + nu)) (h theta')^2 E_0 (ERRATA, chapter 5), and Tw = h theta' L/(2 pi h)."""
    data = short.dataset
    share = float(data["charge_energy_twist"][0]) / data.attrs["E0_J"]
    assert share == pytest.approx(math.pi / (8 * 1.3), rel=1e-12)
    assert float(data["charge_twist"][0]) == pytest.approx(50 / (2 * math.pi), rel=1e-12)


def test_link_and_knot_are_kept_while_the_fiber_is_closed(short) -> None:
    """Lk = Tw + Wr is no whole number, and constant to round-off."""
    data = short.dataset
    link = data["charge_link"].values
    assert abs(link[0] - round(link[0])) > 0.01
    assert np.abs(link - link[0]).max() < 1e-6
    assert data.attrs["link_error"] == np.abs(link - link[0]).max()
    assert set(data.attrs["charge_knots"]) == {"4_1"}
    assert data.attrs["knot_kept"] is True
    assert len(data.attrs["charge_knots"]) == data.sizes["charge"]


def test_energy_never_grows_and_goes_into_drag(short) -> None:
    """Work against drag is the energy released, to the tolerance of the steps."""
    data = short.dataset
    parts = ("bend", "twist", "stretch", "contact")
    for before in ("", "charge_"):
        energy = sum(data[f"{before}energy_{kind}"].values for kind in parts)
        assert (np.diff(energy) < 1e-9 * energy[0]).all()
    energy, lost = data["sample_energy"].values, data["sample_dissipation"].values
    np.testing.assert_allclose(energy[0] - energy, lost, atol=2e-3 * energy[0])
    assert data.attrs["balance_error"] < 2e-3


def test_the_cut_takes_the_energy_of_one_hinge(short) -> None:
    """All that is stored in stretch and contact stays; bend and twist of one hinge go."""
    data = short.dataset
    for kind in ("stretch", "contact"):
        before, after = float(data[f"charge_energy_{kind}"][-1]), float(data[f"energy_{kind}"][0])
        assert after == pytest.approx(before, rel=1e-12)
    for kind in ("bend", "twist"):
        before, after = float(data[f"charge_energy_{kind}"][-1]), float(data[f"energy_{kind}"][0])
        assert 0 < before - after < 0.1 * before


def test_energy_along_the_fiber_adds_up(short) -> None:
    """The density, times the lengths of nodes, is all energy but that of contact."""
    data = short.dataset
    length = np.full(60, 0.01 / 60)
    whole = sum(float(data[f"charge_energy_{kind}"][-1]) for kind in ("bend", "twist", "stretch"))
    assert data["charge_energy_density"].values[-1] @ length == pytest.approx(whole, rel=1e-5)
    open_length = np.r_[0.5, np.ones(59), 0.5] * 0.01 / 60
    whole = sum(float(data[f"energy_{kind}"][0]) for kind in ("bend", "twist", "stretch"))
    assert data["energy_density"].values[0] @ open_length == pytest.approx(whole, rel=1e-5)


def test_it_is_cut_where_asked() -> None:
    """At the node nearest to that share of its length, which is where the open fiber begins and ends."""
    spec = SHORT.model_copy(update={"cut_at": 0.26, "charging": 1e-4, "duration": 1e-5, "frames": 1})
    data = spec.run().dataset
    assert data.attrs["cut_at"] == pytest.approx(16 / 60)
    x = data["position"].values[0]
    np.testing.assert_array_equal(x[0], x[-1])
    np.testing.assert_array_equal(x[:-1], np.roll(data["charge_position"].values[-1], -16, axis=0))


def test_it_is_cut_where_the_stress_is_largest() -> None:
    """√((|E ε| + E_b h κ)² + 3 (μ h θ')²), here from nodes and angles; of many as large the first counts."""
    spec = SHORT.model_copy(update={"charging": 1e-2, "duration": 1e-5, "frames": 1})
    motion, _ = spec.charged()
    material, h, x = spec.fiber_material, spec.h, motion.state.x
    e, l = np.roll(x, -1, axis=0) - x, spec.fiber_length / 60
    size = np.linalg.norm(e, axis=1)
    t = e / size[:, None]
    before, mean = np.roll(t, 1, axis=0), 0.5 * (size + np.roll(size, 1))
    half = 0.5 * np.arctan2(np.linalg.norm(np.cross(before, t), axis=1), (before * t).sum(axis=1))
    normal = material.E * np.abs(mean / l - 1) + material.E_b * h * 2 * np.tan(half) / mean
    theta_prime = hinge_twist(motion.assembly, motion.state) / l
    stress = np.hypot(normal, math.sqrt(3) * material.mu * h * theta_prime)
    assert np.ptp(stress) > 0.1 * stress.max()
    assert spec.run().dataset.attrs["cut_at"] == pytest.approx(int(np.argmax(stress)) / 60)
    even = Battery(knot="unknot", nodes=60, noise=0, twist=0.1)
    assembly, state = even.tied()
    assert hinge_to_cut(assembly, state, material, h) == 0


@pytest.mark.slow
@pytest.mark.parametrize(("knot", "twist"), [("3_1", 0.0), ("7_4", 1.0), ("6_2", -4.0)])
def test_strands_that_hardly_moved_keep_the_name_they_would_get(
    knot: str, twist: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Named anew in every frame or when a node has moved by 0.1 h, a strand is the same knots."""
    spec = Battery(knot=knot, twist=twist)
    named = discharge.name_open
    asked: list[None] = []
    monkeypatch.setattr(discharge, "name_open", lambda *given: asked.append(None) or named(*given))
    sooner = spec.run().dataset.attrs["frame_knots"]
    few = len(asked)
    monkeypatch.setattr(discharge, "HARDLY", 0.0)
    assert spec.run().dataset.attrs["frame_knots"] == sooner
    assert len(asked) - few > few


def test_every_number_is_explained(short) -> None:
    """The table of keys on the page is that of `--json`."""
    page = (Path(__file__).parents[2] / "docs" / "batteries.md").read_text(encoding="utf-8")
    rows = page.split("| key | meaning |")[1].split("\n\n")[0].splitlines()[2:]
    keys = [key for row in rows for key in re.findall(r"`(\w+)`", row.split(" | ")[0])]
    assert sorted(keys) == sorted(Battery.report(short))


def test_charged_is_where_it_stops() -> None:
    spec = Battery(knot="unknot", nodes=60, stop="charged", charging="0.1 s")
    result = spec.run()
    report = Battery.report(result)
    assert result.frames == 1
    assert set(report["discharge_time_T0"].values()) == {None}
    assert report["writhe"] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("stop", ["charged", "discharged"])
def test_the_energy_of_a_battery_is_that_of_the_closed_fiber(stop: str) -> None:
    """With the hinge that is cut through, to the bit, as link, twist and writhe are; wherever it is cut."""
    spec = Battery(knot="3_1", twist=2.0, nodes=60, charging="0.1 s", duration="1 ms", frames=4)
    if stop == "charged":
        spec = Battery(**{**spec.stored(), "stop": stop, "duration": None})
    result = spec.run()
    data, report = result.dataset, Battery.report(result)
    energies = {kind: float(data[f"charge_energy_{kind}"][-1]) / report["E0_J"] for kind in KINDS}
    assert report["energy_E0"] == energies | {"total": sum(energies.values())}
    for name in ("link", "twist", "writhe"):
        assert report[name] == data[f"charge_{name}"][-1]
    if stop == "charged":
        assert report["energy_final_E0"] == report["energy_E0"]["total"]


def test_a_trefoil_is_untied() -> None:
    """Cut, it loses its three crossings and its knot, and all but a thousandth of its energy."""
    report = Battery.report(Battery(knot="m3_1", twist=-3.0, nodes=80).run())
    assert [row["knot"] for row in report["knots"]] == ["m3_1", "0_1"]
    times = report["discharge_time_T0"]
    assert 0 < times["50"] < times["10"] < times["1"]
    assert report["energy_final_E0"] < 1e-3 * report["energy_E0"]["total"]
    assert len(report["crossings_lost_T0"]) >= 3
    assert report["crossings_lost_T0"] == sorted(report["crossings_lost_T0"])
    json.dumps(report, allow_nan=False)


def test_a_mirror_image_does_as_the_mirror_image() -> None:
    """m5_2 at -1 is 5_2 at 1 seen in a mirror, noise and all, but for what errors of the solver grow to."""
    changes = ({"knot": "5_2"}, {"knot": "m5_2", "twist": -1.0})
    specs = [SHORT.model_copy(update=c) for c in changes]
    first, second = (spec.tied()[1].x for spec in specs)
    np.testing.assert_array_equal(first, second * [1, 1, -1])
    right, left = (spec.run().dataset for spec in specs)
    for name in ("energy_bend", "energy_twist"):
        np.testing.assert_allclose(right[name][:6], left[name][:6], rtol=1e-5)
        np.testing.assert_allclose(right[name], left[name], rtol=3e-3, atol=1e-6 * float(right[name][0]))
    np.testing.assert_allclose(right["writhe"], -left["writhe"], atol=3e-3)


def test_an_interrupted_run_goes_on_to_the_same_bits(tmp_path: Path) -> None:
    whole = SHORT.run(out=tmp_path / "whole.zarr")
    calls = itertools.count()

    def stop(share: float, note: str) -> None:
        if note.startswith("t = ") and next(calls) == 60:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        SHORT.run(stop, out=tmp_path / "cut.zarr")
    assert (tmp_path / "cut.zarr.part").is_dir()
    resumed = SHORT.run(out=tmp_path / "cut.zarr", resume=True)
    for name, values in whole.dataset.variables.items():
        assert np.array_equal(values, resumed.dataset[name], equal_nan=True), name
    for name, value in whole.dataset.attrs.items():
        if name not in ("created", "wall_s", "resumed"):
            assert resumed.dataset.attrs[name] == value, name


@pytest.mark.parametrize("before", [True, False])
def test_a_discharge_goes_on_to_the_same_bits(before: bool) -> None:
    """Before its ends have come apart and after, when they may touch."""
    spec = Battery(knot="3_1", twist=3.0, nodes=60, charging="0.05 s", duration="10 ms", frames=12)
    whole, again = (spec.trial() for _ in range(2))
    times = iter(np.geomspace(1e-5, 1e-2, 30).tolist())
    met = [bool(whole.motion.saved()["apart"])]
    while len(met) < 2 or met[-1] == before:
        whole.motion.advance(next(times))
        whole.frame()
        met.append(bool(whole.motion.saved()["apart"]))
    again.motion.recover(whole.motion.saved())
    assert again.motion.knots == whole.motion.knots
    for t in times:
        for trial in (whole, again):
            trial.motion.advance(t)
            trial.frame()
    found, expected = again.motion.saved(), whole.motion.saved()
    assert expected["apart"]
    for name, values in expected.items():
        np.testing.assert_array_equal(found[name], values, err_msg=name)
    for name in ("named", "x"):
        with pytest.raises(ValueError, match=name):
            again.motion.recover(expected | {name: expected[name][1:]})


def test_discharge_times_are_read_between_samples_for_good() -> None:
    """Of exp(-t) sampled coarsely, exactly; a rise above the share puts it off; None if not reached."""
    t = np.linspace(0.0, 3.0, 7)
    found = discharge_times(t, np.exp(-t), [0.5, 0.1, 0.01])
    assert found[0] == pytest.approx(math.log(2))
    assert found[1] == pytest.approx(math.log(10))
    assert found[2] is None
    assert discharge_times(np.arange(4.0), np.array([1.0, 0.4, 0.6, 0.1]), [0.5])[0] > 2


def test_crossings_are_lost_when_they_never_come_back() -> None:
    crossings = np.array([4, 3, 4, 2, 2, 0, 0])
    assert crossing_losses(np.arange(7.0), crossings) == [3.0, 3.0, 5.0, 5.0]
    assert crossing_losses(np.arange(3.0), np.array([2, 2, 1])) == [2.0]


def test_noise_is_the_same_curve_at_every_number_of_nodes() -> None:
    """Its root mean square is the size given; nodes of half as many lie where every other one does."""
    coarse, fine = (trembled(np.zeros((n, 3)), 0.01, 3) for n in (40, 80))
    np.testing.assert_allclose(fine[::2], coarse, atol=1e-15)
    assert math.sqrt((coarse**2).sum(axis=1).mean()) == pytest.approx(0.01)
    assert not np.allclose(coarse, trembled(np.zeros((40, 3)), 0.01, 4))


def test_another_knot_in_any_frame_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """The knot asked for is meant, by whatever name or code: m4_1 is 4_1."""
    from torsade.protocols import charging

    spec = SHORT.model_copy(update={"knot": "m4_1", "charging": 1e-3, "duration": 1e-4, "frames": 1})
    assert Battery.report(spec.run())["knot_kept"]
    named = charging._knot
    said = iter(["4_1", "3_1"])
    monkeypatch.setattr(charging, "_knot", lambda x: next(said, named(x)))
    assert not Battery.report(spec.run())["knot_kept"]


def test_means_on_the_way_do_not_know_how_long_it_takes() -> None:
    """Of ln(E_0/E) between a half and a hundredth, the middle; at any pace; None where it is not reached."""
    t = np.linspace(0.0, 6.0, 4001)
    middle = 0.5 * (math.log(2) + math.log(100))
    for energy in (np.exp(-t), np.exp(-0.5 * t - 0.05 * t**2)):
        found = mean_on_the_way(energy, -np.log(energy), (0.5, 0.01))
        reached = energy[-1] <= 0.01
        assert found == (pytest.approx(middle, rel=1e-2) if reached else None)
    assert mean_on_the_way(np.exp(-t[:1000]), t[:1000], (0.5, 0.01)) is None


def test_ctrl_c_while_it_is_charged_says_so(short: ts.Result, tmp_path: Path) -> None:
    """Nothing of it is kept; what an earlier run left stays, and is gone on with by the same command."""

    def stop(wanted: str, share: float = 0.0) -> Callable[[float, str], None]:
        def look(done: float, note: str) -> None:
            if note.startswith(wanted) and done > share:
                raise KeyboardInterrupt

        return look

    out = tmp_path / "run.zarr"
    charged = "interrupted while the battery was charged, which is always done anew; "
    with pytest.raises(Interrupted, match=f"^{charged}nothing is saved$"):
        SHORT.run(stop("charging"), out)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(Interrupted, match="are saved"):
        SHORT.run(stop("t =", 0.5), out)
    with pytest.raises(Interrupted, match=f"^{charged}'{places.part_of(out)}' is as it was$"):
        SHORT.run(stop("charging"), out, resume=True)
    assert SHORT.run(out=out, resume=True).dataset["position"].equals(short.dataset["position"])

"""The suture protocol: what it takes, what its numbers mean, and how the strand is laid on the skin."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.errors import TorsadeError
from torsade.motion.moving import Outcome
from torsade.protocols import Suture
from torsade.protocols.wound import DEPTH

CONTRACT = {"crossings", "writhe", "tau", "z_displacement_m", "gap_m", "skin_force_N"}


@pytest.fixture(scope="module")
def result(stored: Callable[[str], Path]) -> ts.Result:
    return ts.open(stored("suture"))


@pytest.mark.parametrize(
    ("given", "meant"), [("3,-3", (3, -3)), (" +5 , 3 ", (5, 3)), ("3,−3", (3, -3)), ("-15,1", (-15, 1))]
)
def test_throws_are_read(given: str, meant: tuple[int, int]) -> None:
    spec = Suture(throws=given)
    assert spec.turns == meant
    assert spec.throws == "{},{}".format(*meant)


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"throws": "0"}, "two numbers"),
        ({"throws": "3,,"}, "two numbers"),
        ({"throws": "2.5"}, "two numbers"),
        ({"throws": "a"}, "two numbers"),
        ({"throws": "3,-3,3"}, "two numbers"),
        ({"throws": "0,3"}, "odd number"),
        ({"throws": "3,-4"}, "odd number"),
        ({"throws": "99,99"}, "15 at most"),
        ({"throws": "3,-17"}, "15 at most"),
        ({"throws": "3,-3", "skin_stiffness": -1}, "skin_stiffness"),
        ({"throws": "3,-3", "skin_relaxation": 0}, "skin_relaxation"),
        ({"throws": "3,-3", "gap": float("nan")}, "gap"),
        ({"throws": "3,-3", "gap": 0}, "gap"),
        ({"throws": "3,-3", "angle": "100 deg"}, "angle"),
        ({"throws": "3,-3", "skin_radius": "0.9 mm"}, "at least 5 radii"),
        ({"throws": "3,-3", "force": 1.0}, "stretch"),
        ({"throws": "3,-3", "knot": "reef"}, "throws"),
        ({"throws": "3,-3", "stiffness": 3}, "skin_stiffness"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_sentence(fields: dict[str, object], said: str) -> None:
    with pytest.raises(TorsadeError, match=said) as refused:
        Suture(**fields)
    assert "\n" not in str(refused.value)


def test_a_wound_narrower_than_the_fiber_is_sutured() -> None:
    """The loop lies around both sides, and no part of the fiber between them."""
    spec = Suture(throws="3,-3", gap="0.1 mm")
    assert spec.rest_gap < 2 * spec.h
    stitch = spec.stitch()
    apart = np.linalg.norm((stitch.strand[:, None] - stitch.cylinders)[..., :2], axis=2)
    assert apart.min() > spec.h_s + spec.h


@pytest.mark.parametrize(("duration", "release", "frames"), [(1.0, 0.0, 10), (1.0, 0.3, 8), (0.01, 5.0, 2)])
def test_a_frame_is_taken_at_the_end_of_the_pull(duration: float, release: float, frames: int) -> None:
    spec = Suture(throws="3,-3", duration=duration, release=release, frames=frames)
    times = spec.frame_times()
    assert len(times) == frames + 1
    assert np.all(np.diff(times) > 0)
    assert times[-1] == pytest.approx(duration + release)
    assert times[spec.last_pulled(times)] == pytest.approx(duration)


def test_numbers_are_those_of_the_end_of_the_pull(result: ts.Result) -> None:
    """Each from what is recorded: (w - w_0) along z, the distance of the sides, and sums along the loop."""
    report, data = result.report(), result.dataset
    assert set(report) >= CONTRACT
    assert (report["crossings"], report["writhe"], report["tau"]) == (6, 0, 1.0)
    at = int(np.argmin(np.abs(data["time"].values - 0.04)))
    assert data["time"].values[at] < data["time"].values[-1]
    w, h_s = data["skin_position"].values, 1e-3
    z = (w[at] - w[0])[:, 2]
    found = report["z_displacement_m"]
    assert (found["a"], found["b"], found["relative"]) == (z[0], z[1], abs(z[0] - z[1]))
    across = np.hypot(*(w[at, 1] - w[at, 0])[:2])
    assert report["gap_m"] == pytest.approx(across - 2 * h_s, rel=1e-9)
    assert report["gaps_m"][0] == pytest.approx(1e-3, rel=1e-9)
    l = np.linalg.norm(np.diff(Suture(**result.spec).stitch().strand, axis=0), axis=1)
    normal, around, along = (data[f"skin_{kind}"].values[at] for kind in ("normal", "around", "along"))
    force = report["skin_force_N"]
    assert force["normal"] == pytest.approx(normal @ l, rel=1e-5)
    assert force["shear"] == pytest.approx(np.hypot(around, along) @ l, rel=1e-5)
    assert force["along_z"] == pytest.approx(along @ l, rel=1e-5, abs=1e-9)
    assert np.array(force["spring"]) == pytest.approx(-20.0 * (w[at] - w[0]), rel=1e-6, abs=1e-12)
    assert report["gap_after_release_m"] == data["gap"].values[-1]


def test_densities_along_the_loop_add_up_to_the_force(result: ts.Result) -> None:
    """Normal and shear, turned back to x and y where the edge lies, sum to the force on each side."""
    data = result.dataset
    x, w = data["position"].values[-1].astype(float), data["skin_position"].values[-1]
    l = np.linalg.norm(np.diff(Suture(**result.spec).stitch().strand, axis=0), axis=1)
    inward = w[:, None, :2] - (0.5 * (x[1:] + x[:-1]))[None, :, :2]
    inward /= np.linalg.norm(inward, axis=2, keepdims=True)
    counterclockwise = np.stack([inward[..., 1], -inward[..., 0]], axis=2)  # as seen from +z
    normal, around = data["skin_normal"].values[-1], data["skin_around"].values[-1]
    across = normal[..., None] * inward + around[..., None] * counterclockwise
    total = np.einsum("sec,e->sc", across, l)
    assert np.abs(total).max() > 1e-4
    assert total == pytest.approx(data["skin_force"].values[-1, :, :2], rel=1e-4, abs=1e-8)


def test_speeds_and_peaks_are_concluded_from_samples() -> None:
    """Ends that run out steadily at v each: c_f = F 2h/(eta A v); the largest z with its sign; when shut."""
    spec = Suture(throws="3,-3", duration=1.0)
    t, v = np.linspace(0, 1, 101), 2e-4
    z = 1e-5 * np.sin(2 * np.pi * t) * (1 - 0.5 * t)
    history = {"time": t, "gap": 1e-3 * (1 - 2 * t), "drawn": 2 * v * t, "z_a": -z, "z_b": 0.5 * z}
    numbers = spec.trial().conclude(history, None)
    peak = -z[np.argmax(np.abs(z))]
    assert numbers["z_peak_m"] == {"a": peak, "b": -0.5 * peak, "relative": 1.5 * abs(peak)}
    assert numbers["closed_at_s"] == pytest.approx(0.5)
    assert numbers["slip_speed_m_per_s"] == pytest.approx(v)
    A = np.pi * spec.h**2
    assert numbers["c_f"] == pytest.approx(0.01 * 2 * spec.h / (spec.fiber_material.eta * A * v))
    open_still = spec.trial().conclude(history | {"gap": 1e-3 * (2 - t), "drawn": -t}, None)
    assert "closed_at_s" not in open_still
    assert "c_f" not in open_still


def test_a_strand_pulled_away_is_laid_on_the_skin_and_no_farther() -> None:
    """Moved along y until its first edge lies `DEPTH` deep; past the skin there is nothing to hold it."""
    spec = Suture(throws="3,-3")
    trial = spec.trial()
    state = trial.motion.state
    before = state.x.copy()
    assert trial.catch(1.0) is Outcome.PAUSED
    moved = state.x - before
    n = len(moved) - 2
    assert np.ptp(moved[:n], axis=0).max() < 1e-15
    assert moved[0, 1] > 0
    assert not moved[:, [0, 2]].any()
    assert not moved[n:].any()
    middle = 0.5 * (state.x[1:n] + state.x[: n - 1])
    apart = np.linalg.norm((middle[:, None] - state.x[n:])[..., :2], axis=2)
    assert apart.min() == pytest.approx(spec.h_s + spec.h * (1 - 2 * DEPTH), rel=1e-9)
    state.x[:n, 1] += 1.0
    assert trial.catch(1.0) is None


@pytest.mark.parametrize("change", [{"z_peak_m": 3}, {"z_peak_m": {"a": 1.0}}, {"c_f": "much"}])
def test_numbers_that_are_damaged_are_refused(result: ts.Result, change: dict[str, object]) -> None:
    damaged = ts.Result(result.dataset.assign_attrs(change))
    with pytest.raises(TorsadeError, match="cannot be read"):
        damaged.report()


@pytest.mark.parametrize(
    ("name", "throws"), [("reef", "3,-3"), ("Surgeon's knot", "5,-3"), ("surgeon", "5,-3"), ("granny", "3,3")]
)
def test_throws_may_be_given_by_name(name: str, throws: str) -> None:
    assert Suture(throws=name) == Suture(throws=throws)

"""The knot turns about the pull: mirror images turn the other way, and a symmetric knot hardly at all."""

from __future__ import annotations

import numpy as np
import pytest

import torsade as ts
from torsade.observables import integral
from torsade.protocols import PrisonEscape


def run(knot: str, pulled: str = "A1B1") -> ts.Result:
    return PrisonEscape(knot=knot, pulled=pulled, duration="0.2 s", frames=40).run()


@pytest.fixture(scope="module")
def granny() -> ts.Result:
    return run("granny")


def total(result: ts.Result) -> np.ndarray:
    """Self-torque of both strands [N m] about the way to their gripped ends, in every frame."""
    data = result.dataset
    x, start = data["position"].values[0].astype(float), data["node_start"].values
    signs = [1.0 if end == "1" else -1.0 for end in data.attrs["pulled"][1::2]]
    strands = zip(np.split(x, start[1:-1]), signs, strict=True)
    cut = [sign * np.linalg.norm(np.diff(s, axis=0), axis=1) for s, sign in strands]
    return np.asarray(data["self_torque"].values @ np.concatenate(cut))


def test_the_mirror_image_turns_the_other_way() -> None:
    """The thief, which turns most; to the tolerance of the steps, since those of the two differ."""
    one, other = run("reef", "A1B0"), run("mirror reef", "A1B0")
    x, y = (result.dataset["position"].values for result in (one, other))
    np.testing.assert_allclose(y, x * [1, 1, -1], atol=0.05 * one.dataset.attrs["radius"])
    turned, back = (result.dataset["rotation"].values for result in (one, other))
    assert abs(turned[-1]) > 1.0
    np.testing.assert_allclose(back, -turned, atol=0.02 * abs(turned).max())


def test_the_mirror_image_twists_itself_the_other_way(granny: ts.Result) -> None:
    other = run("mirror granny")
    np.testing.assert_allclose(total(other)[10:], -total(granny)[10:], rtol=0.02)


def test_the_granny_twists_itself_and_the_reef_hardly_does(granny: ts.Result) -> None:
    """Thesis 4.4: all crossings of the granny have one sign, those of the reef cancel."""
    reef = run("reef")
    assert abs(total(granny)[-10:].mean()) > 5 * abs(total(reef)[-10:].mean())
    assert (
        np.sign(total(granny)[-10:]).tolist()
        == [np.sign(ts.topology.state(ts.knots.bend("granny")).writhe)] * 10
    )
    assert abs(reef.dataset["rotation"]).max() < abs(granny.dataset["rotation"]).max()


def test_rotation_is_the_integral_of_its_rate(granny: ts.Result) -> None:
    data = granny.dataset
    np.testing.assert_allclose(data["rotation"], integral(data["time"], data["rotation_rate"]))
    np.testing.assert_allclose(integral([0, 1, 3], [0, 2, 4]), [0, 1, 7])
    assert PrisonEscape.report(granny)["rotation_rad"] == data["rotation"].values.tolist()


def test_velocities_are_those_that_positions_change_by() -> None:
    """Trapezoidal rule over 32 frames, to the tolerance of the steps; those of other frames are not."""
    data = PrisonEscape(knot="reef", duration="50 ms", frames=800).run().dataset
    x, v = data["position"].values.astype(float), data["velocity"].values.astype(float)
    moved = x[672] - x[640]

    def error(first: int) -> float:
        mean = 0.5 * (v[first : first + 32] + v[first + 1 : first + 33])
        missed = moved - data["time"].values[32] * mean.mean(axis=0)
        return float(np.abs(missed).max() / np.abs(moved).max())

    assert not v[0].any()
    assert error(640) < 0.015
    assert error(540) > 4 * error(640)

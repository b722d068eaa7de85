"""Fits find what data were made of, and their intervals hold as often as they say."""

import numpy as np
import pytest
from scipy import stats

from torsade.errors import TorsadeError
from torsade.fracture.fits import power_law, saturation
from torsade.fracture.theory.quench import fracture_sites, fragment_length

SPEEDS = 1e-3 * np.array([1, 2, 3, 5, 10, 20, 50, 100, 200, 300, 400, 500])
"""The thesis's twelve speeds [m/s]."""


def test_power_law_without_noise() -> None:
    fit = power_law(SPEEDS, fragment_length(SPEEDS, 0.04, at=1e-3))
    assert fit.parameters["exponent"].value == pytest.approx(-0.25, abs=1e-12)
    assert fit.parameters["amplitude"].value == pytest.approx(0.04 * 1e-3**0.25, rel=1e-12)


def test_saturation_without_noise() -> None:
    fit = saturation(SPEEDS, 4.5 * fracture_sites(SPEEDS, 1e-3))
    assert fit.parameters["limit"].value == pytest.approx(4.5, rel=1e-6)
    assert fit.parameters["B_squared"].value == pytest.approx(1e-3, rel=1e-5)


def test_power_law_is_linear_regression() -> None:
    generator = np.random.default_rng(1)
    y = SPEEDS**0.25 * np.exp(generator.normal(0, 0.2, len(SPEEDS)))
    fit = power_law(SPEEDS, y)
    line = stats.linregress(np.log(SPEEDS), np.log(y))
    assert fit.parameters["exponent"].value == pytest.approx(line.slope)
    assert fit.parameters["exponent"].error == pytest.approx(line.stderr)
    assert fit.parameters["amplitude"].value == pytest.approx(np.exp(line.intercept))


def test_weights_are_as_if_points_were_repeated() -> None:
    """Half the error weighs as four equal points do."""
    v, y = np.array([1.0, 2.0, 4.0, 8.0]), np.array([1.0, 1.3, 1.4, 1.9])
    once = power_law(v, y, error=y * np.array([1.0, 0.5, 1.0, 1.0]))
    repeated = power_law(np.repeat(v, [1, 4, 1, 1]), np.repeat(y, [1, 4, 1, 1]))
    assert once.parameters["exponent"].value == pytest.approx(repeated.parameters["exponent"].value)


@pytest.mark.parametrize("curve", ["power", "saturation"])
def test_intervals_hold_as_often_as_they_say(curve: str) -> None:
    """95 % of 400 noisy sets; binomial scatter allows 92.5 to 97.5 %."""
    generator = np.random.default_rng(11)
    inside = 0
    for _ in range(400):
        if curve == "power":
            y = SPEEDS**-0.25 * np.exp(generator.normal(0, 0.1, len(SPEEDS)))
            p, true = power_law(SPEEDS, y).parameters["exponent"], -0.25
        else:
            y = 4 * fracture_sites(SPEEDS, 1e-3) + generator.normal(0, 0.08, len(SPEEDS))
            p, true = saturation(SPEEDS, y).parameters["B_squared"], 1e-3
        inside += p.low <= true <= p.high
    assert 370 <= inside <= 390


def test_what_cannot_be_fitted_gets_a_sentence() -> None:
    with pytest.raises(TorsadeError, match="cannot be fitted to 2 different speeds; give at least 3"):
        power_law([1.0, 1.0, 2.0], [1.0, 1.0, 2.0])
    with pytest.raises(TorsadeError, match="something is not above 0"):
        saturation([1.0, 2.0, 3.0], [1.0, 0.0, 2.0])
    with pytest.raises(TorsadeError, match="standard errors of a fit must be finite"):
        power_law([1.0, 2.0, 3.0], [1.0, 1.5, 2.0], error=[0.1, 0.0, 0.1])

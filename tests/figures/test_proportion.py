"""Slopes and correlations: closed forms, and intervals that behave."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.figures.proportion import proportion


def test_slope_and_correlation_are_those_of_the_textbook():
    rng = np.random.default_rng(1)
    x = rng.normal(size=30)
    y = 0.4 * x + rng.normal(size=30)
    found = proportion(x, y, range(30))
    assert found.slope.value == pytest.approx(float(np.linalg.lstsq(x[:, None], y, rcond=None)[0][0]))
    assert found.correlation.value == pytest.approx(np.corrcoef(x, y)[0, 1])
    assert found.n == 30


def test_an_exact_proportion_has_no_interval():
    x = np.arange(1.0, 9.0)
    found = proportion(x, -2 * x, range(8))
    assert found.slope == pytest.approx((-2, -2, -2))
    assert found.correlation == pytest.approx((-1, -1, -1))


def test_intervals_are_about_those_of_theory():
    """Through the origin the standard error of the slope is sigma/√(Σ x²); 95 % is ± 1.96 of it."""
    rng = np.random.default_rng(2)
    x = rng.uniform(-1, 1, 400)
    y = 3 * x + 0.5 * rng.normal(size=400)
    slope = proportion(x, y, range(400)).slope
    half = 1.96 * 0.5 / np.sqrt(x @ x)
    assert 0.5 * (slope.high - slope.low) == pytest.approx(half, rel=0.15)


def test_whole_groups_are_drawn():
    """Copies of every item add nothing: as one group each, the interval is that of single items."""
    rng = np.random.default_rng(3)
    x = rng.normal(size=20)
    y = x + rng.normal(size=20)
    once = proportion(x, y, range(20))
    copies = proportion(np.tile(x, 5), np.tile(y, 5), list(range(20)) * 5)
    apart = proportion(np.tile(x, 5), np.tile(y, 5), range(100))
    assert copies.slope == pytest.approx(once.slope)
    assert apart.slope.high - apart.slope.low < 0.6 * (once.slope.high - once.slope.low)

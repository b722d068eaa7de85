"""Scalings of the quench: limits of the elastica, first passages by chance, published saturation."""

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest

from torsade.fracture.rod import spaghetti
from torsade.fracture.theory.elastica import elastica
from torsade.fracture.theory.quench import (
    breakup_probability,
    dominant_wave_number,
    fracture_sites,
    fragment_length,
    likeliest_breakup,
    parabola_curvature,
    quench_curvature,
    time_to_curvature,
)

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).parents[4] / "shared"))


def test_sine_is_the_limit_of_the_elastica() -> None:
    """The error falls in proportion to the shortening; that of the parabola stays at 22 %."""
    errors = []
    for part in (1e-2, 1e-3):
        exact = elastica(0.24, 0.24 * (1 - part)).kappa_max
        errors.append(abs(float(quench_curvature(0.24 * part, 0.24)) / exact - 1))
        assert float(parabola_curvature(0.24 * part, 0.24)) / exact == pytest.approx(0.78, abs=0.005)
    assert errors[0] < 5e-3
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.05)


def test_accuracy_that_the_docs_state() -> None:
    """Too little by 0.2 and 1.9 %, at shortenings of a hundredth and a tenth of the length."""
    for part, off in ((0.01, 0.00188), (0.1, 0.01918)):
        exact = elastica(0.24, (1 - part) * 0.24).kappa_max
        assert 1 - float(quench_curvature(part * 0.24, 0.24)) / exact == pytest.approx(off, rel=0.01)


def test_time_to_curvature_undoes_it() -> None:
    t = time_to_curvature(14.0, 0.1, 0.24)
    assert float(quench_curvature(0.1 * t, 0.24)) == pytest.approx(14.0, rel=1e-12)


def test_powers_of_the_speed() -> None:
    rod = spaghetti()
    k = [dominant_wave_number(v, 1e-3, rod) for v in (0.01, 0.16)]
    assert k[1] / k[0] == pytest.approx(2.0, rel=1e-12)
    assert float(fragment_length(0.016, 0.04, at=0.001)) == pytest.approx(0.02, rel=1e-12)


@pytest.mark.skipif(not (SHARED / "data").is_dir(), reason="no reference data")
def test_published_saturation() -> None:
    known = json.loads((SHARED / "data/curves/fracture_numbers.json").read_text())
    table = known["N_f/N_inf = erfc(sqrt(B2/v)), B2=1mm/s"]
    v = np.array([float(key) for key in table])
    np.testing.assert_allclose(fracture_sites(1e-3 * v, 1e-3), list(table.values()), rtol=1e-12)
    assert fracture_sites(0.0, 1e-3) == 0


def test_breakup_by_random_walks() -> None:
    """Share of 4000 walks that have passed the depth; steps are refined against missed crossings."""
    generator = np.random.default_rng(5)
    depth, D, t, steps = 1.0, 0.5, 1.3, 4000
    x, passed = np.zeros(4000), np.zeros(4000, dtype=bool)
    dt = t / steps
    for _ in range(steps):
        new = x + generator.normal(0.0, math.sqrt(2 * D * dt), x.size)
        # The chance that a bridge between two points below the depth crossed it on the way.
        bridge = np.exp(-np.maximum(depth - x, 0) * np.maximum(depth - new, 0) / (D * dt))
        passed |= (new >= depth) | (generator.random(x.size) < bridge)
        x = new
    assert passed.mean() == pytest.approx(float(breakup_probability(t, depth, D)), abs=0.025)


def test_likeliest_time_is_where_the_density_peaks() -> None:
    t = np.linspace(0.01, 2, 200001)
    density = np.gradient(breakup_probability(t, 1.0, 0.5), t)
    assert t[np.argmax(density)] == pytest.approx(likeliest_breakup(1.0, 0.5), abs=1e-3)

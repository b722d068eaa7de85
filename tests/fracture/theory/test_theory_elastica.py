"""The pinned elastica against tables and an integration of its own equation."""

import csv
import math
import os
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from torsade.errors import TorsadeError
from torsade.fracture.theory.elastica import curvature_at, elastica

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).parents[4] / "shared"))


@pytest.mark.skipif(not (SHARED / "data").is_dir(), reason="no reference data")
def test_reference_tables() -> None:
    """Curvature and thrust of the table, and the untwisted row of the twisted rods."""
    with (SHARED / "data/curves/elastica_pinned.csv").open() as file:
        for row in csv.DictReader(file):
            shape = elastica(0.24, 0.24 * float(row["d_over_L"]))
            assert 0.24 * shape.kappa_max == pytest.approx(float(row["kappa_max*L"]), rel=1e-9)
            assert shape.thrust_over_euler == pytest.approx(float(row["P/P_Euler"]), rel=1e-9)
            assert shape.modulus == pytest.approx(float(row["k"]), rel=1e-9)
    assert elastica(0.24, 0.17595).kappa_max == pytest.approx(14.28572, abs=1e-3)


def test_profile_closes_the_distance() -> None:
    """Integrating the curvature twice gives back the distance between the ends."""
    shape = elastica(0.24, 0.17)

    def slope(s: float, y: np.ndarray) -> list[float]:
        kappa = float(shape.curvature(np.array(s)))
        return [-kappa, math.cos(y[0]), math.sin(y[0])]

    alpha = 2 * math.asin(shape.modulus)
    end = solve_ivp(slope, (0, 0.24), [alpha, 0.0, 0.0], rtol=1e-10, atol=1e-12).y[:, -1]
    assert end[0] == pytest.approx(-alpha, abs=1e-8)
    assert end[1] == pytest.approx(0.17, abs=1e-8)
    assert end[2] == pytest.approx(0.0, abs=1e-8)


def test_range_of_the_curvature() -> None:
    """By the derivative: 1 mm at d = 17.6 cm is 0.12 1/m; near a straight rod the range is one-sided."""
    kappa, low, high = curvature_at(0.24, 0.17595, 1e-3)
    slope = (elastica(0.24, 0.17594).kappa_max - elastica(0.24, 0.17596).kappa_max) / 2e-5
    assert high - low == pytest.approx(2e-3 * slope, rel=1e-3)
    assert low < kappa < high
    assert curvature_at(0.24, 0.17595) == (kappa, kappa, kappa)
    straight, low, high = curvature_at(0.24, 0.2395, 1e-3)
    assert low == 0
    assert high - straight < straight - low


def test_straight_and_impossible() -> None:
    assert elastica(0.24, 0.24).kappa_max == 0
    with pytest.raises(TorsadeError, match=r"0\.25 m does not go with a rod of 0\.24 m; give one from"):
        elastica(0.24, 0.25)

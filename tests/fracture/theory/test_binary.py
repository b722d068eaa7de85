"""When rods break in two: published thresholds, and the condition solved by brute force."""

import json
import math
import os
from pathlib import Path

import pytest
from scipy.optimize import brentq

from torsade.fracture.criteria import CRITERIA, matching_strength, stress, torsion_limit
from torsade.fracture.rod import Rod, spaghetti
from torsade.fracture.theory.bending_wave import AMPLIFICATION
from torsade.fracture.theory.binary import binary_slope, li, li_threshold, threshold

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).parents[4] / "shared"))

SETS = {
    "set1_L24_d1.4": (spaghetti(1), 1.9e7),
    "set1_mu1.5GPa": (Rod(3.8e9, 1.5e9, 1500.0, 7e-4, 0.24), 1.9e7),
    "set2_L20_d1.7": (spaghetti(2), 1.8e7),
}


@pytest.mark.skipif(not (SHARED / "data").is_dir(), reason="no reference data")
@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("label", ["1.42794", "1.50000"])
def test_published_thresholds(name: str, label: str) -> None:
    rod, sigma_c = SETS[name]
    known = json.loads((SHARED / "data/curves/fracture_numbers.json").read_text())[name]
    C = AMPLIFICATION if label == "1.42794" else 1.5
    at = threshold(rod, sigma_c, C)
    assert math.degrees(at.twist) == pytest.approx(known[f"C={label}: crit twist deg (3.4)+(3.23)"], rel=1e-9)
    assert at.kappa == pytest.approx(known[f"C={label}: kappa at crit"], rel=1e-9)
    assert at.li == pytest.approx(known[f"C={label}: Li threshold sqrt((C^2-1)/2)"], rel=1e-9)
    assert li_threshold(C) == pytest.approx(at.li, rel=1e-12)


def test_the_measured_threshold() -> None:
    """About 250 degrees; 258 with C = 1.428, 269 with C = 1.5."""
    rod, sigma_c = SETS["set1_L24_d1.4"]
    assert math.degrees(threshold(rod, sigma_c).twist) == pytest.approx(257.81, abs=0.01)
    assert math.degrees(threshold(rod, sigma_c, 1.5).twist) == pytest.approx(269.19, abs=0.01)


def test_slope_is_3_23() -> None:
    rod = spaghetti()
    printed = 1 / (math.sqrt(2) * rod.L * (1 + rod.nu) * math.sqrt(1.5**2 - 1))
    assert binary_slope(rod, 1.5) == pytest.approx(printed, rel=1e-12)
    assert printed * rod.L == pytest.approx(0.4865042554105198, rel=1e-12)


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize("C", [1.1, AMPLIFICATION, 1.6])
def test_threshold_by_brute_force(name: str, C: float) -> None:
    """Untwisted and bent C times as much, the rod is as strained as it was when it broke."""
    rod = spaghetti()
    sigma_c = matching_strength(1.9e7, name)

    def excess(twist: float) -> float:
        kappa = brentq(lambda k: float(stress(k, twist / rod.L, rod.E, rod.mu, rod.h, name)) - sigma_c, 0, 20)
        return float(stress(C * kappa, 0.0, rod.E, rod.mu, rod.h, name)) - sigma_c

    twist = brentq(excess, 0.0, 0.999 * torsion_limit(rod.L, sigma_c, rod.mu, rod.h, name))
    at = threshold(rod, sigma_c, C, name)
    assert at.twist == pytest.approx(twist, rel=1e-9)
    assert at.kappa / at.twist == pytest.approx(binary_slope(rod, C, name), rel=1e-9)


def test_no_amplification_no_further_break() -> None:
    assert li_threshold(1.0) == 0
    assert li_threshold(1.0, "max_principal") == 0


def test_li_of_pure_torsion_is_infinite() -> None:
    assert li(1.0, 0.0, spaghetti()) == math.inf
    assert math.isnan(li(0.0, 0.0, spaghetti()))
    assert li(-1.0, 10.0, spaghetti()) == li(1.0, 10.0, spaghetti()) > 0

"""Materials, sections and presets: the thesis's numbers, and what follows from them."""

from __future__ import annotations

import dataclasses
import math
import subprocess
import sys
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsade.errors import TorsadeError
from torsade.material import MATERIALS, Material, Section, named_material, preset

STEEL = Material(name="steel", E=2e11, E_b=2e11, nu=0.3, rho=7800.0, eta=1.0)


@settings(deadline=None)
@given(st.floats(1e3, 1e12), st.floats(-0.9, 0.49))
def test_isotropic_moduli_agree(E: float, nu: float) -> None:
    """With E_b = E, 1/mu and 1/K satisfy the identity 9/E = 3/mu + 1/K of isotropic elasticity."""
    m = dataclasses.replace(STEEL, E=E, E_b=E, nu=nu)
    assert 3 / m.mu + 1 / m.K == pytest.approx(9 / E, rel=1e-12)


def test_soft_bending_softens_twist_but_not_contact() -> None:
    soft = dataclasses.replace(STEEL, E_b=STEEL.E / 10)
    assert soft.mu == pytest.approx(STEEL.mu / 10)
    assert soft.K == STEEL.K


def test_section_of_unit_radius() -> None:
    section = Section(h=1.0)
    assert pytest.approx((math.pi, math.pi / 4, math.pi / 2)) == (section.A, section.I, section.J)


@settings(deadline=None)
@given(st.floats(1e-6, 1.0))
def test_section_scales_with_radius(h: float) -> None:
    one, two = Section(h), Section(2 * h)
    assert pytest.approx((4 * one.A, 16 * one.I, 32 * one.I)) == (two.A, two.I, two.J)


@pytest.mark.parametrize(
    ("name", "E", "E_b", "rho", "eta", "twist_damping", "h"),
    [
        ("nylon", 1e9, 1e8, 1000.0, 1e5, 0.0, 2e-4),  # thesis 4.6
        ("optomechanical", 1e6, 1e6, 1000.0, 1e3, 0.0, 2e-4),  # thesis 4.3
        ("spaghetti", 3.8e9, 3.8e9, 1500.0, 0.0, 1.68e4, 7e-4),  # thesis 3.2
        ("silicone", 5e7, 1e7, 1100.0, 1e4, 0.0, 2e-4),  # thesis 5.2; rho and h are ours
    ],
)
def test_presets_are_the_thesis_numbers(
    name: str, E: float, E_b: float, rho: float, eta: float, twist_damping: float, h: float
) -> None:
    m = named_material(name)
    assert (m.name, m.E, m.E_b, m.nu, m.rho) == (name, E, E_b, 0.3, rho)
    assert (m.eta, m.twist_damping, preset(name).section.h) == (eta, twist_damping, h)
    assert "thesis" in m.source


def test_spaghetti_has_the_measured_shear_modulus_and_damping() -> None:
    """Thesis 3.2: mu = 1.5 ± 0.2 GPa measured; b = 1.3 pi c_theta/L at L = 24 cm, c_theta^2 = mu/rho."""
    m = named_material("spaghetti")
    assert m.mu == pytest.approx(1.5e9, abs=0.2e9)
    assert m.twist_damping == pytest.approx(1.3 * math.pi * math.sqrt(m.mu / m.rho) / 0.24, rel=2e-3)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"E": 0.0}, "material 'steel' has E = 0.0; give a finite number above 0 [Pa]"),
        ({"E": math.nan}, "E = nan"),
        ({"E_b": -1.0}, "E_b = -1.0"),
        ({"rho": math.inf}, "rho = inf; give a finite number above 0 [kg/m^3]"),
        ({"eta": -1.0}, "eta = -1.0; give a finite number of at least 0 [Pa s]"),
        ({"twist_damping": math.nan}, "twist_damping = nan"),
        ({"nu": 0.5}, "nu = 0.5; give a number above -1 and below 0.5"),
        ({"nu": -1.0}, "nu = -1.0"),
        ({"nu": math.nan}, "nu = nan"),
    ],
)
def test_impossible_materials_are_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(TorsadeError) as caught:
        dataclasses.replace(STEEL, **change)
    assert says in str(caught.value)


@pytest.mark.parametrize("h", [0.0, -1e-3, math.nan, math.inf])
def test_impossible_radius_is_refused(h: float) -> None:
    with pytest.raises(TorsadeError, match=r"radius h = .*above 0 \[m\]"):
        Section(h)


def test_unknown_material_names_the_nearest_and_all() -> None:
    with pytest.raises(TorsadeError, match=r"unknown material 'Nylno'; did you mean 'nylon'\?") as caught:
        named_material("Nylno")
    assert all(name in str(caught.value) for name in MATERIALS)
    with pytest.raises(TorsadeError, match=r"unknown material 'xyz'; choose one of nylon"):
        named_material("xyz")


def test_materials_cannot_be_changed_in_place() -> None:
    with pytest.raises(TypeError):
        MATERIALS["nylon"] = MATERIALS["silicone"]  # type: ignore[index]
    with pytest.raises(dataclasses.FrozenInstanceError):
        named_material("nylon").E = 1.0  # type: ignore[misc]


def test_units_and_materials_import_without_arrays() -> None:
    """`torsade --help` needs them, and must not wait for NumPy or SciPy."""
    code = "import sys, torsade.material, torsade.units; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

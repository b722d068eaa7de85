"""Time scales against numbers computed elsewhere, for the thesis's two sets of rods."""

import math

import pytest

from torsade.fracture.rod import Rod, spaghetti
from torsade.fracture.theory.scales import bending_energy, kinetic_energy, time_scales

LAMBDA = 0.03

PUBLISHED = {
    1: (243.13738806214934, 103.39707907543567, 30.392173507768668, 128.563720594681, 2057.019529514896),
    2: (202.61449005179117, 59.13231646470997, 30.392173507768668, 105.87600519561967, 1176.4000577291076),
}
"""T_twist [us], T_bend [ms], T_theta^0, T_b^0 and the time to the clamp [us]."""


@pytest.mark.parametrize("which", PUBLISHED)
def test_times(which: int) -> None:
    scales = time_scales(spaghetti(which), LAMBDA)
    twist, bend, near, far, clamp = PUBLISHED[which]
    assert 1e6 * scales.twist == pytest.approx(twist, rel=1e-12)
    assert 1e3 * scales.bend == pytest.approx(bend, rel=1e-12)
    assert 1e6 * scales.twist_fragment == pytest.approx(near, rel=1e-12)
    assert 1e6 * scales.bend_fragment == pytest.approx(far, rel=1e-12)
    assert 1e6 * scales.bend_clamp == pytest.approx(clamp, rel=1e-12)


def test_ratios_are_the_thesis_s_formulas() -> None:
    """(3.10), (3.22a) and (3.22b) in their own form, and T_diss about twice T_b^0."""
    rod = spaghetti()
    scales = time_scales(rod, LAMBDA)
    half = math.sqrt(1 / (2 * (1 + rod.nu)))
    assert scales.bend_over_twist == pytest.approx(rod.L / rod.h * math.sqrt(2 / (1 + rod.nu)), rel=1e-12)
    assert scales.fragment_ratio == pytest.approx(LAMBDA / (2 * math.pi * rod.h) * half, rel=1e-12)
    assert scales.far_ratio == pytest.approx(rod.L / (2 * math.pi**2 * rod.h) * half, rel=1e-12)
    assert scales.fragment_ratio > 4
    assert scales.twist / scales.bend_fragment == pytest.approx(1.8911819519340243, rel=1e-12)
    measured = time_scales(rod, LAMBDA, b=1.3 * math.pi * rod.c_theta / rod.L)
    assert measured.far_ratio == pytest.approx(8.28616227780779, rel=1e-12)


def test_with_the_measured_shear_modulus() -> None:
    """mu = 1.5 GPa, as measured, in place of E/(2 + 2 nu) = 1.46 GPa."""
    scales = time_scales(Rod(3.8e9, 1.5e9, 1500.0, 7e-4, 0.24), LAMBDA)
    assert scales.bend_over_twist == pytest.approx(430.82116281431536, rel=1e-12)
    assert scales.fragment_ratio == pytest.approx(4.285457353156034, rel=1e-12)


def test_energies() -> None:
    """At kappa = 10 1/m and v = 1 m/s: 0.07 J/m against 0.001 J/m."""
    assert bending_energy(spaghetti(), 10.0) == pytest.approx(0.07165815763205638, rel=1e-12)
    assert kinetic_energy(spaghetti(), 1.0) == pytest.approx(0.001154535300194249, rel=1e-12)

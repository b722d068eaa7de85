"""Units: what is read, to the last bit, and what is refused, in one clear sentence."""

from __future__ import annotations

import contextlib
import math
from fractions import Fraction
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from torsade import units
from torsade.errors import TorsadeError
from torsade.units import DIMENSIONS, quantity


@pytest.mark.parametrize(
    ("text", "dimension", "si"),
    [
        ("15 N", "force", 15.0),
        ("15N", "force", 15.0),
        ("  15  N ", "force", 15.0),
        ("-2.5 kN", "force", -2500.0),
        ("−2.5 kN", "force", -2500.0),
        ("0.2 mm", "length", 2e-4),
        ("0.3 mm", "length", 3e-4),
        ("20 µm", "length", 2e-5),
        ("20 um", "length", 2e-5),
        ("1 in", "length", 0.0254),
        ("1 s", "time", 1.0),
        ("2 min", "time", 120.0),
        ("1e5 Pa s", "viscosity", 1e5),
        ("10 kPa*s", "viscosity", 1e4),
        ("10 kPa·s", "viscosity", 1e4),
        ("1e6 g cm^-1 s^-1", "viscosity", 1e5),
        ("1e6 g cm⁻¹ s⁻¹", "viscosity", 1e5),
        ("1e6 g/(cm s)", "viscosity", 1e5),
        ("1e6 g/cm/s", "viscosity", 1e5),
        ("5 cP", "viscosity", 5e-3),
        ("1 GPa", "pressure", 1e9),
        ("1 N/mm^2", "pressure", 1e6),
        ("1 N/mm**2", "pressure", 1e6),
        ("1 N/mm²", "pressure", 1e6),
        ("1 bar", "pressure", 1e5),
        ("1.5 g/cm^3", "density", 1500.0),
        ("270 deg", "angle", 1.5 * math.pi),
        ("180°", "angle", math.pi),
        ("1 turn", "angle", 2 * math.pi),
        ("2 mm/s", "velocity", 2e-3),
        ("2 mm s^-1", "velocity", 2e-3),
        ("16.8 kHz", "rate", 1.68e4),
        ("1.68e4 1/s", "rate", 1.68e4),
        ("1/s", "rate", 1.0),
        ("3 /min", "rate", 0.05),
        ("3 mN mm", "torque", 3e-6),
        ("20 %", "number", 0.2),
        ("0.3", "number", 0.3),
        ("15", "force", 15.0),
        (".5 m", "length", 0.5),
        ("5. m", "length", 5.0),
        ("1e-99999999999 m", "length", 0.0),
        (15, "force", 15.0),
        (0.2, "length", 0.2),
        (np.float32(0.5), "length", 0.5),
        (np.int64(3), "number", 3.0),
    ],
)
def test_reads(text: str | float, dimension: str, si: float) -> None:
    """Decimal values are exact, not nearly so: a spec hashes the same whatever units it uses."""
    assert quantity(text, dimension) == si
    assert type(quantity(text, dimension)) is float


@pytest.mark.parametrize(
    ("prefix", "power"), [("p", -12), ("n", -9), ("m", -3), ("k", 3), ("M", 6), ("G", 9)]
)
@settings(deadline=None)
@given(st.decimals(-1000, 1000, places=6))
def test_prefix_is_a_power_of_ten_rounded_once(prefix: str, power: int, value: object) -> None:
    expected = float(Fraction(str(value)) * Fraction(10) ** power)
    assert quantity(f"{value} {prefix}N", "force") == expected


@settings(deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(sorted(DIMENSIONS)))
def test_number_and_its_si_text_agree(value: float, dimension: str) -> None:
    assert quantity(value, dimension) == value
    assert quantity(repr(value), dimension) == value
    unit = DIMENSIONS[dimension].unit
    assert quantity(f"{value!r} {unit}", dimension) == value


def test_examples_in_messages_are_themselves_readable() -> None:
    for dimension in DIMENSIONS.values():
        assert math.isfinite(quantity(dimension.example, dimension.name))


@pytest.mark.parametrize(
    ("value", "dimension", "says"),
    [
        ("15 s", "force", "'15 s' is a time, not a force; give a force such as \"15 N\", or a number in N"),
        ("0 s", "force", "is a time, not a force"),
        ("270 deg", "number", "is an angle, not a number"),
        ("1 m s^2", "force", "is something else, not a force"),
        ("15 n", "force", "unknown unit 'n' (did you mean N?)"),
        ("15 mpa", "pressure", "did you mean mPa or MPa?"),
        ("15 furlong", "length", "unknown unit 'furlong'; give a length"),
        ("5 µ", "length", "unknown unit 'µ'"),
        ("", "force", "does not begin with a number"),
        ("N", "force", "does not begin with a number"),
        ("١٥ N", "force", "does not begin with a number"),
        ("1" * 101, "force", "does not begin with a number"),
        ("0,2 mm", "length", "cannot be read at ',2 mm'"),
        ("1_0 N", "force", "cannot be read at '_0 N'"),
        ("0x10", "number", "unknown unit 'x"),
        ("5 1", "number", "cannot be read at '1'"),
        ("5 N)", "force", "cannot be read at 'N)'"),
        ("5 (N", "force", "cannot be read at '('"),
        ("5 ()", "force", "cannot be read at ')'"),
        ("5 " + "(" * 90, "force", "ends too soon"),
        ("5 N*", "force", "ends too soon"),
        ("5 /", "rate", "ends too soon"),
        ("5 * N", "force", "cannot be read at '*'"),
        ("5 //s", "rate", "cannot be read at '/'"),
        ("5 N^0.5", "force", "cannot be read"),
        ("5 N^99", "force", "cannot be read at '^99'"),
        ("5 N^", "force", "cannot be read at '^'"),
        ("nan", "force", "is not a finite number"),
        ("-inf", "force", "is not a finite number"),
        ("1e400 N", "force", "is not a finite number"),
        ("1e300 GPa", "pressure", "is not a finite number"),
        (math.nan, "force", "nan is not a finite number"),
        (-math.inf, "force", "-inf is not a finite number"),
        (10**400, "force", "is not a finite number"),
        (True, "force", "True is not a number"),
        (None, "force", "None is not a number"),
        ([1.0], "force", "[1.0] is not a number"),
        ("1 m", "lenght", "there is no dimension 'lenght'; choose one of number, length"),
    ],
)
def test_refuses(value: str | float, dimension: str, says: str) -> None:
    with pytest.raises(TorsadeError) as caught:
        quantity(value, dimension)
    message = str(caught.value)
    assert says in message
    assert len(message) < 300
    assert "\n" not in message


@settings(deadline=None)
@given(st.text(alphabet="0123456789.eE+-*/^()·°% NPasmkgµ²⁻", max_size=30))
def test_any_text_is_read_or_refused(text: str) -> None:
    """No input escapes as another error, and what is read is finite."""
    with contextlib.suppress(TorsadeError):
        assert math.isfinite(quantity(text, "pressure"))


class _Spec(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    radius: units.Length = 2e-4
    force: Annotated[units.Force, Field(gt=0)] = 15.0
    nu: units.Number = 0.3


def test_pydantic_fields_read_units_and_keep_bounds() -> None:
    spec = _Spec.model_validate({"radius": "0.35 mm", "force": "20 mN"})
    assert (spec.radius, spec.force, spec.nu) == (3.5e-4, 0.02, 0.3)
    with pytest.raises(ValidationError, match=r"'15 s' is a time, not a force"):
        _Spec.model_validate({"force": "15 s"})
    with pytest.raises(ValidationError, match=r"greater than 0"):
        _Spec.model_validate({"force": "-15 N"})


@pytest.mark.parametrize("name", ["Length", "Time", "Force", "Pressure", "Viscosity", "Density", "Angle"])
def test_annotated_types_carry_their_unit(name: str) -> None:
    metadata = getattr(units, name).__metadata__
    assert [m.name for m in metadata if isinstance(m, units.Dimension)] == [name.lower()]


def test_help_text_can_find_the_unit_of_a_field() -> None:
    metadata = _Spec.model_fields["force"].metadata
    assert [m.unit for m in metadata if isinstance(m, units.Dimension)] == ["N"]


@settings(deadline=None)
@given(st.decimals(0, 1000, places=3), st.integers(1, 200))
def test_even_values_are_the_floats_that_they_are_when_written_out(last: object, parts: int) -> None:
    found = units.evenly(0.0, float(str(last)), parts)
    exact = [Fraction(str(last)) * k / parts for k in range(parts + 1)]
    assert found == [float(value) for value in exact]
    assert found[-1] == float(str(last))


def test_reported_numbers_are_without_the_roundings_of_sums() -> None:
    assert units.rounded(sum([0.1] * 8)) == 0.8 != sum([0.1] * 8)
    assert units.rounded(-1.234567890123e-7) == pytest.approx(-1.234567890123e-7, rel=1e-12)
    assert units.rounded(0.0) == 0.0

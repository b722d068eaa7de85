"""Quantities with units, read into SI floats.

A spec or a flag may say ``"0.2 mm"``; what is stored is 0.0002. A plain number is SI already.

>>> quantity("1e5 Pa s", "viscosity")
100000.0
>>> quantity("1.5 g/cm^3", "density")
1500.0
>>> quantity(0.02, "force")
0.02
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real
from types import MappingProxyType
from typing import Annotated, NamedTuple

from pydantic import BeforeValidator

from torsade.errors import QuantityError, TorsadeError, quoted

__all__ = [
    "DIMENSIONS",
    "Angle",
    "AngularVelocity",
    "Density",
    "Dimension",
    "Force",
    "Length",
    "Mass",
    "Number",
    "Pressure",
    "Rate",
    "Stiffness",
    "Time",
    "Torque",
    "Velocity",
    "Viscosity",
    "Whole",
    "bearable",
    "evenly",
    "exact",
    "indefinite",
    "is_bearable",
    "metres",
    "quantity",
    "rounded",
    "said",
]

Exponents = tuple[int, int, int, int]
"""Powers of metre, kilogram, second and radian.

The radian is kept apart from a pure number so that "270 deg" is refused where a count is meant.
"""


class _Measure(NamedTuple):
    """A unit, or a product of units: how many SI units it is, and of what.

    The factor is a fraction, so that "0.3 mm" and "3e-4 m" give the same float to the last bit and
    a spec means the same, hash included, whatever units it was written in.
    """

    factor: Fraction
    exponents: Exponents

    @property
    def digits(self) -> int:
        """Binary digits of the factor."""
        return self.factor.numerator.bit_length() + self.factor.denominator.bit_length()

    def times(self, other: _Measure, power: int = 1) -> _Measure:
        a, b = self.exponents, other.exponents
        summed = (a[0] + power * b[0], a[1] + power * b[1], a[2] + power * b[2], a[3] + power * b[3])
        return _Measure(self.factor * other.factor**power, summed)


_ONE = _Measure(Fraction(1), (0, 0, 0, 0))


@dataclass(frozen=True)
class Dimension:
    """What a quantity measures: its name, its SI unit and an example for messages and help texts."""

    name: str
    unit: str
    exponents: Exponents
    example: str


DIMENSIONS: Mapping[str, Dimension] = MappingProxyType(
    {
        d.name: d
        for d in (
            Dimension("number", "", (0, 0, 0, 0), "0.3"),
            Dimension("length", "m", (1, 0, 0, 0), "0.2 mm"),
            Dimension("time", "s", (0, 0, 1, 0), "1 s"),
            Dimension("velocity", "m/s", (1, 0, -1, 0), "2 mm/s"),
            Dimension("rate", "1/s", (0, 0, -1, 0), "100 1/s"),
            Dimension("angle", "rad", (0, 0, 0, 1), "270 deg"),
            Dimension("angular velocity", "rad/s", (0, 0, -1, 1), "90 deg/s"),
            Dimension("twist density", "rad/m", (-1, 0, 0, 1), "2 rad/mm"),
            Dimension("curvature", "1/m", (-1, 0, 0, 0), "10 1/m"),
            Dimension("mass", "kg", (0, 1, 0, 0), "20 g"),
            Dimension("density", "kg/m^3", (-3, 1, 0, 0), "1.5 g/cm^3"),
            Dimension("force", "N", (1, 1, -2, 0), "15 N"),
            Dimension("stiffness", "N/m", (0, 1, -2, 0), "20 N/m"),
            Dimension("torque", "N m", (2, 1, -2, 0), "3 mN mm"),
            Dimension("energy", "J", (2, 1, -2, 0), "3 mJ"),
            Dimension("moment of inertia", "kg m^2", (2, 1, 0, 0), "2 kg mm^2"),
            Dimension("pressure", "Pa", (-1, 1, -2, 0), "1 GPa"),
            Dimension("viscosity", "Pa s", (-1, 1, -1, 0), "1e5 Pa s"),
        )
    }
)

_PREFIXES = dict(zip("pnuµμmcdhkMGT", (-12, -9, -6, -6, -6, -3, -2, -1, 2, 3, 6, 9, 12), strict=True))
_PI = Fraction(math.pi)
_LB = Fraction("0.45359237")
_GRAVITY = Fraction("9.80665")
_INCH = Fraction("0.0254")

# Units that take a prefix, then those that do not ("min" is a minute, not a milli-inch).
_PREFIXED = {
    "m": _Measure(Fraction(1), (1, 0, 0, 0)),
    "g": _Measure(Fraction(1, 1000), (0, 1, 0, 0)),
    "s": _Measure(Fraction(1), (0, 0, 1, 0)),
    "rad": _Measure(Fraction(1), (0, 0, 0, 1)),
    "Hz": _Measure(Fraction(1), (0, 0, -1, 0)),
    "N": _Measure(Fraction(1), (1, 1, -2, 0)),
    "J": _Measure(Fraction(1), (2, 1, -2, 0)),
    "Pa": _Measure(Fraction(1), (-1, 1, -2, 0)),
    "bar": _Measure(Fraction(10**5), (-1, 1, -2, 0)),
    "P": _Measure(Fraction(1, 10), (-1, 1, -1, 0)),
    "dyn": _Measure(Fraction(1, 10**5), (1, 1, -2, 0)),
}
_PLAIN = {
    "%": _Measure(Fraction(1, 100), (0, 0, 0, 0)),
    "in": _Measure(_INCH, (1, 0, 0, 0)),
    "ft": _Measure(12 * _INCH, (1, 0, 0, 0)),
    "min": _Measure(Fraction(60), (0, 0, 1, 0)),
    "h": _Measure(Fraction(3600), (0, 0, 1, 0)),
    "deg": _Measure(_PI / 180, (0, 0, 0, 1)),
    "°": _Measure(_PI / 180, (0, 0, 0, 1)),
    "turn": _Measure(2 * _PI, (0, 0, 0, 1)),
    "turns": _Measure(2 * _PI, (0, 0, 0, 1)),
    "kgf": _Measure(_GRAVITY, (1, 1, -2, 0)),
    "lbf": _Measure(_LB * _GRAVITY, (1, 1, -2, 0)),
    "psi": _Measure(_LB * _GRAVITY / _INCH**2, (-1, 1, -2, 0)),
}

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_TOKEN = re.compile(r"\s*(\*\*|[*·⋅/^()]|[+-]?[0-9]+|[^\W\d_]+|%|°)\s*")
_SUPERSCRIPT = re.compile("[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]")
_PLAIN_DIGITS = str.maketrans("⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "+-0123456789")
_LONGEST_TEXT = 100
_HIGHEST_POWER = 9
_MOST_DIGITS = 10_000  # of what is raised to a power: ((m^9)^9)^9 ... would fill the memory

LEAST, GREATEST = 1e-30, 1e30
"""Sizes in SI units between which lies what can be computed with: products of a few do not overflow."""


def quantity(value: str | float, dimension: str) -> float:
    """Return `value` in SI units.

    Args:
        value: a number, taken as SI, or text such as ``"15 N"``, ``"2 mm/s"``, ``"1e5 Pa*s"``,
            ``"10 g cm^-1 s^-1"``. Products are a space, ``*`` or ``·``; ``/`` divides by the one
            factor that follows it (or by a bracket); powers are ``^2``, ``**2`` or ``²``.
        dimension: a name in `DIMENSIONS`.

    Raises:
        TorsadeError: not a number, not finite, an unknown unit, or a unit of another dimension.
    """
    result = _to_float(_read(value, dimension))
    if not math.isfinite(result):
        raise QuantityError(f"{quoted(value)} is not a finite number; {_advice(DIMENSIONS[dimension])}")
    return result


def exact(value: str | float, dimension: str) -> Fraction:
    """The fraction of SI units that `quantity` rounds; a float stands for its shortest decimal form.

    Values between two quantities, worked out in fractions, are the floats that they are when written out.

    Raises:
        TorsadeError: as `quantity`.
    """
    rounded = quantity(value, dimension)
    return Fraction(_read(value, dimension) if isinstance(value, str) else repr(rounded))


def evenly(first: float, last: float, parts: int) -> list[float]:
    """First, last, and what divides the way between them evenly, each rounded once.

    Values are the floats that they are when written out, where adding steps up leaves roundings.

    >>> evenly(0.0, 2.0, 100)[35], 35 * (2.0 / 100)
    (0.7, 0.7000000000000001)
    """
    begin, end = (Fraction(repr(float(x))) for x in (first, last))
    common = begin.denominator * end.denominator
    a, b = int(begin * common), int(end * common)
    return [(a * (parts - k) + b * k) / (common * parts) for k in range(parts + 1)]


def rounded(value: float) -> float:
    """A reported number to 12 digits: without the roundings of the sums and differences it comes from."""
    return float(f"{value:.12g}")


def said(value: float, dimension: Dimension) -> str:
    """A value in SI units as people write it, with its unit; angles are in degrees.

    >>> said(0.5235987755982988, DIMENSIONS["angle"])
    '30 deg'
    """
    if dimension.name == "angle":
        return f"{math.degrees(value):g} deg"
    return f"{value:g} {dimension.unit}".strip()


def _read(value: str | float, dimension: str) -> Fraction | float:
    """The value in SI units, as exactly as it is known; any that is not finite is a float."""
    if dimension not in DIMENSIONS:
        raise TorsadeError(f"there is no dimension {dimension!r}; choose one of {', '.join(DIMENSIONS)}")
    wanted = DIMENSIONS[dimension]
    if isinstance(value, str):
        return _from_text(value, wanted)
    if isinstance(value, Real) and not isinstance(value, bool):
        return value
    raise QuantityError(f"{quoted(value)} is not a number; {_advice(wanted)}")


def is_bearable(value: float) -> bool:
    """Whether the size of a number in SI units is 0 or between `LEAST` and `GREATEST`."""
    return value == 0 or LEAST <= abs(value) <= GREATEST


def bearable(value: str | float, dimension: str) -> float:
    """Return `value` in SI units, as `quantity` reads it, if it is bearable.

    Raises:
        TorsadeError: as `quantity`; or it is so large or small that numbers made of it overflow.
    """
    result = quantity(value, dimension)
    if not is_bearable(result):
        unit = DIMENSIONS[dimension].unit
        between = f"between {LEAST:g} and {GREATEST:g} {unit}".rstrip()
        raise QuantityError(f"{quoted(value)} is beyond what can be computed with; give a size {between}")
    return result


def metres(name: str, value: float | str) -> float:
    """A length [m] that may carry a unit; what is wrong with it is said with its name."""
    if not isinstance(value, str):
        return value
    try:
        return quantity(value, "length")
    except QuantityError as error:
        raise QuantityError(f"{name} {error}") from None


def _to_float(number: Real | Fraction | float) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf


def _from_text(text: str, wanted: Dimension) -> Fraction | float:
    """Read "number unit"; a number alone is SI."""
    plain = _SUPERSCRIPT.sub(lambda m: "^" + m[0].translate(_PLAIN_DIGITS), text.strip().replace("−", "-"))
    number = _NUMBER.match(plain) if len(plain) <= _LONGEST_TEXT else None
    if number is None:
        if plain.lower().lstrip("+-") in ("nan", "inf", "infinity"):
            return math.nan
        raise QuantityError(f"{quoted(text)} does not begin with a number; {_advice(wanted)}")
    rounded = float(number[0])
    if math.isinf(rounded):
        return rounded
    # The exact fraction of "1e-999999999" would fill the memory; the float is 0 and costs nothing.
    written = Fraction(number[0]) if rounded else Fraction(0)
    unit = plain[number.end() :].strip()
    if not unit:
        return written
    try:
        measure = _read_unit(unit)
    except ValueError as reason:
        raise QuantityError(f"{quoted(text)} has {reason}; {_advice(wanted)}") from None
    if measure.exponents != wanted.exponents:
        given = next((d.name for d in DIMENSIONS.values() if d.exponents == measure.exponents), None)
        raise QuantityError(
            f"{quoted(text)} is {indefinite(given)}, not {indefinite(wanted.name)}; {_advice(wanted)}"
        )
    return written * measure.factor


def _read_unit(text: str) -> _Measure:
    """Read a unit such as "g/(cm s)"; raise ValueError with the reason when it cannot be read."""
    tokens, at = [], 0
    while token := _TOKEN.match(text, at):
        tokens.append(token[1])
        at = token.end()
    tokens.reverse()  # a stack: the next token is the last
    measure = _read_product(tokens) if at == len(text) else None
    if measure is None or tokens:
        raise _unreadable(text)
    return measure


def _read_product(tokens: list[str]) -> _Measure:
    measure = _ONE if tokens[-1:] == ["/"] else _read_power(tokens)
    while tokens and tokens[-1] != ")":
        operator = tokens.pop() if tokens[-1] in ("*", "·", "⋅", "/") else "*"
        measure = measure.times(_read_power(tokens), -1 if operator == "/" else 1)
    return measure


def _read_power(tokens: list[str]) -> _Measure:
    token = tokens.pop() if tokens else ""
    if token == "(":
        base = _read_product(tokens)
        if not tokens or tokens.pop() != ")":
            raise _unreadable("(")
    elif token == "1" and tokens[-1:] == ["/"]:
        base = _ONE
    else:
        base = _unit(token)
    if tokens[-1:] not in (["^"], ["**"]):
        return base
    tokens.pop()
    power = tokens.pop() if tokens else ""
    if not power.lstrip("+-").isdecimal() or abs(int(power)) > _HIGHEST_POWER:
        raise _unreadable(f"^{power}")
    if base.digits > _MOST_DIGITS:
        raise ValueError("powers of powers that nothing has")
    return _ONE.times(base, int(power))


def _unit(symbol: str) -> _Measure:
    if not symbol.isalpha() and symbol not in _PLAIN:
        raise _unreadable(symbol)
    if symbol in _PREFIXED or symbol in _PLAIN:
        return _PREFIXED.get(symbol) or _PLAIN[symbol]
    prefix, name = symbol[0], symbol[1:]
    if prefix in _PREFIXES and name in _PREFIXED:
        unit = _PREFIXED[name]
        return _Measure(Fraction(10) ** _PREFIXES[prefix] * unit.factor, unit.exponents)
    known = [*_PLAIN, *_PREFIXED, *(p + u for p in _PREFIXES for u in _PREFIXED)]
    alike = [u for u in known if u.casefold() == symbol.casefold()]
    raise ValueError(
        f"the unknown unit {quoted(symbol, 20)}" + (f" (did you mean {' or '.join(alike)}?)" * bool(alike))
    )


def _unreadable(part: str) -> ValueError:
    return ValueError(
        f"a unit that cannot be read at {quoted(part, 20)}" if part else "a unit that ends too soon"
    )


def indefinite(name: str | None) -> str:
    """A name of a dimension with its article; None is something else."""
    if name is None:
        return "something else"
    return f"an {name}" if name[0] in "aeiou" else f"a {name}"


def _advice(wanted: Dimension) -> str:
    if not wanted.unit:
        return f'give a pure number, such as "{wanted.example}"'
    return f'give {indefinite(wanted.name)} such as "{wanted.example}", or a number in {wanted.unit}'


def _reads(dimension: str) -> BeforeValidator:
    """A pydantic validator that reads `dimension`."""
    return BeforeValidator(lambda value: bearable(value, dimension))


def _whole(value: object) -> object:
    if isinstance(value, bool):  # which counts as 0 or 1 elsewhere
        raise QuantityError(f"is {value}; give a whole number")
    return value


# Annotated types for pydantic models: ``radius: Length = 2e-4``. The `Dimension` in the metadata
# tells help texts the unit; bounds are added where used: ``Annotated[Force, Field(gt=0)]``.
Whole = Annotated[int, BeforeValidator(_whole)]
Number = Annotated[float, _reads("number"), DIMENSIONS["number"]]
Length = Annotated[float, _reads("length"), DIMENSIONS["length"]]
Time = Annotated[float, _reads("time"), DIMENSIONS["time"]]
Velocity = Annotated[float, _reads("velocity"), DIMENSIONS["velocity"]]
Rate = Annotated[float, _reads("rate"), DIMENSIONS["rate"]]
Angle = Annotated[float, _reads("angle"), DIMENSIONS["angle"]]
AngularVelocity = Annotated[float, _reads("angular velocity"), DIMENSIONS["angular velocity"]]
Density = Annotated[float, _reads("density"), DIMENSIONS["density"]]
Mass = Annotated[float, _reads("mass"), DIMENSIONS["mass"]]
Force = Annotated[float, _reads("force"), DIMENSIONS["force"]]
Stiffness = Annotated[float, _reads("stiffness"), DIMENSIONS["stiffness"]]
Torque = Annotated[float, _reads("torque"), DIMENSIONS["torque"]]
Pressure = Annotated[float, _reads("pressure"), DIMENSIONS["pressure"]]
Viscosity = Annotated[float, _reads("viscosity"), DIMENSIONS["viscosity"]]

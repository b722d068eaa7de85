"""The values that one field of a specification takes in a sweep: lists, ranges, random draws."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from torsade.errors import QuantityError, TorsadeError, quoted
from torsade.protocols.sentences import dimension_of, sentence_of_unknown
from torsade.units import Dimension, exact, quantity

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.protocols.base import Spec

__all__ = ["DESIGNS", "MOST_VALUES", "check_field", "draws", "numbers", "values"]

DESIGNS = ("uniform", "sobol", "latin")
"""How random designs fill the space of their fields."""

MOST_VALUES = 10_000_000
"""Of one field; more are a mistake."""

EXAMPLE = '["1 cm", "2 cm"] or { from = "1 cm", to = "2 cm", count = 5 }'


def check_field(spec: type[Spec], name: str) -> None:
    """Refuse what is no field of a protocol; the nearest is named."""
    if name == "protocol" or name not in spec.model_fields:
        raise TorsadeError(
            "protocol stands at the top of the file, once; leave it out elsewhere"
            if name == "protocol"
            else sentence_of_unknown(spec, name)
        )


def values(spec: type[Spec], name: str, given: object, where: str) -> list[Any]:
    """All values of a field that is given as a list or a range.

    Parameters
    ----------
    spec : of the protocol
    name : of the field
    given : [a, b, ...], or a table of `from`, `to` and `count`, `step` or neither for whole numbers;
        `scale = "log"` spaces them evenly in the logarithm
    where : the table that it stands in, for messages

    Returns
    -------
    list
        Floats in SI units, whole numbers, or text, in the order given. Those of a range are the floats that
        the same values written out are.

    Raises
    ------
    TorsadeError
        When it is neither, is empty, or has a unit of another kind.
    """
    check_field(spec, name)
    label = f"{name} in {where}"
    if isinstance(given, Mapping):
        return _range(spec, name, given, label)
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise TorsadeError(f"{label} is {quoted(given)}; give a list or a range, such as {EXAMPLE}")
    if not given:
        raise TorsadeError(f"{label} is an empty list; give at least one value")
    dimension = dimension_of(spec.model_fields[name])
    return [_number(value, dimension, label) if dimension else value for value in given]


def _number(value: Any, dimension: Dimension, label: str) -> float:
    try:
        return quantity(value, dimension.name)
    except QuantityError as error:
        raise TorsadeError(f"{label}: {error}") from None


def _is_whole(spec: type[Spec], name: str) -> bool:
    return "int" in str(spec.model_fields[name].annotation)


def _range(spec: type[Spec], name: str, given: Mapping[str, Any], label: str) -> list[Any]:
    first, last = _bounds(spec, name, given, label, ("from", "to", "count", "step", "scale"))
    if _is_log(given, first, last, label):
        count = _count(given.get("count"), label)
        ratio = float(last) / float(first)
        inner = [float(first) * ratio ** (k / (count - 1)) for k in range(1, count - 1)]
        found: list[Any] = [float(first), *inner, float(last)]
    else:
        step, count = _steps(spec, name, given, first, last, label)
        found = [first + k * step for k in range(count)]
    if not _is_whole(spec, name):
        return [float(x) for x in found]
    broken = next((float(x) for x in found if x != int(x)), None)
    if broken is not None:
        raise TorsadeError(
            f"{label} has {broken:g} in it and takes whole numbers; give another count or step"
        )
    return [int(x) for x in found]


def _bounds(
    spec: type[Spec], name: str, given: Mapping[str, Any], label: str, known: Sequence[str]
) -> tuple[Fraction, Fraction]:
    """First and last of a range, in SI units."""
    check_field(spec, name)
    unknown = next((k for k in given if k not in known), None)
    if unknown is not None:
        raise TorsadeError(f"{label} has {unknown!r}, which no range has; it takes {', '.join(known)}")
    for end in ("from", "to"):
        if end not in given:
            raise TorsadeError(f"{label} has no {end!r}; give both ends, such as {EXAMPLE}")
    dimension = dimension_of(spec.model_fields[name])
    if dimension is None and not _is_whole(spec, name):
        raise TorsadeError(f"{label} takes names, which have no range; give a list")
    first, last = (_exact(given[end], dimension, label) for end in ("from", "to"))
    if first == last:
        raise TorsadeError(f"{label} begins and ends with {quoted(given['to'])}; give it under [fixed]")
    return first, last


def _exact(value: Any, dimension: Dimension | None, label: str) -> Fraction:
    """A number of SI units, or a whole number where nothing is measured."""
    if dimension is None:
        if not isinstance(value, int) or isinstance(value, bool):
            raise TorsadeError(f"{label} has {quoted(value)}; give a whole number")
        return Fraction(value)
    try:
        return exact(value, dimension.name)
    except QuantityError as error:
        raise TorsadeError(f"{label}: {error}") from None


def _is_log(given: Mapping[str, Any], first: Fraction, last: Fraction, label: str) -> bool:
    scale = given.get("scale", "linear")
    if scale not in ("linear", "log"):
        raise TorsadeError(f"scale of {label} is {quoted(scale)}; give linear or log")
    if scale == "log" and min(first, last) <= 0:
        raise TorsadeError(f"{label} goes to 0 or below, where there is no logarithm; give ends above 0")
    return bool(scale == "log")


def _count(given: object, label: str) -> int:
    if not isinstance(given, int) or isinstance(given, bool) or not 2 <= given <= MOST_VALUES:
        was = "is missing" if given is None else f"is {quoted(given)}"
        raise TorsadeError(f"count of {label} {was}; give a whole number from 2 to {MOST_VALUES}")
    return given


def _steps(
    spec: type[Spec], name: str, given: Mapping[str, Any], first: Fraction, last: Fraction, label: str
) -> tuple[Fraction, int]:
    """Step and number of values of an even range."""
    if "step" not in given and ("count" in given or not _is_whole(spec, name)):
        count = _count(given.get("count"), label)
        return (last - first) / (count - 1), count
    if "count" in given:
        raise TorsadeError(f"{label} has count and step; give one of them")
    step = _exact(given.get("step", 1), dimension_of(spec.model_fields[name]), f"step of {label}")
    if step <= 0:
        raise TorsadeError(f"step of {label} is {quoted(given['step'])}; give more than 0")
    steps = abs(last - first) / step
    if steps >= MOST_VALUES:
        raise TorsadeError(f"{label} has more than {MOST_VALUES} values; give a longer step")
    return (step if last > first else -step), int(steps) + 1


def draws(
    spec: type[Spec], fields: Mapping[str, Any], count: int, seed: int, design: str
) -> dict[str, list[Any]]:
    """Random values of fields, each a list to choose from or a range; by name, count of each.

    A larger count of `uniform` or `sobol` begins with the values of a smaller one; that of `latin` does not.
    """
    where = "[random.fields]"
    drawn = numbers(sorted(fields), count, seed, design)
    return {name: _placed(spec, name, fields[name], drawn[name], f"{name} in {where}") for name in fields}


def numbers(names: Sequence[str], count: int, seed: int, design: str) -> dict[str, Floats]:
    """Numbers in [0, 1), shape (count,), by name: independent, or spread evenly over all names together.

    `uniform` gives every name a stream of its own, `sobol` scrambled Sobol points, `latin` a Latin hypercube.
    """
    import numpy as np

    if design == "uniform":
        return {name: np.random.default_rng([seed, *name.encode()]).random(count) for name in names}
    from scipy.stats import qmc

    rng = np.random.default_rng(seed)
    if design == "latin":
        table = qmc.LatinHypercube(len(names), rng=rng).random(count)
    else:
        table = qmc.Sobol(len(names), rng=rng).random_base2(math.ceil(math.log2(count)))[:count]
    return {name: table[:, k] for k, name in enumerate(names)}


def _placed(spec: type[Spec], name: str, given: object, drawn: Floats, label: str) -> list[Any]:
    """Values of a field at numbers in [0, 1)."""
    if not isinstance(given, Mapping):
        choices = values(spec, name, given, "[random.fields]")
        return [choices[int(u * len(choices))] for u in drawn]
    first, last = _bounds(spec, name, given, label, ("from", "to", "scale"))
    first, last = min(first, last), max(first, last)
    log = _is_log(given, first, last, label)
    if _is_whole(spec, name):
        if log:
            raise TorsadeError(f"{label} takes whole numbers, which are drawn evenly; leave scale out")
        return [int(first) + int(u * (int(last - first) + 1)) for u in drawn]
    low, high = float(first), float(last)
    if log:
        return [min(high, low * math.exp(u * math.log(high / low))) for u in drawn]
    return [low + float(u) * (high - low) for u in drawn]

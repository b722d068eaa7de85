"""What is wrong with a specification, in one sentence."""

from __future__ import annotations

import difflib
import math
from typing import TYPE_CHECKING, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from torsade.errors import QuantityError, TorsadeError, quoted
from torsade.units import Dimension, indefinite

if TYPE_CHECKING:
    from torsade.protocols.base import Spec

__all__ = ["dimension_of", "sentence", "sentence_of_unknown"]

PROPER = ("Reidemeister",)
"""Words that stay capitals within a sentence."""


def dimension_of(field: FieldInfo) -> Dimension | None:
    """What a field of a specification measures; None for names and counts."""
    found = [m for m in field.metadata if isinstance(m, Dimension)]
    for choice in get_args(field.annotation):
        found += [m for m in getattr(choice, "__metadata__", ()) if isinstance(m, Dimension)]
    return found[0] if found else None


def sentence(spec: type[Spec], error: ValidationError) -> str:
    """The first of pydantic's complaints, as what was given, what was expected and what to do."""
    complaints = error.errors()
    # A misspelt field explains the one that is missing.
    first = next((c for c in complaints if c["type"] == "extra_forbidden"), complaints[0])
    name = str(first["loc"][0]) if first["loc"] else ""
    if first["type"] == "int_parsing_size":
        return f"{name} has more digits than a number of its kind can have; give a smaller one"
    kind, given, context = first["type"], quoted(first["input"]), first.get("ctx", {})
    reason = context.get("error")
    if isinstance(reason, TorsadeError):
        return f"{name} {reason}" if name and isinstance(reason, QuantityError) else str(reason)
    if kind == "extra_forbidden":
        return sentence_of_unknown(spec, name)
    if kind == "missing":
        wanted = (spec.model_fields[name].description or "").rstrip(".")
        begin = wanted[:1] if wanted.startswith(PROPER) else wanted[:1].lower()
        return f"{name} is missing; give a {begin}{wanted[1:]}"
    if kind == "literal_error":
        choices = context["expected"].replace("'", "").replace(" or ", ", ").split(", ")
        near = difflib.get_close_matches(str(first["input"]), choices, n=1)
        hint = f"did you mean {near[0]!r}? " if near else ""
        return f"{name} is {given}; {hint}choose one of {', '.join(choices)}"
    bounds = {
        "greater_than": ("above", "gt"),
        "greater_than_equal": ("of at least", "ge"),
        "less_than": ("below", "lt"),
        "less_than_equal": ("of at most", "le"),
    }
    if kind in bounds:
        word, key = bounds[kind]
        field = spec.model_fields[name]
        dimension = dimension_of(field)
        what = indefinite(dimension.name) if dimension else "a number"
        unit = f" {dimension.unit}" if dimension and dimension.unit else ""
        if dimension and dimension.name == "angle" and context[key]:
            unit += f" ({math.degrees(context[key]):.3g} deg)"
        return f"{name} is {given}; give {what} {word} {quoted(context[key])}{unit}"
    return f"{name} is {given}; {_expected(spec, name)}"


def sentence_of_unknown(spec: type[Spec], name: str) -> str:
    """That a protocol has no such field, and what may be meant."""
    if name in spec.hints:
        return spec.hints[name]
    known = [k for k in spec.model_fields if k != "protocol"]
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]!r}?" if near else f"choose among {', '.join(known)}"
    return f"{spec.model_fields['protocol'].default} has no field {quoted(name)}; {hint}"


def _expected(spec: type[Spec], name: str) -> str:
    field = spec.model_fields[name]
    dimension = dimension_of(field)
    if dimension:
        return f'give {indefinite(dimension.name)} such as "{dimension.example}"'
    if "int" in str(field.annotation):
        return "give a whole number"
    return f'give text such as "{field.examples[0]}"' if field.examples else "give text"

"""Any value in any field of any specification: a valid one that survives being stored, or one sentence."""

from __future__ import annotations

import math
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsade.errors import TorsadeError
from torsade.protocols import PROTOCOLS
from torsade.units import DIMENSIONS

sys.path.insert(0, str(Path(__file__).parents[2]))

from fuzz.samples import FIELDS
from fuzz.targets import checked_spec, one_sentence

UNITS = sorted(
    {d.unit for d in DIMENSIONS.values()} | {"mm", "deg", "GPa", "kg", "%", "furlong", "m^99", "µm"}
)

NUMBERS = (
    st.sampled_from([0, -0.0, 1, -1, 2**63, 10**400, math.nan, math.inf, -math.inf, 1e308, 5e-324, 1e-155])
    | st.floats()
    | st.integers()
    | st.floats(1e-12, 1e12)
)

TEXTS = (
    st.builds(lambda x, unit: f"{x} {unit}", NUMBERS, st.sampled_from(UNITS))
    | st.sampled_from(
        ["", " ", "-x", "line", "R2", "published", "silicone", "reef", "open 5_2", "5,-3", "a.csv"]
    )
    | st.sampled_from(["\0", "\ud800", "a\nb", "one. two", "\x1b[31m", "９ mm", "9" * 5000, "(" * 3000])
    | st.text(max_size=20)
)

OTHERS = st.sampled_from(
    [None, True, False, b"1 mm", Decimal("NaN"), Fraction(1, 3), 1 + 2j, object(), [], [1], {}, {"a": 1}, int]
)

VALUES = NUMBERS | TEXTS | OTHERS | st.lists(TEXTS, max_size=2)


def names(protocol: str) -> st.SearchStrategy[str]:
    fields = sorted(PROTOCOLS[protocol].model_fields)
    return st.sampled_from([*fields, *fields, *PROTOCOLS[protocol].hints, "zzz", "", "a b", "\n"])


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
@settings(deadline=None, derandomize=True, max_examples=150)
@given(data=st.data())
def test_any_fields_are_understood_or_refused_in_one_sentence(protocol: str, data: st.DataObject) -> None:
    sound: dict[str, Any] = FIELDS[protocol] if data.draw(st.integers(0, 3)) else {}
    changed = data.draw(st.dictionaries(names(protocol), VALUES, max_size=3))
    try:
        spec = PROTOCOLS[protocol](**(sound | changed))
    except TorsadeError as error:
        one_sentence(str(error))
    else:
        checked_spec(spec)


@pytest.mark.parametrize("protocol", sorted(PROTOCOLS))
def test_sound_fields_are_understood(protocol: str) -> None:
    checked_spec(PROTOCOLS[protocol](**FIELDS[protocol]))

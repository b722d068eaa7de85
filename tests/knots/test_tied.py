"""Bends by name: which tangle they are, and which ends they are pulled by."""

from __future__ import annotations

import pytest

from torsade.errors import TorsadeError
from torsade.knots import bend, bend_names
from torsade.knots.bends import usual_name
from torsade.topology import state


@pytest.mark.parametrize(
    ("name", "called", "pulled"),
    [
        ("Reef knot", "reef", "A1B1"),
        ("thief", "thief", "A1B0"),
        ("what-knot", "grief", "A1B0"),
        ("weaver", "sheet_bend", "A1B1"),
    ],
)
def test_names(name: str, called: str, pulled: str) -> None:
    built = bend(name)
    assert (built.name, built.pulled) == (called, pulled)
    assert bend(name, pulled="a0b0").pulled == "A0B0"


def test_every_word_stands_for_itself() -> None:
    assert [usual_name(word) for word in bend_names() if word in ("reef", "thief", "grief", "zeppelin")]
    assert usual_name("bread bag") == "thief"


def test_pulls_set_signs() -> None:
    """Pulled by A1 and B0 one strand runs the other way: signs between the two change."""
    reef, thief = (state(bend("reef", pulled=ends)) for ends in ("A1B1", "A1B0"))
    assert sum(reef.charges) == sum(thief.charges) == 0
    granny, grief = (state(bend("granny", pulled=ends)) for ends in ("A1B1", "A1B0"))
    assert sum(granny.charges) == -sum(grief.charges) == 6


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"name": "zepelin"}, "did you mean 'zeppelin'"),
        ({"name": "reef", "pulled": "A1A0"}, "choose one of A1B1, A1B0, A0B1, A0B0"),
        ({"name": "reef", "lead": "0.1 mm"}, "lead is 0.0001 m; give 0.001 to 2 m"),
        ({"name": "reef", "radius": "1 kg"}, "radius '1 kg' is a mass, not a length"),
    ],
)
def test_refusals(arguments: dict[str, object], says: str) -> None:
    with pytest.raises(TorsadeError, match=says):
        bend(**arguments)  # type: ignore[arg-type]

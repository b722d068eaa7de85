"""Work put into a bend that is pulled is stored or dissipated, at the default tolerance."""

from __future__ import annotations

import pytest

from torsade.protocols import PrisonEscape


@pytest.mark.parametrize("knot", ["reef", "grief"])
def test_work_is_accounted_for(knot: str) -> None:
    """W = dissipation + change of stored energy within 0.5 % at every frame, slack take-up included."""
    data = PrisonEscape(knot=knot, duration=0.3, frames=30).run().dataset
    stored = sum(data[f"energy_{kind}"] for kind in ("stretch", "bend", "twist", "contact"))
    missing = data["external_work"] - data["dissipation"] - (stored - stored[0])
    assert float(data["external_work"][-1]) > 0.05
    assert float(abs(missing).max()) < 5e-3 * float(data["external_work"][-1])

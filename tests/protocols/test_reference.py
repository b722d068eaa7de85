"""The published preset against the thesis's own program, on its own centerlines (data/README.md).

The program writes separations x(pulled) - x(clamped) and c_f = F 2h/(eta A v) over 0.3 s ≤ t ≤ 1 s, run
with dt = 1e-4 s on the nylon preset at 15 N, and on the trefoil at 0.02 N.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from torsade.protocols import PrisonEscape, Tighten

pytestmark = pytest.mark.slow

BENDS = {
    "reef": ((9.375, 13.414, 18.251), 48.9),
    "granny": ((10.226, 15.453, 21.765), 37.6),
    "grief": ((12.824, 20.954, 30.747), 24.3),
    "carrick14": ((9.394, 12.946, 15.643), 88.7),
    "zeppelin14": ((9.759, 11.937, 14.633), 88.5),
    "alpine24": ((9.846, 12.385, 15.602), 74.1),
}
"""Separation [mm] at 0.1, 0.5 and 1 s, and c_f."""

TREFOIL = {
    0.01: (12.540, 20.166, 0.327),
    0.10: (12.879, 20.215, 0.345),
    0.30: (13.595, 20.324, 0.393),
    0.50: (14.268, 20.431, 0.439),
    1.00: (15.709, 20.682, 0.532),
}
"""End-to-end distance [mm], length [mm] and h kappa_max at times [s]."""


@pytest.mark.parametrize("name", BENDS)
def test_published_bends(bends: Path, name: str) -> None:
    separations, c_f = BENDS[name]
    data = PrisonEscape(centerline=str(bends / f"{name}.csv"), preset="published").run().dataset
    found = 1e3 * np.interp([0.1, 0.5, 1.0], data["time"], data["separation"])
    np.testing.assert_allclose(found, separations, rtol=0.02)
    assert data.attrs["c_f"] == pytest.approx(c_f, rel=0.03)
    assert "slipped_at_s" not in data.attrs


def test_the_published_thief_slips(bends: Path) -> None:
    result = PrisonEscape(centerline=str(bends / "thief.csv"), preset="published").run()
    assert result.slipped_at is not None
    assert 0.6 < result.slipped_at < 1.1
    assert result.c_f is not None
    assert 34 < result.c_f < 39


def test_the_published_trefoil(bends: Path) -> None:
    data = Tighten(centerline=str(bends / "trefoil.csv"), preset="published").run().dataset
    for t, (distance, length, h_kappa) in TREFOIL.items():
        frame = data.sel(time=t, method="nearest")
        assert 1e3 * float(frame["end_to_end"]) == pytest.approx(distance, rel=0.01)
        assert 1e3 * float(frame["length"]) == pytest.approx(length, rel=0.01)
        assert float(frame["h_kappa_max"]) == pytest.approx(h_kappa, rel=0.03)


def test_the_published_trefoil_at_rest(bends: Path) -> None:
    spec = Tighten(centerline=str(bends / "trefoil.csv"), preset="published", duration="5 s", frames=5)
    data = spec.run().dataset
    assert 1e3 * float(data["end_to_end"][-1]) == pytest.approx(18.613, rel=0.02)

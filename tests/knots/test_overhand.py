"""The overhand knot: a trefoil, clear of itself, smooth, with its ends on one line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.distance import cdist

import torsade as ts
from knots.diagram import crossings
from torsade.knots import overhand

H = 2e-4


@pytest.mark.parametrize("spacing", [0.1, 0.5, 1.0])
def test_it_is_a_trefoil(spacing: float) -> None:
    """Three crossings that alternate, all of one sign: with its ends closed far away, a trefoil."""
    shape = overhand(H, spacing=spacing * H)
    found = crossings(shape.strands)
    assert len(found) == 3
    assert {sign for *_, sign in found} == {1}
    visits = sorted([(over, "O") for over, _, _ in found] + [(under, "U") for _, under, _ in found])
    assert "".join(level for _, level in visits) in ("OUOUOU", "UOUOUO")


@pytest.mark.parametrize(("spacing", "least"), [(0.1, 2.1), (0.5, 2.1), (1.0, 2.04)])
def test_it_is_clear_of_itself_and_smooth(spacing: float, least: float) -> None:
    (x,) = overhand(H, spacing=spacing * H).strands
    l = np.linalg.norm(np.diff(x, axis=0), axis=1)
    s = np.concatenate([[0], np.cumsum(l)])
    assert l.max() <= spacing * H * (1 + 1e-9)
    assert cdist(x, x)[np.abs(s[:, None] - s) > math.pi * H * 2].min() > least * H
    a, b = x[1:-1] - x[:-2], x[2:] - x[1:-1]
    sides = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1) * np.linalg.norm(a + b, axis=1)
    assert (2 * H * np.linalg.norm(np.cross(a, b), axis=1) / sides).max() < 0.44


def test_its_ends_leave_along_one_line() -> None:
    (x,) = overhand(H, lead="8 mm").strands
    np.testing.assert_allclose(x[[0, 1, -2, -1], 1:], 0.0, atol=1e-12)
    assert x[0, 0] < x[1, 0] < 0 < x[-2, 0] < x[-1, 0]
    np.testing.assert_allclose(x[::-1] * [-1, 1, -1], x, atol=1e-12)
    assert x[-1, 0] > 8e-3


def test_sizes_scale_with_the_radius() -> None:
    np.testing.assert_allclose(overhand("0.4 mm").strands[0], 2 * overhand("0.2 mm").strands[0], rtol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"radius": -1.0}, "radius is -1 m"),
        ({"radius": "1 kg"}, "radius '1 kg' is a mass, not a length"),
        ({"lead": "0.1 mm"}, "lead is 0.0001 m; give 0.001 to 2 m"),
        ({"spacing": 1.0}, "spacing is 1 m"),
    ],
)
def test_lengths_out_of_range(arguments: dict[str, object], says: str) -> None:
    with pytest.raises(ts.TorsadeError, match=says):
        overhand(**arguments)  # type: ignore[arg-type]


def test_it_is_tightened() -> None:
    spec = ts.protocols.Tighten(knot="overhand", duration="0.1 s", frames=4)
    result = spec.run()
    report = ts.protocols.Tighten.report(result)
    assert result.dataset.attrs["knot"] == "overhand"
    assert np.all(np.diff(report["end_to_end_m"]) > 0)
    assert report["h_kappa_max"][-1] > 0.2

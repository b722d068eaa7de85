"""Pictures of rods that break: the data behind them, and that they are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.protocols import SnapTwist
from torsade.view.cascade import along_rod, draw_pieces, pieces_at, plot_cascade


@pytest.fixture(scope="module")
def broken():
    return SnapTwist(twist="60 deg", duration="0.4 ms", frames=10).run().dataset


def test_pieces_join_at_the_first_break(broken) -> None:
    first = pieces_at(broken, 0)
    assert len(first) == 2
    np.testing.assert_allclose(first[0][-1], first[1][0], atol=1e-7)
    assert len(pieces_at(broken, -1)) == broken.attrs["fragments"]


def test_values_along_the_rod_are_those_of_its_pieces(broken) -> None:
    """At the first frame stress is largest, and close to the strength, beside the break, and 0 at it."""
    place, stress = along_rod(broken, "stress")
    assert place[[0, -1]].tolist() == [0.0, 0.24]
    assert stress.shape == (broken.sizes["time"], 49)
    assert stress[0, 24] == 0.0
    assert stress[0, [23, 25]] == pytest.approx([1.9e7] * 2, rel=0.01)
    np.testing.assert_allclose(stress[0], stress[0, ::-1], rtol=1e-4)


@pytest.mark.parametrize("draw", [plot_cascade, draw_pieces])
def test_something_is_drawn(broken, tmp_path: Path, draw) -> None:
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    image = imread(draw(broken, tmp_path / "rod.png"))[:, :, :3]
    dark = (image.min(axis=2) < 0.7).mean()
    assert 0.01 < dark < 0.6


def test_other_results_are_refused(tmp_path: Path, broken) -> None:
    with pytest.raises(ts.TorsadeError, match=r"not of a rod that breaks: it lacks piece_start"):
        draw_pieces(broken.drop_vars("piece_start"), tmp_path / "a.png")

"""Pictures of batteries: shapes and curves are drawn, of those cut and of those that are only charged."""

from __future__ import annotations

from pathlib import Path

import pytest

import torsade as ts
from torsade.protocols import Battery
from torsade.view.battery import draw_battery, plot_battery, shapes
from torsade.view.plots import ENERGIES

SHORT = {"knot": "3_1", "twist": 2.0, "nodes": 60, "charging": "0.1 s", "frames": 8}


@pytest.fixture(scope="module")
def cut():
    return Battery(**SHORT, duration="0.1 s").run().dataset


@pytest.mark.parametrize("draw", [draw_battery, plot_battery])
@pytest.mark.parametrize("stop", ["discharged", "charged"])
def test_something_is_drawn(cut, stop: str, tmp_path: Path, draw) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("pyvista")
    from matplotlib.image import imread

    data = cut if stop == "discharged" else Battery(**SHORT, stop="charged").run().dataset
    image = imread(draw(data, tmp_path / "battery.png"))[:, :, :3]
    assert 0.005 < (image.min(axis=2) < 0.7).mean() < 0.7


def test_a_frame_below_two_shares_is_drawn_once(cut) -> None:
    """With all energy gone from one frame to the next, 50, 10 and 1 % are first seen in the same."""
    data = cut.isel(time=slice(0, 2)).copy(deep=True)
    for kind in ENERGIES:
        data[f"energy_{kind}"].values[1] *= 1e-3
    assert [shape.closed for shape in shapes(data)] == [True, False]


def test_other_results_are_refused(cut, tmp_path: Path) -> None:
    with pytest.raises(ts.TorsadeError, match=r"cannot be drawn: it lacks charge_position"):
        draw_battery(cut.drop_vars("charge_position"), tmp_path / "a.png")

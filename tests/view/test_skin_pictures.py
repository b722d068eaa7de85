"""Skin in pictures: cylinders where they are, through which the strand is seen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.protocols import Suture
from torsade.view.plots import plot_wound
from torsade.view.scene import picture, render_result
from torsade.view.skin import Skin, skin_at, skin_over_time


@pytest.fixture(scope="module")
def data():
    return Suture(throws="3,-3", duration="40 ms", frames=4, skin_radius="1 mm").run().dataset


def test_cylinders_are_round_and_where_they_are():
    skin = Skin(np.array([[1e-3, 2e-3, 0.0]]), 0.5e-3)
    (mesh,) = skin.meshes(np.zeros(3), 1e-4)
    across = np.linalg.norm(mesh.vertices[:, :2] - [10.0, 20.0], axis=1)
    assert across.max() == pytest.approx(5.0, rel=1e-9)
    assert abs(mesh.vertices[:, 2]).max() == pytest.approx(9.6, rel=1e-9)  # with its rounded edge
    assert mesh.volume() == pytest.approx(np.pi * 25 * 19.2, rel=0.02)


def test_between_frames_skin_moves_straight(data):
    at = skin_over_time(data)
    assert at is not None
    t = 0.5 * float(data["time"][1] + data["time"][2])
    middle = 0.5 * (skin_at(data, 1).centres + skin_at(data, 2).centres)
    assert at(t).centres == pytest.approx(middle, rel=1e-12)
    assert skin_at(data.drop_vars("skin_position"), 0) is None
    assert skin_over_time(data.drop_vars("skin_position")) is None


def test_the_strand_is_seen_through_the_skin():
    """A strand behind a cylinder is paler than without it, and seen."""
    pytest.importorskip("pyvista")
    x = np.column_stack([np.linspace(-8e-3, 8e-3, 60), np.zeros(60), np.full(60, -4e-3)])
    options = {"size": (320, 240), "direction": (0.0, 0.0, 1.0), "whole": True}
    bare = picture([x], False, 2e-4, **options)
    covered = picture([x], False, 2e-4, skin=Skin(np.zeros((1, 3)), 2e-3), **options)
    middle = bare.shape[0] // 2, bare.shape[1] // 2
    assert np.abs(covered - bare)[middle].max() > 0.1
    off = middle[0] + 10, middle[1]
    assert bare[off].min() > 0.99
    assert np.abs(covered[middle] - covered[off]).max() > 0.1


@pytest.mark.parametrize("draw", [render_result, plot_wound])
def test_something_is_drawn(data, tmp_path: Path, draw) -> None:
    pytest.importorskip("pyvista")
    imread = pytest.importorskip("matplotlib.image").imread
    image = imread(draw(data, tmp_path / "a.png"))[:, :, :3]
    assert 0.005 < (image.min(axis=2) < 0.9).mean() < 0.9


@pytest.mark.parametrize("model", ["{}", "3", '{"skin_radius": "x"}', '{"skin_radius": -1}', "{"])
def test_skin_of_no_thickness_is_refused(data, model: str) -> None:
    with pytest.raises(TorsadeError, match="how thick"):
        skin_at(data.assign_attrs(model=model), 0)

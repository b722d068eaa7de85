"""The window of `torsade open`, drawn without one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.view.window import Window

pytest.importorskip("pyvista")


def dark(image: np.ndarray) -> np.ndarray:
    return np.asarray(image[:780].min(axis=2) < 200)  # above the slider


@pytest.mark.parametrize("protocol", ["tighten", "bend-twist", "snap-twist"])
def test_everything_is_in_the_window(protocol: str, stored: Callable[[str], Path]) -> None:
    window = Window(ts.open(stored(protocol)).dataset, hidden=True)
    try:
        seen = dark(window.plotter.screenshot(None, return_img=True))[60:]  # below the note
    finally:
        window.plotter.close()
    rows, columns = np.nonzero(seen)
    assert columns.min() > 5
    assert columns.max() < seen.shape[1] - 5
    assert columns.max() - columns.min() > 0.5 * seen.shape[1]
    assert rows.min() > 0


def test_frames_are_gone_through(stored: Callable[[str], Path]) -> None:
    window = Window(ts.open(stored("snap-twist")).dataset, hidden=True)
    try:
        first = window.plotter.screenshot(None, return_img=True)
        window.go_to(99)
        last = window.plotter.screenshot(None, return_img=True)
        assert window.frame == 20
        assert (first != last).any()
        window.go_to(-5)
        assert window.frame == 0
        np.testing.assert_array_equal(window.plotter.screenshot(None, return_img=True), first)
    finally:
        window.plotter.close()


def test_skin_is_in_the_window_and_moves(stored: Callable[[str], Path]) -> None:
    """It is seen where it is, all of it, the strand through it; in another frame it is elsewhere."""
    data = ts.open(stored("suture")).dataset
    aside = data["skin_position"].copy()
    aside[-1] += [float(data.attrs["radius"]) * 4, 0, 0]
    window = Window(data.assign(skin_position=aside), hidden=True)
    bare = Window(data.drop_vars("skin_position"), hidden=True)
    bare.plotter.camera = window.plotter.camera.copy()
    images = []
    for frame in (0, data.sizes["time"] - 1):
        for shown in (window, bare):
            shown.go_to(frame)
            images.append(shown.plotter.screenshot(None, return_img=True)[:780].astype(int))
    window.plotter.close()
    bare.plotter.close()
    covered = np.abs(images[0] - images[1]).max(axis=2) > 8
    rows, columns = np.nonzero(covered)
    assert covered.mean() > 0.03
    assert 5 < columns.min() < columns.max() < covered.shape[1] - 5
    assert rows.min() > 0
    through = images[0][covered & dark(images[1])]
    assert len(through) > 100
    assert (through[:, 0] - through[:, 2]).mean() > 30  # red, not the white or grey of skin alone
    later = np.nonzero(np.abs(images[2] - images[3]).max(axis=2) > 8)[1]
    assert later.mean() > columns.mean() + 20

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

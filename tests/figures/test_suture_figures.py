"""Figures of chapter 6, from short runs: their tables, and that they are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from torsade.figures import figure
from torsade.figures.base import Choice
from torsade.figures.runs import results

QUICK = Choice(quick=True)


@pytest.mark.slow
def test_figures_of_sutures(tmp_path: Path) -> None:
    """One run of the first figure is one of the second; the table holds what the throws say, and symmetry."""
    pytest.importorskip("pyvista")
    image = pytest.importorskip("matplotlib.image")
    runs = {}
    for number, pixels in (("6-2", 2000), ("6-1", 2000)):
        wanted = figure(number)
        found = results(wanted.runs(QUICK), tmp_path / "runs", workers=1)
        runs[number] = set(found)
        tables = wanted.measure(found, QUICK)
        wanted.draw(found, tables, QUICK, wanted.file(tmp_path))
        assert image.imread(wanted.file(tmp_path)).shape[1] > pixels
        z, other = (np.asarray(tables[""].column(f"z_{side}_m"), float) for side in "ab")
        np.testing.assert_allclose(z, -other, atol=1e-11)
        relative = np.asarray(tables[""].column("z_relative_m"), float)
        np.testing.assert_allclose(relative, 2 * np.abs(z), rtol=1e-4)
    assert runs["6-1"] < runs["6-2"]
    assert figure("6-2").measure({}, QUICK)[""].rows == []

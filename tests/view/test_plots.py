"""Plots hold the curves, units, marks and titles of the result they are made from."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import xarray as xr

from torsade.errors import TorsadeError
from torsade.view import plots

matplotlib = pytest.importorskip("matplotlib")
T = np.linspace(0.0, 1.0, 101)


def bend(**attrs):
    speed = 0.01 + 0.5 * np.exp(-T / 0.005)
    variables = {"separation": ("time", 0.008 + 0.01 * T), "pull_speed": ("time", speed)}
    return xr.Dataset(variables, coords={"time": T}, attrs=attrs)


def knot():
    variables = {"end_to_end": 0.01 + 0.004 * T, "h_kappa_max": 0.3 + 0.2 * T, "total_twist": -0.67 * T}
    return xr.Dataset({k: ("time", v) for k, v in variables.items()}, {"time": T}, {"knot": "trefoil"})


@pytest.fixture(name="figure")
def _figure(monkeypatch):
    """The figure that a plot saves, kept for looking at."""
    kept = {}

    def keep(figure, path):
        kept["figure"] = figure
        return path

    monkeypatch.setattr(plots, "save", keep)
    return lambda: kept["figure"]


def curve(axis):
    return axis.lines[0].get_xydata().T


def test_separation_and_speed_in_millimetres_against_time(figure):
    plots.plot_separation(bend(knot="reef", c_f=48.94), "x.png")
    upper, lower = figure().axes
    assert curve(upper) == pytest.approx(np.stack([T, 8 + 10 * T]))
    assert curve(lower)[1] == pytest.approx(10 + 500 * np.exp(-T / 0.005))
    assert upper.get_ylabel() == "separation (mm)"
    assert lower.get_ylabel() == "pull speed (mm/s)"
    assert lower.get_xlabel() == "time (s)"
    assert "reef" in upper.get_title(loc="left")
    assert "48.9" in upper.get_title(loc="left")


def test_the_first_jerk_does_not_flatten_the_speed_curve(figure):
    plots.plot_separation(bend(), "x.png")
    bottom, top = figure().axes[1].get_ylim()
    assert bottom == 0.0
    assert 10.0 < top < 100.0


@pytest.mark.parametrize("slipped", [0.25, 0.75])
def test_the_slip_time_is_marked(figure, slipped):
    plots.plot_separation(bend(slipped_at_s=slipped), "x.png")
    for axis in figure().axes:
        assert list(axis.lines[1].get_xdata()) == [slipped, slipped]
    assert figure().axes[0].texts[0].get_text() == f"slips at {slipped} s"


@pytest.mark.parametrize("attrs", [{}, {"slipped_at_s": None}, {"slipped_at_s": float("nan"), "c_f": None}])
def test_a_bend_that_holds_has_no_mark(figure, attrs):
    plots.plot_separation(bend(**attrs), "x.png")
    upper = figure().axes[0]
    assert len(upper.lines) == 1
    assert not upper.texts
    assert upper.get_title(loc="left") == ""


def test_tightening_has_three_panels_over_one_time_axis(figure):
    plots.plot_tightening(knot(), "x.png")
    distance, bending, twist = figure().axes
    assert curve(distance)[1] == pytest.approx(10 + 4 * T)
    assert curve(bending)[1] == pytest.approx(0.3 + 0.2 * T)
    assert curve(twist)[1] == pytest.approx(-0.67 * T)
    assert distance.get_xlim() == twist.get_xlim() == (0.0, 1.0)
    assert distance.get_title(loc="left") == "trefoil"


def test_a_move_shows_stored_energies_and_crossings_against_the_way(figure):
    parts = {"bend": 3 - T, "twist": T, "stretch": 0 * T + 0.5, "contact": 0.1 * T}
    variables = {f"energy_{kind}": ("time", 1e-9 * e) for kind, e in parts.items()}
    variables |= {"displacement": ("time", 0.02 * T), "crossings": ("time", (T < 0.5).astype(float))}
    plots.plot_move(xr.Dataset(variables, {"time": T}, {"knot": "R1"}), "x.png")
    upper, lower = figure().axes
    shown = {line.get_label(): line.get_xydata().T for line in upper.lines}
    assert shown["all"] == pytest.approx(np.stack([20 * T, 3.5 + 0.1 * T]))
    assert shown["twist"][1] == pytest.approx(T)
    assert curve(lower)[1].tolist() == [1.0] * 50 + [0.0] * 51
    assert upper.get_title(loc="left") == "R1"


def arch(height):
    """Half an ellipse over 190 mm, one frame of it, off its plane by 2 mm."""
    s = np.linspace(0.0, np.pi, 41)
    x = np.stack([0.095 * (1 - np.cos(s)), height * np.sin(s), 0.002 * np.sin(2 * s)], axis=1)
    variables = {
        "position": (("time", "node", "space"), x[None]),
        "curvature": (("time", "node"), 5 + np.sin(s)[None]),
        "twist": (("time", "fiber"), [[np.radians(270)]]),
    }
    return xr.Dataset(variables, {"time": [0.0]})


@pytest.mark.parametrize("height", [0.02, 0.065, 0.3])
def test_a_bent_fiber_is_whole_and_in_proportion(figure, height):
    plots.plot_bent(arch(height), "x.png")
    side, above, bend = figure().axes
    assert curve(side)[1].max() == pytest.approx(1e3 * height)
    for axis in (side, above, bend):
        x, y = curve(axis)
        (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
        assert left <= x.min() < x.max() <= right
        assert low <= y.min() < y.max() <= high
    assert side.get_aspect() == 1.0
    assert above.get_xlim() == pytest.approx(side.get_xlim(), abs=3)
    assert bend.get_ylim()[0] == 0
    assert side.get_title(loc="left") == "ends 190 mm apart,  total twist 270°"


@pytest.mark.parametrize(("ending", "start"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")])
def test_the_ending_chooses_the_format(tmp_path, ending, start):
    path = plots.plot_separation(bend(knot="thief", slipped_at_s=0.7), tmp_path / f"a.{ending}")
    assert path.read_bytes().startswith(start)


def test_plots_leave_the_settings_of_the_user_alone(tmp_path):
    before = dict(matplotlib.rcParams)
    plots.plot_tightening(knot(), tmp_path / "a.png")
    assert dict(matplotlib.rcParams) == before
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


def test_what_a_result_lacks_is_named(tmp_path):
    with pytest.raises(TorsadeError, match="pull_speed"):
        plots.plot_separation(bend().drop_vars("pull_speed"), tmp_path / "a.png")
    with pytest.raises(TorsadeError, match="end_to_end, h_kappa_max, total_twist"):
        plots.plot_tightening(bend(), tmp_path / "a.png")


def test_a_dollar_sign_in_a_name_is_no_formula(tmp_path):
    path = plots.plot_separation(bend(knot="a$b_$", c_f=1.0), tmp_path / "a.png")
    assert path.stat().st_size > 1000


@pytest.mark.parametrize("name", ["a.nonsense", "missing/a.png"])
def test_an_unwritable_file_is_named(tmp_path, name):
    with pytest.raises(TorsadeError, match=r"a\."):
        plots.plot_tightening(knot(), tmp_path / name)


def test_a_missing_library_is_named_with_the_way_to_install_it(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(TorsadeError, match=r'pip install "torsade\[view\]"'):
        plots.plot_tightening(knot(), tmp_path / "a.png")

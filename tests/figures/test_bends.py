"""The table that figures of pulled bends share, and the figures, in their quick mode."""

from __future__ import annotations

import csv

import numpy as np
import pytest
import xarray
from scipy import stats

from torsade.cli.figure import draw
from torsade.figures import bends, figure, figure_4_1, figure_4_5, panels, twist_share
from torsade.figures.base import Choice
from torsade.figures.runs import results
from torsade.knots import bend_diagram
from torsade.protocols import PrisonEscape
from torsade.protocols.base import Spec
from torsade.topology import state

QUICK = Choice(quick=True)
NUMBERS = ("4-1", "4-5", "4-6", "4-7", "4-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder that holds all quick runs."""
    place = tmp_path_factory.mktemp("figures")
    results({**bends.specs(QUICK), **twist_share.runs(QUICK)}, place / "runs")
    return place


@pytest.fixture
def nothing_runs(monkeypatch):
    def refuse(self, **options):
        raise AssertionError(f"{self.knot} is run again")

    monkeypatch.setattr(Spec, "run", refuse)


def test_every_bend_is_pulled_once_with_each_preset():
    specs = bends.specs(Choice())

    assert len(specs) == 54
    assert len({spec.knot for spec in specs.values()}) == 27
    assert specs["thief, published"] == PrisonEscape(knot="thief", preset="published")
    assert all(label in bends.specs(QUICK) for label in bends.specs(QUICK, ["reef"]))


def test_the_table_holds_what_reports_and_drawings_say(folder):
    found = results(bends.specs(QUICK), folder / "runs")
    table = bends.table(found, QUICK)

    assert len(table.rows) == len(found) == 10
    for row in table.rows:
        told = dict(zip(table.columns, row, strict=True))
        result = found[f"{told['knot']}, {told['preset']}"]
        report = PrisonEscape.report(result)
        assert {key: told[key] for key in ("c_f", "pull_speed_m_per_s", "slipped_at_s", "c_f_from_s")} == {
            key: report[key] for key in ("c_f", "pull_speed_m_per_s", "slipped_at_s", "c_f_from_s")
        }
        counted = state(bend_diagram(told["knot"]))
        assert (told["N"], told["tau"], told["Gamma"], told["Whitney"]) == (
            counted.crossings, counted.tau, counted.gamma, counted.whitney,
        )  # fmt: skip
        assert told["Gamma_least"] <= told["Gamma_greatest"]
        p = np.array(report["compression_N"])  # five evenly spaced frames: the trapezoidal rule by hand
        assert told["compression_N"] == pytest.approx((p[0] / 2 + p[1:-1].sum() + p[-1] / 2) / 4)
        assert (told["twist_A_rad"], told["twist_B_rad"]) == tuple(row[-1] for row in report["twist_rad"])
        assert told["log_strain_max"] == float(result.dataset["log_strain"][-1].max())
        assert told["holds"] is True
    c_f = [c_f for c_f, preset in zip(table.column("c_f"), table.column("preset"), strict=True)
           if preset == "standard"]  # fmt: skip
    assert c_f == sorted(c_f, reverse=True)


def test_the_window_may_begin_and_end_between_frames():
    t = np.linspace(0, 1, 11)
    data = xarray.Dataset(
        {"compression": ("time", 3 * t), "sample_time": ("sample", t)},
        coords={"time": t},
        attrs={"c_f_from_s": 0.33, "slipped_at_s": 0.78},
    )
    assert bends.window(data) == (0.33, 0.78)
    assert bends.over_window(data, "compression") == pytest.approx(3 * (0.33 + 0.78) / 2)
    del data.attrs["slipped_at_s"]
    assert bends.over_window(data, "compression") == pytest.approx(3 * (0.33 + 1) / 2)


def test_the_same_bend_under_several_names_is_one():
    names = bends.kinds([*bends.labels(Choice()), "mirror zeppelin", "mirror reef", "granny"])

    assert {knot: first for knot, first in names.items() if knot != first} == {
        "hunter24": "hunter13",
        "alpine24": "alpine13",
        "zeppelin_min10": "zeppelin14",
        "mirror zeppelin": "zeppelin14",
        "mirror reef": "reef",
    }
    assert [bends.family(knot) for knot in ("thief", "hunter13", "zeppelin_min10", "water_knot")] == [
        "reef", "hunter", "zeppelin", "water_knot",
    ]  # fmt: skip


def test_bends_that_repeat_another_are_left_out():
    rows = [[knot, "standard"] for knot in bends.labels(Choice())]
    table = bends.Table(bends.COLUMNS, [(*row, *[1.0] * (len(bends.COLUMNS) - 2)) for row in rows])
    found = bends.distinct(table, "standard")

    assert {which: len(columns["knot"]) for which, columns in found.items()} == {
        "thesis": 20,
        "phase diagram": 15,
        "all": 24,
    }


def test_the_ranking_says_the_correlation_of_the_bends_that_it_draws():
    rng = np.random.default_rng(4)
    values = {"c_f": rng.permutation(27), "compression_N": rng.permutation(27)}
    rows = [
        tuple(
            {"knot": knot, "preset": "standard"}.get(c, values.get(c, np.ones(27))[k]) for c in bends.COLUMNS
        )
        for k, knot in enumerate(bends.labels(Choice()))
    ]
    table = bends.Table(bends.COLUMNS, rows)
    axes = panels.new_figure(3, 3).subplots()
    figure_4_1.draw_rankings(
        axes, table, figure_4_1.rankings(table, Choice(presets=("standard",))), "standard"
    )
    of = bends.distinct(table, "standard")["all"]
    tau = stats.kendalltau(of["c_f"], of["compression_N"]).statistic

    assert len(axes.lines) == len(of["knot"]) == 24
    first, second = axes.get_title().split("\n")
    assert first == "standard, 24 bends"
    assert f"= {tau:.2f} [".replace("-", "−") in second


@pytest.mark.parametrize(("knot", "said"), [("thief", "turns −7.9 rad"), ("reef", None)])
def test_a_turn_that_chance_decides_is_not_told(knot, said):
    row = {"knot": knot, "c_f": 30.0, "rotation_rad": -7.88}
    text = figure_4_5._said(row, Choice(presets=("standard",)), {(knot, "standard"): row})

    assert text.splitlines()[1] == "$c_f$ = 30.0" + (f", {said}" if said else "")


def test_names_are_spread_out_no_farther_than_needed():
    apart = panels.spread_out([0.0, 0.1, 5.0, 0.05], 1.0)

    assert apart == pytest.approx([-0.95, 1.05, 5.0, 0.05])  # about their mean 0.05, in their order
    assert panels.spread_out([1.0, 3.0, 2.0], 1.0) == pytest.approx([1.0, 3.0, 2.0])
    assert panels.spread_out([0.0, 0.0], 1.0, low=0.0) == pytest.approx([0.0, 1.0])


@pytest.mark.parametrize("number", NUMBERS)
def test_a_figure_is_drawn_from_stored_runs(number, folder, nothing_runs, capsys):
    wanted = figure(number)
    assert draw(number, str(folder), "both", True, False, "1", True) == 0
    capsys.readouterr()

    png = wanted.file(folder).read_bytes()
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    assert int.from_bytes(png[16:20], "big") == 2160  # 7.2 inches at 300 dots to the inch
    with wanted.file(folder, "").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {row["knot"] for row in rows} == set(bends.QUICK)


def test_one_preset_alone_is_drawn(folder, nothing_runs, capsys):
    for number in NUMBERS:
        assert draw(number, str(folder), "published", True, False, "1", False) == 0
    assert "carrick14" in capsys.readouterr().out


def test_the_whitney_index_tells_the_reef_from_the_thief(folder):
    table = figure("4-6").measure({}, Choice())[""]
    index = dict(zip(table.column("knot"), table.column("Whitney"), strict=True))

    assert (abs(index["reef"]), abs(index["thief"])) == (0, 1)
    for row in table.rows:
        told = dict(zip(table.columns, row, strict=True))
        assert told["counterclockwise"] - told["clockwise"] == told["Whitney"]
        assert told["counterclockwise"] + told["clockwise"] == told["loops"]

"""Figure 4-2 and panel C of 4-1: tables that agree with what was run, and pictures of a quick look."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.figures import figure, move_energies, tightening, twist_share
from torsade.figures.base import Choice, Table
from torsade.figures.runs import results
from torsade.view.colours import STRAIN_TABLE

QUICK = Choice(("standard",), quick=True)


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, ts.Result]:
    return results(figure("4-2").runs(QUICK), tmp_path_factory.mktemp("runs"), workers=1)


@pytest.fixture(scope="module")
def tables(found: dict[str, ts.Result]) -> dict[str, Table]:
    return dict(figure("4-2").measure(found, QUICK))


def column(table: Table, name: str, **where: object) -> np.ndarray:
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    return np.array([r[name] for r in rows if all(r[k] == v for k, v in where.items())], float)


def test_both_figures_share_their_runs() -> None:
    both = Choice()
    assert set(twist_share.runs(both)) <= set(figure("4-2").runs(both))
    assert len(twist_share.runs(both)) == 4


def test_knots_go_on_until_they_are_at_rest() -> None:
    for label, spec in twist_share.runs(Choice()).items():
        assert spec.until_still == 1e-6, label
        assert spec.duration >= 10
        assert spec.spacing == (1e-4 if "published" in label else None)


def test_strain_of_the_table_is_the_recorded_log_strain(found: dict[str, ts.Result]) -> None:
    table = twist_share.table(found)
    for knot in twist_share.KNOTS:
        total = column(table, "strain", knot=knot)
        recorded = found[twist_share.label_of(knot, "standard")].dataset["log_strain"].values[-1]
        np.testing.assert_allclose(np.log1p(total), recorded, rtol=1e-5)
        assert (column(table, "strain_twist", knot=knot) <= total * (1 + 1e-6)).all()


def test_the_share_of_twist_of_a_fiber_without_bend_and_stretch_is_one(found: dict[str, ts.Result]) -> None:
    result = found[twist_share.label_of("trefoil", "standard")]
    data = result.dataset.copy(deep=True)
    data["strain_bend"][:], data["strain_stretch"][:], data["strain_twist"][:] = 0.0, 0.0, 0.1
    share = twist_share.share_of(ts.Result(data))
    assert share["twist_share"] == pytest.approx(1)
    assert share["twist_adds"] == pytest.approx(np.log(1.1), rel=1e-6)
    data["strain_bend"][:] = 0.3  # √(0.3² + 0.1²)
    share = twist_share.share_of(ts.Result(data))
    assert share["twist_share"] == pytest.approx(0.1, rel=1e-6)
    assert share["twist_adds"] == pytest.approx(np.log((1 + np.sqrt(0.1)) / 1.3), rel=1e-5)


def test_stages_are_in_order_and_end_with_the_run(found: dict[str, ts.Result]) -> None:
    for knot in twist_share.KNOTS:
        result = found[twist_share.label_of(knot, "standard")]
        shown = tightening.stages(result)
        assert shown[:2] == [0, 1]
        assert shown == sorted(shown)
        assert shown[-1] == result.frames - 1
        apart = result.dataset["end_to_end"].values
        middle = 0.5 * (apart[1] + apart[-1])
        assert apart[shown[2] - 1] < middle <= apart[shown[2]] or shown[2] == 1


def test_paths_end_with_what_the_knots_came_to(tables: dict[str, Table]) -> None:
    for knot in twist_share.KNOTS:
        for path, final in (("bend_max", "bend_max"), ("twist_rad", "total_twist_rad")):
            along = column(tables["paths"], path, knot=knot)
            assert along[-1] == pytest.approx(column(tables["knots"], final, knot=knot)[0])


def test_barriers_are_those_of_the_paths(tables: dict[str, Table]) -> None:
    heads = [name for name in tables["moves"].columns if name.endswith("_L_per_B")]
    for name in move_energies.MOVES:
        energy = sum(column(tables["moves"], head, move=name) for head in heads)
        apart = energy[0] if name == "R2" else 0.0
        top, end = (column(tables["barriers"], f"{k}_L_per_B", move=name)[0] for k in ("top", "end"))
        assert end == pytest.approx(energy[-1] - apart)
        assert top == pytest.approx((energy[2:] - apart).max(), rel=1e-6)
    assert column(tables["barriers"], "top_L_per_B", move="R1, gripped")[0] > 20
    assert column(tables["barriers"], "top_L_per_B", move="R2")[0] < 2


def test_the_colours_are_the_measured_ones(tables: dict[str, Table]) -> None:
    table = tables["colours"]
    np.testing.assert_array_equal(np.array([row[1:4] for row in table.rows]), STRAIN_TABLE)
    green = table.rows[10][4:]
    assert green == pytest.approx((0.30, 0.60), abs=1e-3)  # pure green of sRGB


def test_the_picture_is_drawn(found: dict[str, ts.Result], tables: dict[str, Table], tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    image = pytest.importorskip("matplotlib.image")
    path = tmp_path / "figure-4-2.png"
    figure("4-2").draw(found, tables, QUICK, path)
    assert image.imread(path).shape[1] > 2000


def test_the_panel_of_figure_4_1_shows_both_knots(found: dict[str, ts.Result]) -> None:
    pyplot = pytest.importorskip("matplotlib.figure")
    axes = pyplot.Figure().subplots()
    twist_share.draw_panel(axes, twist_share.table(found))
    labels = [line.get_label() for line in axes.lines]
    assert labels == ["trefoil, total", "trefoil, twist", "figure-eight, total", "figure-eight, twist"]
    for total, twist in (axes.lines[:2], axes.lines[2:]):
        assert twist.get_ydata().max() < 0.2 * total.get_ydata().max()

"""Figures of chapter 5 in their short form, and the rules by which batteries are called resonant."""

from __future__ import annotations

import contextlib
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from torsade.cli import figure as command
from torsade.errors import TorsadeError
from torsade.figures import figure
from torsade.figures.base import Choice, Table
from torsade.figures.battery_map import KNOTS, PEAK, SIGNIFICANT, TWISTS, design, slow, split
from torsade.figures.runs import results
from torsade.sweep import Catalogue, Sweep, run

QUICK = Choice(quick=True)
PAGE = (Path(__file__).resolve().parents[2] / "docs" / "batteries.md").read_text(encoding="utf-8")


def test_the_map_is_14_knots_with_17_twists() -> None:
    points = design(Choice()).points()
    assert len(points) == 14 * 17 == 238
    assert {(p.spec.knot, p.spec.twist) for p in points} == {(k, t) for k in KNOTS for t in TWISTS}
    assert TWISTS[0] == -TWISTS[-1] == -4


def test_the_design_on_the_page_is_that_of_the_figure(tmp_path: Path) -> None:
    (text,) = [t for t in re.findall(r"^```toml\n(.*?)^```$", PAGE, re.M | re.S) if "charged" not in t]
    (tmp_path / "batteries.toml").write_text(text)
    shown = Sweep.read(tmp_path / "batteries.toml").points()
    assert [p.key for p in shown] == [p.key for p in design(Choice()).points()]


def test_resonant_is_what_is_slow_beside_what_twist_leaves() -> None:
    """The threshold is three robust standard deviations of the logarithms at |h theta'| > 1.

    Those here are ±s and 0 about each median, so that their median absolute deviation is s.
    """
    s, knots, twists = 0.2, [str(k) for k in range(6)], np.array([-2.0, 0.0, 2.0])
    beyond = np.array([-s, -s, 0.0, 0.0, s, s])
    log = np.stack([beyond, np.zeros(6), beyond], axis=1)
    threshold = SIGNIFICANT * 1.4826 * s
    log[1, 1], log[2, 1] = 1.01 * threshold, 0.99 * threshold
    numbers = {
        "knot": np.repeat(knots, 3),
        "twist_density": np.tile(twists, 6),
        "T10_T0": np.exp(log).ravel(),
    }
    found = slow(numbers)
    assert found.least == pytest.approx(np.exp(threshold))
    assert np.flatnonzero(found.resonant).tolist() == [3 * 1 + 1]
    np.testing.assert_allclose(np.log(found.slowness.reshape(6, 3)[:, 1]), log[:, 1], atol=1e-12)
    high = log[:, 1] - np.maximum(log[:, 0], log[:, 2]) > np.log(PEAK)
    assert found.peak.reshape(6, 3)[:, 1].tolist() == high.tolist()
    assert not found.peak.reshape(6, 3)[:, [0, 2]].any()


def test_what_did_not_get_there_is_not_resonant() -> None:
    times = np.array([1.0, np.nan, 3.0, 1.1, 0.9, 1.0])
    twist = np.array([2.0, 0.0, 0.0, 2.0, 2.0, 0.0])
    found = slow({"knot": np.arange(6), "twist_density": twist, "T10_T0": times})
    assert not found.resonant[1]
    assert not found.peak.any()


def test_what_failed_takes_no_part_in_medians() -> None:
    """And where all failed there are none, without a warning."""
    twist = np.repeat([0.0, 2.0, 3.0], 3)
    energy = {"bend": np.tile([3.0, 4.0, 5.0], 3), "twist": np.tile([0.0, 8.0, 9.0], 3)}
    energy |= {"stretch": np.ones(9), "contact": np.zeros(9)}
    failed = np.array([0, 0, 0, 0, 0, 1, 1, 1, 1], bool)
    numbers = {f"{kind}_E0": np.where(failed, np.nan, values) for kind, values in energy.items()}
    numbers |= {"energy_E0": sum(numbers.values()), "twist_density": twist, "knot": np.tile([1, 2, 3], 3)}
    numbers["T10_T0"] = np.where(failed, np.nan, np.arange(1.0, 10.0))
    none, some, every = (dict(zip(split(numbers).columns, row, strict=True)) for row in split(numbers).rows)
    assert (none["batteries"], none["twist_above_bend"]) == (3, pytest.approx(2 / 3))
    assert (some["batteries"], some["twist_above_bend"], some["T10_median"]) == (3, 0.5, 4.5)
    assert some["bend_share"] == pytest.approx((3 / 4 + 4 / 13) / 2)
    assert all(np.isnan(value) for name, value in every.items() if name not in ("h_theta_prime", "batteries"))
    assert not slow(numbers).resonant[failed].any()


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Table]]:
    """Figure 5-3 by its command; its folder, and its tables from the sweep there."""
    pytest.importorskip("pyvista")
    folder = tmp_path_factory.mktemp("figures")
    assert command.draw("5-3", str(folder), "both", True, False, "1", True) == 0
    catalogue = Catalogue(folder / "sweeps" / "battery-map")
    return folder, dict(figure("5-3").swept.measure(catalogue, QUICK))


@pytest.mark.slow
def test_the_map_is_drawn_and_its_tables_are_written(made: tuple[Path, dict[str, Table]]) -> None:
    folder, tables = made
    assert (folder / "figure-5-3.png").read_bytes().startswith(b"\x89PNG")
    names = {path.name for path in folder.glob("figure-5-3*.csv")}
    assert names == {f"figure-5-3{part}.csv" for part in ("", "-map", "-split", "-causes", "-discharge")}
    assert len(tables["map"].rows) == 20
    assert set(tables["map"].column("status")) == {"done"}


@pytest.mark.slow
def test_before_the_cut_link_and_knot_are_kept(made: tuple[Path, dict[str, Table]]) -> None:
    table = made[1]["map"]
    assert max(table.column("link_error")) < 1e-6
    assert all(table.column("knot_kept"))
    Lk, Tw, Wr = (np.asarray(table.column(name), float) for name in ("Lk", "Tw", "Wr"))
    np.testing.assert_allclose(Lk, Tw + Wr, atol=1e-9)


@pytest.mark.slow
def test_twist_takes_over_from_bending_and_washes_topology_out(made: tuple[Path, dict[str, Table]]) -> None:
    """Bending is all without twist (but for stretch), nothing much at 3; times then are alike."""
    split = {row[0]: dict(zip(made[1]["split"].columns, row, strict=True)) for row in made[1]["split"].rows}
    assert split[0.0]["twist_above_bend"] == 0
    assert split[1.5]["twist_above_bend"] == split[3.0]["twist_above_bend"] == 1
    spread = {s: row["T10_most"] / row["T10_least"] for s, row in split.items()}
    assert spread[3.0] < 3 < spread[0.0]
    assert split[3.0]["T10_most"] < 2


@pytest.mark.slow
def test_the_same_command_runs_nothing_again(made: tuple[Path, dict[str, Table]]) -> None:
    folder, _ = made
    before = sorted(path.name for path in (folder / "sweeps" / "battery-map").iterdir())
    assert command.draw("5-3", str(folder), "both", True, False, "1", True) == 0
    assert sorted(path.name for path in (folder / "sweeps" / "battery-map").iterdir()) == before


def rows(folder: Path) -> dict[str, dict[str, object]]:
    """What is stored, by key, but for times."""
    found = Catalogue(folder).query("SELECT * EXCLUDE (point, wall_s) FROM runs WHERE status = 'done'")
    every = [dict(zip(found.columns, row, strict=True)) for row in found.rows]
    return {str(row.pop("key")): row for row in every}


@pytest.mark.slow
def test_killed_half_way_it_goes_on_to_the_same_bits(
    made: tuple[Path, dict[str, Table]], tmp_path: Path
) -> None:
    """SIGKILL to the command, which can do nothing about it; what was stored is not run again."""
    folder = tmp_path / "sweeps" / "battery-map"
    words = ["figure", "5-3", "--quick", "--workers", "1", "--json", "--out", str(tmp_path)]
    running = subprocess.Popen(
        [sys.executable, "-m", "torsade", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    stored: dict[str, dict[str, object]] = {}
    while running.poll() is None and len(stored) < 5:
        time.sleep(0.2)
        with contextlib.suppress(TorsadeError):  # nothing there yet
            stored = rows(folder)
    running.kill()
    running.wait()
    stored = rows(folder)
    assert 5 <= len(stored) < 20
    done = run(design(QUICK), folder, workers=1)
    assert (done.before, done.ran, done.failed) == (len(stored), 20 - len(stored), 0)
    assert rows(folder) == rows(made[0] / "sweeps" / "battery-map")


@pytest.mark.slow
@pytest.mark.parametrize("number", ["5-1", "5-2"])
def test_the_others_are_drawn(number: str, tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    image = pytest.importorskip("matplotlib.image")
    wanted = figure(number)
    found = results(wanted.runs(QUICK), tmp_path / "runs", workers=1)
    tables = wanted.tables(found, None, QUICK)
    wanted.draw(found, tables, QUICK, wanted.file(tmp_path))
    assert image.imread(wanted.file(tmp_path)).shape[1] > 2000
    main = tables[""]
    if number == "5-1":
        assert main.column("knot")[0] == "7_4"
        assert np.diff(np.asarray(main.column("cut"), int)).tolist().count(1) == 1
        return
    kinds = [np.asarray(main.column(f"{kind}_E0"), float) for kind in ("bend", "twist", "stretch", "contact")]
    np.testing.assert_allclose(np.sum(kinds, axis=0), np.asarray(main.column("energy_E0"), float), rtol=1e-12)
    np.testing.assert_allclose(
        np.asarray(main.column("Lk"), float),
        np.asarray(main.column("Tw"), float) + np.asarray(main.column("Wr"), float),
        atol=1e-9,
    )
    density = np.asarray(tables["density"].column("density_at_+2_Eb_h2"), float)
    assert density[0] == density.max()


@pytest.mark.slow
def test_queries_of_the_page_are_answered(made: tuple[Path, dict[str, Table]]) -> None:
    folder = made[0] / "sweeps" / "battery-map"
    lines = [
        line for line in PAGE.splitlines() if line.startswith("torsade query figures/sweeps/battery-map")
    ]
    assert lines
    for line in lines:
        *_, sql = shlex.split(line)
        done = subprocess.run(
            [sys.executable, "-m", "torsade", "query", str(folder), sql, "--json"],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr

"""`torsade tight` from the real shell: numbers, files, interruption, and refusals in one sentence."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.knots import thickness
from torsade.knots.loose import loose_knot

KEYS = {
    "input", "names", "ropelength", "ropelength_listed", "reached", "length_m", "radius_m", "writhe_3d",
    "acn", "strands", "nodes", "contacts", "kinks", "residual", "wall_s",
}  # fmt: skip


def shell(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", "tight", *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
    )


def test_numbers_and_nodes_of_a_trefoil(tmp_path: Path) -> None:
    done = shell("3_1", "--tries", "0", "--radius", "0.2 mm", "--out", "tight.csv", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads(done.stdout)
    assert set(found) == KEYS
    assert found["names"] == ["3_1"]
    assert found["ropelength_listed"] < found["ropelength"] < 1.01 * found["ropelength_listed"]
    assert found["radius_m"] == 2e-4
    assert found["length_m"] == pytest.approx(2e-4 * found["ropelength"], rel=1e-12)
    written = ts.read_csv(tmp_path / "tight.csv")
    assert written.closed == (True,)
    assert len(written.strands[0]) == found["nodes"]
    assert thickness(written.strands).ropelength == pytest.approx(found["ropelength"], rel=1e-9)


def test_a_link_as_a_table() -> None:
    done = shell("hopf", "--tries", "0")
    assert (done.returncode, done.stderr) == (0, "")
    rows = [" ".join(line.split()) for line in done.stdout.splitlines()]
    assert "name L2a1" in rows
    assert any(row.startswith("ropelength L/h 25.1") for row in rows)
    assert not any(row.startswith("length") for row in rows)


def test_a_file_stopped_at_a_ropelength(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    ts.write_csv(ts.Centerline(tuple(1e-3 * x for x in loose_knot("m3_1")), (True,)), path)
    done = shell(str(path), "--ropelength", "45", "--json")
    found = json.loads(done.stdout)
    assert found["ropelength"] == pytest.approx(45, rel=1e-9)
    assert (found["names"], found["reached"], found["length_m"]) == (["m3_1"], True, None)


def test_a_code() -> None:
    assert json.loads(shell("{1,1}", "--tries", "0", "--json").stdout)["names"] == ["L2a1"]


def test_ctrl_c_keeps_the_best_shape(tmp_path: Path) -> None:
    """Interrupted while it looks for better ones; before there is a shape, it says that nothing is saved."""
    command = [sys.executable, "-m", "torsade", "tight", "7_4", "--tries", "500", "--out", "best.csv"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=tmp_path) as run:
        time.sleep(12)
        run.send_signal(signal.SIGINT)
        _, said = run.communicate(timeout=60)
    assert run.returncode == 130
    assert said.startswith("torsade: interrupted")
    assert "Traceback" not in said
    if "before there was a shape" not in said:
        kept = ts.read_csv(tmp_path / "best.csv")
        assert 64 < thickness(kept.strands).ropelength < 80


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("reef",), "'reef' has open strands"),
        (("3_1", "--nodez", "3"), "did you mean --nodes?"),
        (("3_1", "--nodes", "many"), "--nodes is 'many'; give a whole number"),
        (("3_1", "--ropelength", "tight"), "--ropelength is 'tight'; give a number"),
        (("3_1", "--ropelength", "3"), "above 2 pi"),
        (("3_1", "--radius", "2 N"), "radius"),
        (("3_1", "--out", "tight.zarr"), "ends in .csv"),
        (("3_1", "--out", "nowhere/tight.csv"), "its folder does not exist"),
        (("3_1", "--out"), "--out has no value"),
        (("3_99",), "3_99"),
        ((), "nothing is given"),
    ],
)
def test_refusals(arguments: tuple[str, ...], message: str) -> None:
    done = shell(*arguments)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr


def test_an_open_strand_in_a_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "open.csv"
    ts.write_csv(ts.Centerline((np.eye(3),)), path)
    done = shell(str(path))
    assert done.returncode == 2
    assert "strand 0" in done.stderr
    assert "is open; only closed strands can be tight" in done.stderr

"""A sweep whose worker is killed, and which is killed itself twice and gone on with: every point once."""

from __future__ import annotations

import importlib
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def sweeps(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(ROOT))
    return importlib.import_module("benchmarks.sweeps")


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks Linux for processes")
def test_every_point_once_whatever_is_killed(sweeps, capsys):
    found = sweeps.main(["--quick", "--json"])["processes"]
    assert capsys.readouterr().out
    assert (found["points"], found["worker_kills"], found["command_kills"]) == (60, 1, 2)
    assert found["every_point_once"]
    assert found["alike"] == found["checked_alone"] == 20
    assert found["left_behind"] == 0


@pytest.mark.slow
def test_a_scheduler_that_dies_ends_the_sweep_in_one_sentence(sweeps, tmp_path):
    pytest.importorskip("distributed")
    design = tmp_path / "a.toml"
    design.write_text(sweeps.DESIGN.format(duration="0.5 ms", twists=2, seeds=500))
    with sweeps.dask_cluster() as (address, (scheduler, *_)):
        running = sweeps.begun(design, tmp_path / "a", "--scheduler", address, errors=subprocess.PIPE)
        assert sweeps.until(lambda: sweeps.stored(tmp_path / "a") > 0, running)
        sweeps.kill(scheduler.pid)
        out, errors = running.communicate()
    assert (running.returncode, out) == (2, "")
    assert errors == (
        "torsade: the scheduler let go of the sweep; the same command goes on with what is left.\n"
    )
    assert sweeps.stored(tmp_path / "a") > 0


@pytest.mark.slow
def test_small_runs_cost_little_beside_computing(sweeps, tmp_path):
    """On a free machine it is a few per cent; here the start of two processes is in it, and other tests."""
    assert sweeps.overhead(tmp_path / "short", "20 ms", 120)["overhead_once_started"] < 1.0

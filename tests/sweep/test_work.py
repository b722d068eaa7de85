"""The loop of a sweep: whatever happens to workers, every unit comes to one end."""

from __future__ import annotations

import time
from collections import Counter
from concurrent.futures import BrokenExecutor, ThreadPoolExecutor

import deadly
import pytest

from torsade.errors import TorsadeError
from torsade.sweep import work
from torsade.sweep.lanes import Local, Shared
from torsade.sweep.unit import Unit
from torsade.sweep.work import Work


@pytest.fixture
def run(monkeypatch, tmp_path):
    """Runs units by name with `deadly.batch`; outcomes by name, and the work."""
    monkeypatch.setattr(work, "run_batch", deadly.batch)

    def run(names, lanes):
        todo = Work([Unit(name, None) for name in names], lanes, "sources", str(tmp_path))
        try:
            outcomes = [one for some in todo.outcomes(lambda: None) for one in some]
        finally:
            for lane in lanes:
                lane.close()
        assert Counter(one.key for one in outcomes) == Counter(names)
        return {one.key: one for one in outcomes}, todo

    return run


def log(tmp_path):
    return [line.split() for line in (tmp_path / "log").read_text().splitlines()]


def test_small_units_go_together(run, tmp_path):
    names = [f"a-{k}" for k in range(400)]
    with ThreadPoolExecutor(2) as executor:
        run(names, [Shared(executor, lambda: 2)])
    assert max(int(size) for _, size, _ in log(tmp_path)) > 10
    assert sorted(name for name, *_ in log(tmp_path)) == sorted(names)


def test_a_killed_worker_costs_its_batch_and_no_more(run, tmp_path):
    names = [f"a-{k}" for k in range(60)] + ["kill-1"] + [f"b-{k}" for k in range(60)]
    found, todo = run(names, [Local(None), Local(None)])
    assert {one.status for one in found.values()} == {"done"}
    assert todo.killed == 1


def test_a_unit_that_kills_its_worker_every_time_fails_alone(run):
    names = ["kill-2", *(f"a-{k}" for k in range(40)), "kill-99", *(f"b-{k}" for k in range(5))]
    found, todo = run(names, [Local(None), Local(None)])
    bad = found.pop("kill-99")
    assert bad.status == "failed"
    assert "was killed 3 times or more, as it is when memory runs out" in bad.reason
    assert {one.status for one in found.values()} == {"done"}
    assert 5 <= todo.killed <= 7


def test_workers_of_another_version_are_refused(run):
    with (
        ThreadPoolExecutor(1) as executor,
        pytest.raises(TorsadeError, match="have another version of torsade"),
    ):
        run(["other-1"], [Shared(executor, lambda: 1)])


def test_an_executor_that_is_broken_is_named(run):
    from torsade.sweep.processes import pool

    with pool(1) as executor, pytest.raises(TorsadeError, match="has lost its workers"):
        run(["kill-9", "a-1"], [Shared(executor, lambda: 1)])


def test_workers_that_all_die_end_the_sweep(run, monkeypatch):
    monkeypatch.setattr(work, "MOST_IN_VAIN", 3)
    with pytest.raises(TorsadeError, match="4 workers died one after another and nothing got done"):
        run([f"kill-{90 + k}" for k in range(5)], [Local(None)])


def test_what_does_not_heed_ctrl_c_can_be_ended(tmp_path):
    """A run that takes a minute, in a process that ignores Ctrl-C."""
    lane = Local(None)
    lane.submit([Unit("a", None)], deadly.dawdle, str(tmp_path))
    (future, _) = lane.given[0]
    while not (tmp_path / "log").exists():
        time.sleep(0.02)
    lane.abandon()
    with pytest.raises(BrokenExecutor):
        future.result(timeout=30)
    lane.close()

"""Sweeps on the workers of a scheduler: the same numbers, and what is said where there is none."""

from __future__ import annotations

import os
import signal
import sys
import time
import types
import warnings

import pytest

from torsade.errors import TorsadeError
from torsade.sweep import Catalogue, Sweep, run
from torsade.sweep.schedulers import QUEUES, check_options, connected

BREAKING = {"fixed": {"edges": 10, "disorder": 0.1, "frames": 1}, "grid": {"seed": {"from": 0, "to": 11}}}


@pytest.fixture(scope="module")
def cluster():
    """A scheduler and two workers, processes of their own, on this machine."""
    distributed = pytest.importorskip("distributed")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        made = distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
        )
        yield made
        made.close()


def numbers(folder):
    return Catalogue(folder).query("SELECT * EXCLUDE (wall_s) FROM runs").rows


def test_a_scheduler_gives_the_numbers_of_processes(cluster, tmp_path):
    sweep = Sweep("snap-twist", **BREAKING)
    done = run(sweep, tmp_path / "a", scheduler=cluster.scheduler_address)
    assert (done.ran, done.effort.workers) == (12, 2)
    run(sweep, tmp_path / "b", workers=1)
    assert numbers(tmp_path / "a") == numbers(tmp_path / "b")


def test_a_worker_of_a_scheduler_may_be_killed(cluster, tmp_path):
    """Its batch is given to another; a new worker takes its place."""
    sweep = Sweep("snap-twist", **BREAKING | {"grid": {"seed": {"from": 100, "to": 139}}})
    killed = []

    def kill(share, note):
        if share > 0.2 and not killed:
            killed.append(next(iter(cluster.workers.values())).pid)
            os.kill(killed[0], signal.SIGKILL)

    done = run(sweep, tmp_path / "a", scheduler=cluster.scheduler_address, progress=kill)
    assert killed
    assert done.catalogue.counts() == {"done": 40, "failed": 0, "waiting": 0}


@pytest.mark.parametrize("name", QUEUES)
def test_jobs_of_a_queue_are_workers(cluster, tmp_path, monkeypatch, name):
    """With a stand-in for the queue, which says what it was asked for."""
    asked = {}

    class Queue:
        def __init__(self, **options):
            asked.update(options)
            self.scheduler_address = cluster.scheduler_address
            self.scheduler_comm = cluster.scheduler_comm

        def scale(self, n):
            asked["n"] = n

        def close(self):
            asked["closed"] = True

    monkeypatch.setitem(sys.modules, "dask_jobqueue", types.SimpleNamespace(**{QUEUES[name]: Queue}))
    monkeypatch.setattr("distributed.Client", address_only(cluster))
    options = {"queue": "short", "cores": 4, "walltime": "01:00:00"}
    sweep = Sweep("snap-twist", **BREAKING, cluster=options)
    done = run(sweep, tmp_path / "a", scheduler=name, workers=8)
    assert done.catalogue.counts()["done"] == 12
    assert asked == options | {"processes": 4, "memory": "2GB", "n": 8, "closed": True}


def address_only(cluster):
    """A client of a scheduler, whatever cluster object it is given."""
    from distributed import Client

    return lambda where, **options: Client(cluster.scheduler_address, **options)


def test_a_queue_that_takes_no_jobs_is_named(monkeypatch):
    def make(**options):
        raise RuntimeError("sbatch: not found")

    monkeypatch.setitem(sys.modules, "dask_jobqueue", types.SimpleNamespace(SLURMCluster=make))
    with pytest.raises(TorsadeError, match=r"slurm takes no jobs \(sbatch: not found\); see that"):
        connected("slurm", 2, {})


def test_nobody_at_an_address_is_said(monkeypatch):
    monkeypatch.setattr("torsade.sweep.schedulers.PATIENCE", "1s")
    began = time.monotonic()
    with pytest.raises(TorsadeError, match=r"no dask scheduler answers at 'tcp://127.0.0.1:9' .*; start one"):
        connected("tcp://127.0.0.1:9", None, {})
    assert time.monotonic() - began < 60


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (
            {"job_script_prologue": "rm"},
            r"\[cluster\] has 'job_script_prologue'; it takes queue, .*jobqueue",
        ),
        ({"cores": "4"}, r"cores in \[cluster\] is '4'; give a whole number above 0"),
        ({"queue": "a\n#SBATCH --uid=0"}, r"queue in \[cluster\] is .*; give one line of text"),
    ],
)
def test_options_of_a_queue_are_checked(options, sentence):
    with pytest.raises(TorsadeError, match=sentence):
        check_options(options)


def test_what_to_install_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "dask_jobqueue", None)
    with pytest.raises(TorsadeError, match=r"needs dask-jobqueue, .*pip install \"torsade\[cluster\]\""):
        connected("pbs", 1, {})
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(TorsadeError, match=r"needs dask, which is not installed"):
        connected("tcp://127.0.0.1:9", None, {})

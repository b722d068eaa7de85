"""Tasks in place of runs, for workers that are killed or looked at; importable by them."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

from torsade.sweep.processes import ONE_THREAD
from torsade.sweep.unit import OTHER_VERSION, Outcome


def _log(folder, text):
    with (Path(folder) / "log").open("a") as file:
        file.write(text + "\n")


def batch(units, sources, folder):
    """Units named kill-N kill their worker, the first N times they are run; others say their name."""
    done = []
    for unit in units:
        _log(folder, f"{unit.key} {len(units)} {os.getpid()}")
        word, _, number = unit.key.partition("-")
        if word == "kill" and (Path(folder) / "log").read_text().split().count(unit.key) <= int(number):
            os.kill(os.getpid(), signal.SIGKILL)
        if word == "other":
            return [Outcome(unit.key, OTHER_VERSION, None, {}, 0.0, {})]
        time.sleep(0.002)
        done.append(Outcome(unit.key, "done", None, {}, 0.002, {}))
    return done


def dawdle(units, folder):
    """Take a minute, without looking up."""
    _log(folder, "begun")
    time.sleep(60)


def inherited():
    """What a worker finds itself with."""
    heavy = ("numba", "numpy", "xarray", "pydantic", "duckdb", "torsade.protocols.files")
    return {
        "threads": [os.environ.get(name) for name in ONE_THREAD],
        "heavy": [name for name in heavy if name in sys.modules],
    }

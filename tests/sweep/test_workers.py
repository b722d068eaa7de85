"""Workers: what they import, what they inherit, and kernels compiled before they begin."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import deadly
import pytest

from torsade import _compile
from torsade.errors import TorsadeError
from torsade.provenance import cores
from torsade.sweep.processes import ONE_THREAD, pool
from torsade.sweep.warm import warm_up

SCRIPT = """
import sys
import torsade as ts

print("begun", flush=True)
sweep = ts.Sweep("bend-twist", fixed={"nodes": 21}, grid={"end_distance": ["15 cm", "20 cm"]})
print(sweep.run(sys.argv[1], workers=2).counts()["done"])
"""


def test_workers_have_one_thread_and_have_imported_little() -> None:
    before = [os.environ.get(name) for name in ONE_THREAD]
    main = sys.modules["__main__"]
    place = getattr(main, "__file__", None)
    with pool(1) as executor:
        found = executor.submit(deadly.inherited).result()
    assert found == {"threads": ["1"] * len(ONE_THREAD), "heavy": []}
    assert [os.environ.get(name) for name in ONE_THREAD] == before
    assert getattr(main, "__file__", None) == place


def test_a_script_needs_no_guard(tmp_path: Path) -> None:
    """Workers do not run the main script once more."""
    script = tmp_path / "mine.py"
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, str(script), str(tmp_path / "bent")], capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("begun\n2\n", "")


def test_as_many_cores_as_this_process_may_use() -> None:
    assert 1 <= cores() <= (os.cpu_count() or 1)


class Spec(SimpleNamespace):
    """Counts its runs; one of two steps."""

    protocol = "snap-twist"
    runs = steps = 0

    def run(self, progress):
        self.runs += 1
        for share in (0.0, 0.5, 1.0):
            self.steps += 1
            progress(share, "")


def test_kernels_are_compiled_once_and_no_further_than_needed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_compile, "CACHE", tmp_path)
    said: list[str] = []
    spec = Spec()
    for _ in range(2):
        warm_up(spec, said.append)
    assert (spec.runs, spec.steps) == (1, 2)
    assert said[0].startswith("compiling the kernels, this once")


def test_a_point_that_fails_while_kernels_are_compiled_is_left_to_the_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Bad(Spec):
        def run(self, progress):
            raise TorsadeError("unfit")

    monkeypatch.setattr(_compile, "CACHE", tmp_path)
    warm_up(Bad(), lambda note: None)
    assert not list(tmp_path.iterdir())

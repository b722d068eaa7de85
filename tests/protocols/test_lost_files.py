"""Files of numbers that are lost, from runs that grow, are to be gone on with, or are complete."""

from __future__ import annotations

import itertools
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from short_runs import SHORT, assert_same
from torsade import places, recording, store, vetting, zarr_files
from torsade.cli import main
from torsade.protocols.driving import Interrupted

SPEC = SHORT["tighten"]
ROWS = 2
"""Frames in a file of positions."""


@pytest.fixture
def part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run that was interrupted late, with several files to a variable."""

    def stop(share: float, note: str) -> None:
        if share > 0.7:
            raise KeyboardInterrupt

    few_frames_in_a_file(monkeypatch)
    monkeypatch.setattr(recording, "FLUSH_EVERY", 0.0)
    with pytest.raises(Interrupted):
        SPEC.run(stop, tmp_path / "run.zarr")
    return tmp_path / "run.zarr.part"


def few_frames_in_a_file(monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = SPEC.run().dataset.sizes["node"]
    monkeypatch.setattr(zarr_files, "CHUNK_BYTES", ROWS * 12 * nodes)


def pieces(path: Path, name: str) -> list[Path]:
    return sorted(store.chunks_of(path / name), key=lambda file: file.relative_to(path / name).parts)


@pytest.mark.parametrize("name", ["position", "velocity", "energy_twist", "self_torque"])
@pytest.mark.parametrize("which", [0, -1])
def test_a_lost_file_of_a_growing_run_is_noticed(name: str, which: int, part: Path) -> None:
    """Also of numbers that are all zero, as velocities at the start: every file that is counted is there."""
    lost = pieces(part, name)[which]
    kept = lost.read_bytes()
    lost.unlink()
    says = rf"'{name}' lies in \d+ files? and should lie in \d+"
    with pytest.raises(ts.TorsadeError, match=says) as refused:
        ts.open(part)
    assert "\n" not in str(refused.value)
    with pytest.raises(ts.TorsadeError, match=rf"{says}.*; give --overwrite \(overwrite=True\) in place of"):
        SPEC.run(out=part.with_suffix(""), resume=True)
    about = places.attributes(part)
    assert about is not None
    assert (about["status"], about["resumed"]) == ("interrupted", [])  # as it was
    lost.write_bytes(kept)
    assert_same(SPEC.run(out=part.with_suffix(""), resume=True), SPEC.run())


@pytest.mark.parametrize("which", [1, 2])
def test_frames_before_a_lost_file_are_opened(which: int, part: Path) -> None:
    sound = ts.open(part).dataset
    pieces(part, "position")[which].unlink()
    with pytest.raises(ts.TorsadeError, match=r"export and open take the frames before with --salvage"):
        ts.open(part)
    saved = ts.open(part, salvage=True)
    assert saved.frames == saved.dataset.attrs["done"] == which * ROWS
    expected = sound.isel(time=slice(0, which * ROWS)).assign_attrs(done=which * ROWS)
    assert saved.dataset.identical(expected)
    again = ts.open(saved.save(part.with_name("saved.zarr")))
    assert again.dataset.identical(expected)


def test_nothing_is_opened_where_the_first_frames_are_lost(part: Path) -> None:
    pieces(part, "position")[0].unlink()
    with pytest.raises(ts.TorsadeError, match=r"and should lie in \d+; it is damaged"):
        ts.open(part, salvage=True)


def test_a_variable_that_does_not_grow_is_not_done_without(part: Path) -> None:
    (part / "node_start" / "c" / "0").unlink()
    for salvage in (False, True):
        with pytest.raises(ts.TorsadeError, match="'node_start' lies in 0 files and should lie in 1; it is"):
            ts.open(part, salvage=salvage)


def test_samples_may_be_lost_without_the_frames(tmp_path: Path, stored: Callable[[str], Path]) -> None:
    path = Path(shutil.copytree(stored("prison-escape"), tmp_path / "run.zarr"))
    frames = ts.open(path).frames
    pieces(path, "sample_separation")[0].unlink()
    with pytest.raises(ts.TorsadeError, match=r"'sample_separation' lies in 0 files .*--salvage"):
        ts.open(path)
    saved = ts.open(path, salvage=True)
    assert (saved.frames, saved.dataset.sizes["sample"]) == (frames, 0)


def test_salvage_changes_nothing_where_nothing_is_lost(part: Path) -> None:
    assert ts.open(part, salvage=True).dataset.identical(ts.open(part).dataset)


def test_the_shell_says_it_in_a_sentence_and_opens_the_rest(
    part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pieces(part, "position")[1].unlink()

    def code(*arguments: str) -> object:
        with pytest.raises(SystemExit) as ended:
            main(arguments)
        return ended.value.code

    for command, *options in (["info"], ["export", "--to", "csv", "--out", str(part.with_name("a.csv"))]):
        assert code(command, str(part), *options) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert said.err.count("\n") == 1
        assert "'position' lies in" in said.err
        assert code(command, str(part), *options, "--salvage") == 0
        capsys.readouterr()
    assert code("info", str(part), "--salvage", "--json") == 0
    assert json.loads(capsys.readouterr().out)["frames"] == ROWS
    assert len(part.with_name("a.csv").read_text().splitlines()) == 1 + ROWS


def test_a_run_of_an_earlier_version_is_not_counted(part: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It left out files of zeros, and noted their number only when it was complete."""
    about = json.loads((part / "zarr.json").read_text())
    del about["attributes"]["chunks"]
    (part / "zarr.json").write_text(json.dumps(about))
    whole = SPEC.run()
    zeros = [
        name
        for name, values in whole.dataset.variables.items()
        if "time" in values.dims and not values[:ROWS].any()
    ]
    for name in zeros:
        pieces(part, str(name))[0].unlink()
    assert ts.open(part).frames > 0
    assert_same(SPEC.run(out=part.with_suffix(""), resume=True), whole)
    attrs, _ = vetting.vetted(part.with_suffix(""))
    assert attrs["chunks"] == store.chunk_files(part.with_suffix(""))


KILLED = """
import os, signal, sys
from short_runs import SHORT
from torsade import recording, zarr_files
recording.FLUSH_EVERY = 0.0
zarr_files.CHUNK_BYTES = int(sys.argv[2])
put, left = zarr_files._put, int(sys.argv[3])
def counting(path, content):
    global left
    if os.path.exists(sys.argv[1] + ".part"):
        left -= 1
    if left < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    put(path, content)
zarr_files._put = counting
SHORT["tighten"].run(out=sys.argv[1])
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
@pytest.mark.parametrize("writes", [1, 17, 40, 61])
def test_a_run_killed_between_files_is_not_taken_for_damaged(
    writes: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside files that are counted lie some that no attribute counts yet; a lost one is noticed still."""
    few_frames_in_a_file(monkeypatch)
    out, part = tmp_path / "run.zarr", tmp_path / "run.zarr.part"
    script = [sys.executable, "-c", KILLED, str(out), str(zarr_files.CHUNK_BYTES), str(writes)]
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(map(str, (Path(__file__).parents[1], *sys.path)))
    }
    done = subprocess.run(script, check=False, env=environment)
    assert done.returncode == -signal.SIGKILL
    before = ts.open(part)
    assert before.frames == before.dataset.attrs["done"] > 0
    lost = pieces(part, "position")[0]
    kept = lost.read_bytes()
    lost.unlink()
    with pytest.raises(ts.TorsadeError, match="'position' lies in"):
        ts.open(part)
    lost.write_bytes(kept)
    assert_same(SPEC.run(out=out, resume=True), SPEC.run())


def test_numbers_of_files_follow_from_the_frames(part: Path) -> None:
    about = places.attributes(part)
    assert about is not None
    done = about["done"]
    assert done % ROWS  # the last file is not full
    assert about["chunks"]["position"] == -(-done // ROWS) == len(pieces(part, "position"))
    assert np.isfinite(ts.open(part).dataset["position"]).all()
    _, described = vetting.vetted(part)
    for (name, variable), upto in itertools.product(described.items(), (1, done)):
        if variable.dims[0] == "time":
            count = -(-upto // variable.chunk[0])
            vetting.check_files(part, name, variable, count, upto)

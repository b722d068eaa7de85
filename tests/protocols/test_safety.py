"""Whatever happens to a run, what was recorded before it stays."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import torsade as ts
from torsade import places, recording, store, zarr_files
from torsade.protocols import PrisonEscape
from torsade.protocols.driving import Interrupted

SPEC = PrisonEscape(knot="reef", duration="2 ms", frames=8)


def stopped(at: float) -> object:
    """A progress that presses Ctrl-C when this share is done."""

    def stop(share: float, note: str) -> None:
        if share > at:
            raise KeyboardInterrupt

    return stop


@pytest.fixture(name="part")
def _part(tmp_path: Path) -> Path:
    """An interrupted run of 4 frames."""
    with pytest.raises(Interrupted):
        SPEC.run(stopped(0.45), tmp_path / "reef.zarr")
    part = tmp_path / "reef.zarr.part"
    assert ts.open(part).frames == 4
    return part


def test_an_interrupted_run_stays_until_a_new_one_has_a_frame(part: Path) -> None:
    with pytest.raises(Interrupted, match="before the first frame"):
        SPEC.run(stopped(-1), part.with_suffix(""), overwrite=True)
    assert ts.open(part).frames == 4
    assert [p.name for p in part.parent.iterdir()] == [part.name]


def test_a_result_saved_over_an_interrupted_run_is_refused(part: Path, tmp_path: Path) -> None:
    with pytest.raises(ts.TorsadeError, match="holds 4 frames of an interrupted run; finish it or give"):
        ts.open(part).save(tmp_path / "reef.zarr", overwrite=True)
    assert ts.open(part).frames == 4


def test_a_partial_result_is_not_taken_for_a_complete_one(part: Path, tmp_path: Path) -> None:
    ts.open(part).save(tmp_path / "copy.zarr")
    with pytest.raises(ts.TorsadeError, match="exists already"):
        SPEC.run(out=tmp_path / "copy.zarr", resume=True)


def test_a_run_that_lacks_only_its_name_is_finished(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(new: Path, path: Path) -> None:
        if path.suffix == ".zarr":
            raise ts.TorsadeError("the power fails")
        move(new, path)

    move = places.replace
    monkeypatch.setattr(store, "replace", fail)
    with pytest.raises(ts.TorsadeError, match="the power fails"):
        SPEC.run(out=tmp_path / "reef.zarr")
    monkeypatch.undo()
    part = tmp_path / "reef.zarr.part"
    (part / store.RESTART).unlink(missing_ok=True)
    store.set_attributes(part, {"status": "complete"})  # as it was when the program ended there and then
    result = SPEC.run(out=tmp_path / "reef.zarr", resume=True)
    assert result.complete
    assert result.c_f == SPEC.run().c_f
    assert [p.name for p in tmp_path.iterdir()] == ["reef.zarr"]


@pytest.mark.parametrize("content", [None, b"", b"PK\x03\x04", "keys"])
def test_a_missing_or_damaged_state_is_named(part: Path, content: object) -> None:
    restart = part / store.RESTART
    if content is None:
        restart.unlink()
    elif content == "keys":
        np.savez(restart, done=4)
    else:
        assert isinstance(content, bytes)
        restart.write_bytes(content)
    says = "no state to go on from" if content is None else "is damaged; open"
    with pytest.raises(ts.TorsadeError, match=says):
        SPEC.run(out=part.with_suffix(""), resume=True)
    assert ts.open(part).frames == 4


def test_a_run_with_all_its_frames_is_finished_without_a_state(tmp_path: Path) -> None:
    out = tmp_path / "reef.zarr"
    whole = SPEC.run(out=out)
    part = tmp_path / "reef.zarr.part"
    out.rename(part)
    store.set_attributes(part, {"status": "running", "c_f": None})
    again = SPEC.run(out=out, resume=True)
    assert again.dataset.equals(whole.dataset)
    assert again.c_f == whole.c_f
    assert ts.open(out).dataset.attrs["steps"] == whole.dataset.attrs["steps"] > 0


def test_what_is_called_replaced_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "reef.zarr.replaced").mkdir()
    (tmp_path / "reef.zarr.replaced" / "thesis.tex").write_text("years of work")
    SPEC.run(out=tmp_path / "reef.zarr")
    SPEC.run(out=tmp_path / "reef.zarr", overwrite=True)
    assert (tmp_path / "reef.zarr.replaced" / "thesis.tex").read_text() == "years of work"


def test_a_full_disk_leaves_no_rubbish(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, content: bytes) -> None:
        raise OSError(28, "No space left on device")

    result = SPEC.run()
    monkeypatch.setattr(zarr_files, "_put", full)
    for attempt in (lambda: SPEC.run(out=tmp_path / "reef.zarr"), lambda: result.save(tmp_path / "a.zarr")):
        with pytest.raises(ts.TorsadeError, match="no space left on device"):
            attempt()
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_is_full_at_the_first_frame(
    part: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(part: Path, arrays: object) -> None:
        with places.writing(part):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(recording, "FLUSH_EVERY", 0.0)
    monkeypatch.setattr(store, "write_restart", full)
    with pytest.raises(ts.TorsadeError, match=r"no space left on device\); give a place with room") as caught:
        SPEC.run(out=tmp_path / "reef.zarr", overwrite=True)
    assert "the frames until then" not in str(caught.value)
    assert [p.name for p in tmp_path.iterdir()] == [part.name]  # as it was
    assert ts.open(part).frames == 4


def test_two_runs_do_not_write_to_one_place(tmp_path: Path) -> None:
    out = tmp_path / "reef.zarr"

    def meanwhile(share: float, note: str) -> None:
        with pytest.raises(ts.TorsadeError, match=f"is being written by process {os.getpid()}; wait for it"):
            SPEC.run(out=out)

    assert SPEC.run(meanwhile, out).complete
    assert [p.name for p in tmp_path.iterdir()] == ["reef.zarr"]


def test_the_lock_of_another_process_holds_while_it_lives(tmp_path: Path) -> None:
    import socket

    out = tmp_path / "reef.zarr"
    sleeper = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    lock = tmp_path / "reef.zarr.lock"
    lock.write_text(f"{sleeper.pid} {socket.gethostname()}\n")
    try:
        with pytest.raises(ts.TorsadeError, match=f"process {sleeper.pid}; wait"):
            SPEC.run(out=out)
        assert lock.exists()
    finally:
        sleeper.kill()
        sleeper.wait()
    assert SPEC.run(out=out).complete  # the process has ended: its lock is taken over
    assert not lock.exists()
    lock.write_text("12 elsewhere\n")
    with pytest.raises(ts.TorsadeError, match="process 12 on elsewhere"):
        SPEC.run(out=out, overwrite=True)
    lock.write_text("")
    assert SPEC.run(out=out, overwrite=True).complete


def test_an_open_result_does_not_change_when_its_file_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "reef.zarr"
    first = SPEC.run(out=out)
    small = ts.open(out)
    monkeypatch.setattr(ts.results, "READ_AT_ONCE", 200)
    large = ts.open(out)
    assert large.dataset["separation"].equals(first.dataset["separation"])
    SPEC.model_copy(update={"force": 5.0}).run(out=out, overwrite=True)
    assert small.dataset.equals(first.dataset)
    with pytest.raises(ts.TorsadeError, match="was moved or replaced since it was opened"):
        _ = large.dataset


def test_a_moved_centerline_is_the_same_run(tmp_path: Path) -> None:
    ts.write_csv(SPEC.configuration(), tmp_path / "a.csv")
    (tmp_path / "b.csv").write_bytes((tmp_path / "a.csv").read_bytes())
    fields = {"duration": "2 ms", "frames": 8, "pulled": "A1B1"}
    out = tmp_path / "a.zarr"
    with pytest.raises(Interrupted):
        PrisonEscape(centerline=str(tmp_path / "a.csv"), **fields).run(stopped(0.45), out)
    assert PrisonEscape(centerline=str(tmp_path / "b.csv"), **fields).run(out=out, resume=True).complete
    assert json.loads(ts.open(out).dataset.attrs["spec"])["frames"] == 8


@pytest.mark.parametrize("name", ["torsade", "numba", "llvmlite", "numpy", "scipy"])
def test_versions_are_not_mixed(part: Path, name: str) -> None:
    versions = places.attributes(part)["versions"]  # type: ignore[index]
    store.set_attributes(part, {"versions": versions | {name: "0.0.7"}})
    with pytest.raises(
        ts.TorsadeError, match=f"begun with {name} 0.0.7, and this is {name} {versions[name]}"
    ):
        SPEC.run(out=part.with_suffix(""), resume=True)


def test_kernels_are_not_mixed(part: Path) -> None:
    """Neither of sources that were changed without a new version, nor unknown ones of an earlier one."""
    now = places.attributes(part)["kernels"]  # type: ignore[index]
    for kernels in ("0123456789abcdef", None):
        store.set_attributes(part, {"kernels": kernels or "unknown"})
        with pytest.raises(
            ts.TorsadeError,
            match=rf"begun with other kernels \(sources {kernels or 'unknown'}, and here {now}\)",
        ):
            SPEC.run(out=part.with_suffix(""), resume=True)
    versions = places.attributes(part)["versions"]  # type: ignore[index]
    store.set_attributes(part, {"versions": {k: v for k, v in versions.items() if k != "scipy"}})
    with pytest.raises(ts.TorsadeError, match="begun with an unknown version of scipy, and this is scipy"):
        SPEC.run(out=part.with_suffix(""), resume=True)


def test_names_that_mean_something_else_now_are_not_mixed(part: Path) -> None:
    model = json.loads(places.attributes(part)["model"])  # type: ignore[index]
    assert model["material"]["E"] == 1e9
    assert model["radius"] == SPEC.h
    assert model["laws"]["eta_f_ratio"] == 3.3
    assert model["stepping"]["tolerance"] == 1e-2
    assert model["spacing"] == 0.5 * SPEC.h
    model["material"]["E"] = 2e9
    store.set_attributes(part, {"model": json.dumps(model)})
    with pytest.raises(ts.TorsadeError, match=r"was begun when material meant .* and now it means"):
        SPEC.run(out=part.with_suffix(""), resume=True)


def test_the_first_ctrl_c_waits_and_the_second_does_not() -> None:
    """The first is told of and obeyed between two steps."""
    from torsade.stopping import Patience

    told = []
    with Patience(lambda: told.append(1)) as patience:
        patience.end()
        signal.raise_signal(signal.SIGINT)
        assert told == [1]
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            patience.end()


def test_a_late_ctrl_c_is_not_lost() -> None:
    """What comes after the last look is raised at the end, to the outermost block that has patience."""
    from torsade.stopping import Late, Patience

    reached = []

    def late(error: Exception | None) -> None:
        with Patience(lambda: None):
            with Patience(lambda: None) as inner:
                inner.end()
                signal.raise_signal(signal.SIGINT)
            reached.append(error)
            if error is not None:
                raise error

    with pytest.raises(Late):
        late(None)
    with pytest.raises(ValueError, match="mine"):
        late(ValueError("mine"))
    assert len(reached) == 2
    with Patience(lambda: None) as calm:
        calm.end()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_when_the_result_has_just_got_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run is complete, and what was to come after it is not begun."""
    give_name = store.give_name

    def then_stopped(*arguments: Any) -> None:
        give_name(*arguments)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(store, "give_name", then_stopped)
    out = tmp_path / "reef.zarr"
    with pytest.raises(Interrupted, match=rf"; the result is complete in '{out}'$") as stopped:
        SPEC.run(out=out)
    assert stopped.value.part is None
    assert places.attributes(out)["status"] == "complete"  # type: ignore[index]
    assert [path.name for path in tmp_path.iterdir()] == ["reef.zarr"]


def test_long_stretches_without_frames_look_at_ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    from torsade.motion import overdamped

    seen = []
    monkeypatch.setattr(overdamped, "NODE_STEPS_AT_ONCE", 314 * 2)
    spec = PrisonEscape(knot="reef", duration="2 ms", frames=1, fixed_step="2 us")
    spec.run(lambda share, note: seen.append(share))
    assert len(seen) > 400  # ten steps between samples, in calls of two


def test_another_run_than_the_complete_one_can_be_begun_anew(tmp_path: Path) -> None:
    SPEC.run(out=tmp_path / "reef.zarr")
    with pytest.raises(ts.TorsadeError, match=r"force = 15.0, not 5.0; .* give --overwrite"):
        SPEC.model_copy(update={"force": 5.0}).run(out=tmp_path / "reef.zarr", resume=True)


def test_frames_are_on_disk_under_the_name_that_others_look_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "FLUSH_EVERY", 0.0)
    seen = []

    def look(share: float, note: str) -> None:
        if share > 0.5:
            seen.append(ts.open(tmp_path / "reef.zarr.part").frames)

    SPEC.run(look, tmp_path / "reef.zarr")
    assert seen
    assert min(seen) >= 3


@pytest.mark.parametrize(
    ("kept", "words"),
    [
        (True, "compiling the kernels, this once (up to a minute)"),
        (False, "compiling the kernels (up to a minute); set TORSADE_CACHE_DIR to a folder to keep them in"),
    ],
)
def test_compiling_is_told_once_whatever_it_is_for(
    kept: bool, words: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Fibers are made by kernels too; where nothing can be kept it is not said that it is done once."""
    from torsade import _compile

    class Slow(type(SPEC)):
        def trial(self):
            for factor in (2.0, 3.0):
                _compile.compiled(lambda x, factor=factor: factor * x, cache=False)(1.0)
            return super().trial()

    monkeypatch.setattr(_compile, "CACHE", tmp_path if kept else None)
    said = []
    Slow(**SPEC.model_dump(exclude_unset=True)).run(lambda share, note: said.append(note))
    assert said[:2] == [words, "getting ready"]

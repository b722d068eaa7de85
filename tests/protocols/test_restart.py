"""Whatever stops a run of whatever protocol, it is gone on with to the same bits as if nothing had."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import pytest

import torsade as ts
from short_runs import SHORT, assert_same
from torsade import places, recording, store
from torsade.protocols import PROTOCOLS
from torsade.protocols.driving import Interrupted

EVERY = pytest.mark.parametrize("protocol", PROTOCOLS)


@lru_cache
def looks(protocol: str) -> list[float]:
    """The shares at which a run tells how far it is."""
    told: list[float] = []
    SHORT[protocol].run(lambda share, note: told.append(share))
    return told


@pytest.fixture(scope="module")
def whole(stored: Callable[[str], Path]) -> Callable[[str], ts.Result]:
    """The run of a protocol that nothing stopped, as it is on disk."""
    return lambda protocol: ts.open(stored(protocol))


def stopping(share: float, stop: Callable[[], object]) -> Callable[[float, str], None]:
    """A progress that stops the run, once, when this share of it is done."""
    told: list[float] = []

    def look(done: float, note: str) -> None:
        if done >= share and not told:
            told.append(done)
            stop()

    return look


def ctrl_c() -> None:
    signal.raise_signal(signal.SIGINT)


def sigterm() -> None:
    signal.raise_signal(signal.SIGTERM)


def at_once() -> None:
    raise KeyboardInterrupt


def test_every_protocol_has_a_short_run() -> None:
    """What is not in `short_runs.SHORT` is tested nowhere below: add a specification of a second or less."""
    assert {name: spec.protocol for name, spec in SHORT.items()} == {name: name for name in PROTOCOLS}


@EVERY
@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2))])
def test_an_interrupted_run_goes_on_to_the_same_bits(
    protocol: str,
    seed: int,
    whole: Callable[[str], ts.Result],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Stopped twice, at random; what is saved by then may be all of it, some, or nothing."""
    chance = random.Random(f"{protocol} {seed}")
    monkeypatch.setattr(recording, "FLUSH_EVERY", chance.choice([0.0, 0.01, 0.5]))
    out, spec = tmp_path / "run.zarr", SHORT[protocol]
    expected = []
    for share in sorted(chance.sample(looks(protocol)[:-1] or [0.0, 0.0], 2)):
        # SIGTERM is taken over once a run moves; before that it would end this process.
        stop = chance.choice([at_once, ctrl_c, sigterm] if share else [at_once, ctrl_c])
        with pytest.raises(Interrupted) as stopped:
            spec.run(stopping(share, stop), out, resume=True)
        frames, part = stopped.value.frames, places.part_of(out)
        assert stopped.value.part == (part if frames else None)
        if frames:
            assert (ts.open(part).frames, ts.open(part).status) == (frames, "interrupted")
            expected.append(frames)
    result = spec.run(out=out, resume=True)
    assert_same(result, whole(protocol))
    assert_same(ts.open(out), whole(protocol))
    assert store.chunk_files(out) == places.attributes(out)["chunks"]  # type: ignore[index]
    assert [p.name for p in tmp_path.iterdir()] == ["run.zarr"]
    restarts = ts.open(out).provenance["resumed"]
    assert [entry["done"] for entry in restarts] == expected
    assert all(entry["versions"] == result.provenance["versions"] for entry in restarts)


KILLED = """
import os, sys
from short_runs import SHORT
from torsade import recording
recording.FLUSH_EVERY = 0.0
protocol, out, share, number = sys.argv[1:]
def look(done, note):
    if done >= float(share):
        os.kill(os.getpid(), int(number))
SHORT[protocol].run(look, out)
"""


@EVERY
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_a_killed_run_goes_on_to_the_same_bits(
    protocol: str, whole: Callable[[str], ts.Result], tmp_path: Path
) -> None:
    share = random.Random(protocol).choice(looks(protocol))
    out = tmp_path / "run.zarr"
    done = subprocess.run(
        [sys.executable, "-c", KILLED, protocol, str(out), str(share), str(int(signal.SIGKILL))],
        check=False,
        cwd=Path(__file__).parents[1],
    )
    assert done.returncode == -signal.SIGKILL
    assert_same(SHORT[protocol].run(out=out, resume=True), whole(protocol))
    assert_same(ts.open(out), whole(protocol))
    assert not places.part_of(out).exists()


SHELL = """
import os, signal, sys
from torsade.cli import main, commands
from torsade.protocols.files import PROTOCOLS
from contextlib import contextmanager
told = []
def look(share, note):
    told.append(note)
    if len(told) == 40:
        os.kill(os.getpid(), signal.SIGTERM)
@contextmanager
def watched(quiet):
    yield look
commands.progress = watched
main(sys.argv[1:])
"""


def test_sigterm_saves_what_is_done_and_exits_with_143(
    whole: Callable[[str], ts.Result], tmp_path: Path
) -> None:
    spec = SHORT["prison-escape"]
    options = [
        f"--{name}={value}" for name, value in spec.stored().items() if name in ("knot", "duration", "frames")
    ]
    command = [sys.executable, "-c", SHELL, "run", spec.protocol, *options, "--out", "run.zarr"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 143
    assert "frames are saved in 'run.zarr.part', and the same command with --resume goes on" in done.stderr
    assert "Traceback" not in done.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["run.zarr.part"]
    assert_same(spec.run(out=tmp_path / "run.zarr", resume=True), whole(spec.protocol))


def test_sigterm_before_anything_moves_leaves_nothing(tmp_path: Path) -> None:
    """Of a protocol without time all is before."""
    script = SHELL.replace("== 40", "== 1")
    command = [
        sys.executable,
        "-c",
        script,
        "run",
        "bend-twist",
        "--end-distance",
        "19 cm",
        "--out",
        "run.zarr",
    ]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 143
    assert done.stderr == "torsade: interrupted before the first frame; nothing is saved.\n"
    assert list(tmp_path.iterdir()) == []


def test_a_clock_that_jumps_changes_nothing(
    whole: Callable[[str], ts.Result], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Set back by ten years while it runs, and forwards by twenty before it goes on."""
    import time
    from datetime import datetime

    clock = [1.7e9]

    class Jumping(datetime):
        @classmethod
        def now(cls, tz=None):
            return datetime.fromtimestamp(clock[0], tz)

    def back() -> None:
        clock[0] -= 3e8
        raise KeyboardInterrupt

    monkeypatch.setattr(recording, "datetime", Jumping)
    monkeypatch.setattr(time, "time", lambda: clock[0])
    out, spec = tmp_path / "run.zarr", SHORT["tighten"]
    with pytest.raises(Interrupted):
        spec.run(stopping(0.3, back), out)
    clock[0] += 6e8
    result = spec.run(out=out, resume=True)
    assert_same(result, whole("tighten"))
    begun, resumed = result.provenance["created"], result.provenance["resumed"][0]["at"]
    assert begun.startswith("2023-11-14")
    assert resumed.startswith("2033-05-")
    assert 0 < result.provenance["wall_s"] < 600

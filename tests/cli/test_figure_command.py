"""`torsade figure`: what is refused, and when; what Ctrl-C leaves; commands and options in messages."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from torsade.cli import figure as command
from torsade.cli.messages import COMMANDS, first_words
from torsade.errors import TorsadeError
from torsade.figures import figure
from torsade.figures.base import Table

pytest.importorskip("pyvista")
pytest.importorskip("matplotlib")


def shell(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", *arguments], capture_output=True, text=True, check=False
    )


def draw(number: str, out: Path) -> int:
    return command.draw(number, str(out), "standard", True, False, "1", True)


def test_messages_know_the_commands_of_the_help() -> None:
    text = shell("--help").stdout
    listed = re.findall(r"^\W*([a-z]+)  +[A-Z]", text.partition("Commands")[2], re.M)
    assert sorted({*listed} - {"version"}) == first_words()  # of the option --version
    assert "figure" in listed


@pytest.mark.parametrize("name", COMMANDS)
def test_messages_know_the_options_of_the_help(name: str) -> None:
    text = shell(*name.split(), "--help").stdout.partition("Examples:")[0]
    options = set(re.findall(r"^\W*(?:[\w|]+ )*(--[a-z-]+)", text.partition("Parameters")[2], re.M))
    assert options - {"--help"} == {*COMMANDS[name].valued, *COMMANDS[name].switches}


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("figur",), "there is no command 'figur'; did you mean 'figure'?"),
        (("trails", "a.csv"), "did you mean 'trials'?"),
        (("figure", "4-6", "4-5"), "'4-5' comes after the number; make one figure at a time"),
        (("figure", "4-6", "--quik"), "figure has no option --quik; did you mean --quick?"),
        (("figure", "--out"), "--out has no value"),
        (("figure", "9-9"), "there is no figure '9-9'; give one of 3-1"),
    ],
)
def test_refusals(arguments: tuple[str, ...], says: str) -> None:
    done = shell(*arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert says in done.stderr


def test_a_figure_without_runs_leaves_runs_alone(tmp_path: Path) -> None:
    (tmp_path / "runs").write_text("mine")
    assert draw("4-6", tmp_path) == 0
    assert (tmp_path / "runs").read_text() == "mine"
    assert draw("4-6", tmp_path / "other") == 0
    assert sorted(path.name for path in (tmp_path / "other").iterdir()) == [
        "figure-4-6.csv",
        "figure-4-6.png",
    ]


@pytest.mark.parametrize(
    ("name", "folder", "says"),
    [
        ("figure-4-5.csv", True, "figure-4-5.csv' is a folder; remove it, or give another --out"),
        ("figure-4-5-more.csv", True, "figure-4-5-more.csv' is a folder"),
        ("figure-4-5.png", True, "figure-4-5.png' is a folder"),
        ("runs", False, "runs' is a file, not a folder; remove it, or give another --out"),
    ],
)
def test_what_cannot_be_written_is_refused_before_any_run(
    tmp_path: Path, name: str, folder: bool, says: str
) -> None:
    (tmp_path / name).mkdir() if folder else (tmp_path / name).write_text("mine")
    with pytest.raises(TorsadeError) as refused:
        draw("4-5", tmp_path)
    assert says in str(refused.value)
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root can write anywhere")
def test_a_table_that_may_not_be_written_is_refused(tmp_path: Path) -> None:
    (tmp_path / "figure-4-5.csv").touch(0o400)
    with pytest.raises(TorsadeError, match="permission denied"):
        draw("4-5", tmp_path)
    assert not (tmp_path / "runs").exists()


def test_the_out_of_a_figure_is_a_folder(tmp_path: Path) -> None:
    (tmp_path / "here").write_text("mine")
    with pytest.raises(TorsadeError, match="here' is a file, not a folder"):
        draw("4-6", tmp_path / "here")


def test_ctrl_c_while_a_figure_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    empty = replace(figure("4-6"), measure=lambda *_: {"": Table(("a",), [])}, draw=stopped)
    monkeypatch.setattr(command, "figure", lambda number: empty)
    with pytest.raises(KeyboardInterrupt) as said:
        draw("4-6", tmp_path)
    assert str(said.value) == "interrupted before figure 4-6 was drawn; the same command goes on"


@pytest.mark.skipif(os.name == "nt", reason="needs signals to groups of processes")
@pytest.mark.parametrize("workers", ["1", "2"])
def test_ctrl_c_keeps_the_runs(tmp_path: Path, workers: str) -> None:
    """Sent, as a terminal does, to all processes when the first run is there: code 130 and one sentence."""
    arguments = ("figure", "4-5", "--quick", "--out", str(tmp_path), "--workers", workers)
    whole = [sys.executable, "-m", "torsade", *arguments]
    with subprocess.Popen(whole, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        until = time.monotonic() + 300
        while not list(tmp_path.glob("runs/*.zarr")) and time.monotonic() < until:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGINT)
        said = process.communicate(timeout=120)[1]
    stored = len(list(tmp_path.glob("runs/*.zarr")))
    assert stored >= 1
    assert process.returncode == 130
    assert "Traceback" not in said
    are = "is" if stored == 1 else "are"
    last = said.strip().splitlines()[-1]
    assert re.fullmatch(
        rf"torsade: interrupted; {stored} of \d+ runs {are} stored in .*runs'; the same command goes on\.",
        last,
    )
    assert not list(tmp_path.glob("*.lock")) + list(tmp_path.glob("runs/*.lock"))


@pytest.mark.parametrize("written", ["5-3", "5.3", "5_3", "fig5-3", "Fig. 5.3", "figure 5-3"])
def test_the_number_of_a_figure_may_be_written_as_in_books(written: str) -> None:
    assert figure(written).number == "5-3"

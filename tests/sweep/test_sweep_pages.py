"""What the page on sweeps shows: designs are read, commands and queries answered, the example runs."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from torsade.sweep import Sweep

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "sweeps.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.M | re.S)


COMMANDS = [line for block in blocks("console") for line in block.splitlines()]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where pieces.toml is, and its sweep, made smaller."""
    place = tmp_path_factory.mktemp("page")
    text = blocks("toml")[0]
    for long, short in (
        ('step = "30 deg"', 'step = "240 deg"'),
        ("to = 19", "to = 2"),
        ("0.02, 0.05, ", ""),
    ):
        assert long in text
        text = text.replace(long, short)
    (place / "pieces.toml").write_text(text)
    Sweep.read(place / "pieces.toml").run(place / "pieces", workers=1)
    return place


def test_designs_shown_are_read(tmp_path: Path) -> None:
    sizes = []
    for text in blocks("toml"):
        (tmp_path / "a.toml").write_text(text)
        sizes.append(len(Sweep.read(tmp_path / "a.toml").points()))
    assert sizes == [11 * 3 * 20, 3 * 5 * 2 * 8]


@pytest.mark.parametrize("line", [line for line in COMMANDS if "--scheduler" not in line])
def test_commands_shown_do_what_they_say(line: str, folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], capture_output=True, text=True, check=False, cwd=folder
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout


def test_the_query_shown_finds_fewer_pieces_of_a_twisted_rod(folder: Path) -> None:
    (line,) = [line for line in COMMANDS if "round(degrees(twist))" in line]
    *_, sql = shlex.split(line)
    found = Sweep.read(folder / "pieces.toml").run(folder / "pieces", workers=1).query(sql).arrays()
    assert found["deg"].tolist() == [0.0, 240.0]
    assert found["pieces"][0] > found["pieces"][1]


def test_the_examples_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sweep, ensemble = blocks("python")
    monkeypatch.chdir(tmp_path)
    known: dict[str, Any] = {}
    exec(compile(sweep.replace('"count": 14', '"count": 3'), "sweeps.md", "exec"), known)
    assert float(capsys.readouterr().out) > 0
    exec(compile(ensemble.replace("0.2 s", "2 ms"), "sweeps.md", "exec"), known)
    assert [result.spec["force"] for result in known["results"]] == [5.0, 10.0, 15.0, 20.0]

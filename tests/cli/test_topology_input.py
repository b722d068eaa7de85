"""What `torsade topology` is given: long codes, files that hardly close, an output that is full."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import torsade as ts
from torsade.cli.messages import say
from torsade.cli.subject import subject
from torsade.cli.topology import report
from torsade.cli.topology_table import rows
from torsade.topology.codes import from_braid, to_dt, to_gauss, to_pd, to_unsigned_gauss


def shell(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", "topology", *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
    )


def found(text: str, pulled: str | None = None) -> dict[str, Any]:
    return report(subject(text), pulled, 0)


def table(text: str) -> list[tuple[str, str]]:
    return list(rows(found(text)))


def value(text: str, name: str) -> str:
    return next(value for row, value in table(text) if row == name)


def twisted(n: int) -> dict[str, str]:
    """A strand wound around another n times, in all notations."""
    drawn = from_braid([1] * n)
    return {
        "PD": " ".join(f"X{list(row)}" for row in to_pd(drawn)),
        "PD in brackets": str([list(row) for row in to_pd(drawn)]),
        "Gauss": to_gauss(drawn),
        "unsigned Gauss": f"Gauss: {to_unsigned_gauss(drawn)}",
        "DT": f"DT: {to_dt(drawn)}",
        "braid": "{" + ",".join(["1"] * n) + "}",
        "Conway": f"C[{n} 0 0]",
        "Conway, long": "[" + ";".join(["1"] * n) + "]",
    }


@pytest.mark.parametrize("n", [60, 100, 200])
@pytest.mark.parametrize("notation", list(twisted(2)))
def test_long_codes(n: int, notation: str) -> None:
    """Texts longer than the name of a file may be."""
    assert found(twisted(n)[notation])["crossings"] == n


@pytest.mark.parametrize("notation", ["PD", "DT"])
def test_long_codes_from_the_shell(notation: str, tmp_path: Path) -> None:
    code = twisted(100)[notation]
    done = shell(code, "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["crossings"] == 100
    assert shell("3_1" * 200, cwd=tmp_path).stderr.startswith("torsade: nothing is called '3_13_1")
    assert shell(code + ".csv", cwd=tmp_path).returncode == 2


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("|",), "'|' is no name, and no code that is read here; codes begin with X[ or [[ for PD"),
        (("Y[1,5,2,4]",), "is no name, and no code that is read here"),
        (("[4,6,2]",), "may be a DT code or Conway notation"),
        (("[1 999999999]",), "the Conway code has more than 500 crossings"),
        (("braid: 999999999",), "the braid word has more than 500 strands"),
        (("X[1,5,2,4] X[3,1,4,6] X[5,3,6,7]",), "name the edges of a tangle A0, A1 ...\n"),
        (("reef", "--pulled", ""), "--pulled is ''; give one of each open strand, A0 or A1 and B0 or B1"),
        (("reef", "--pulled", "A1A0"), "--pulled is 'A1A0'; give one of each open strand"),
        (("reef", "--directoin", "x"), "did you mean --direction?"),
        (("reef", "--direction"), "--direction has no value"),
    ],
)
def test_refusals(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = shell(*arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert says in done.stderr


def test_a_sentence_keeps_its_dots(capsys: pytest.CaptureFixture[str]) -> None:
    for sentence in ("give A0, A1 ...", "no.", "no", "why?"):
        say(sentence)
    assert capsys.readouterr().err.splitlines() == [
        "torsade: give A0, A1 ...", "torsade: no.", "torsade: no.", "torsade: why?"
    ]  # fmt: skip


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
@pytest.mark.parametrize("arguments", [("reef", "--json"), ("3_1",), ("--help",)])
def test_an_output_that_cannot_be_written(arguments: tuple[str, ...]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "torsade", "topology", *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert done.stderr == (
        "torsade: cannot write the output (no space left on device); make room, or write it elsewhere.\n"
    )


# --- what is said


def test_mirror_images_that_codes_leave_open() -> None:
    sum_code = f"DT: {to_dt(ts.topology.named_diagram('3_1#m3_1'))}"
    answer = found(sum_code)
    assert (answer["names"], answer["certain"]) == (["3_1#3_1", "3_1#m3_1"], False)
    assert "the mirror image of each summand open" in answer["reason"]
    prime = found("O1U2O3U1O2U3")
    assert (prime["names"], prime["certain"]) == (["3_1"], True)
    assert prime["reason"].startswith("the code leaves the mirror image open")
    assert found("O1+U2+O3+U1+O2+U3+")["reason"] is None


def test_the_unknot_has_one_name() -> None:
    for text in ("unknot", "{1,-1}", "L2a1"):
        for name, shown in table(text):
            if name == "name" or name.endswith("alone"):
                assert "0_1" not in shown
                assert "unknot" in shown or text == "L2a1"
    assert value("{1,-1}", "name") == "unknot ⊔ unknot"
    assert value("10_1", "name") == "10_1"
    assert found("{1,-1}")["names"] == ["0_1 ⊔ 0_1"]


def test_what_lies_outside_is_said_where_it_is_not_given() -> None:
    assert value("3_1", "circulation Gamma") == "1, the longest face taken to lie outside"
    assert found("3_1")["outside"] == "longest face"
    assert value("{1,1,1}", "circulation Gamma") == "1"
    assert found("{1,1,1}")["outside"] == "given"
    assert found("reef")["outside"] is None
    assert found("unknot")["outside"] is None


# --- files


def file_of(path: Path, x: np.ndarray) -> str:
    ts.write_csv(ts.Centerline((x,), (False,)), path)
    return str(path)


def ring(n: int) -> np.ndarray:
    t = 2 * np.pi * np.arange(n) / n
    return np.stack([np.cos(t), np.sin(t), 0.1 * np.sin(2 * t)], axis=1)


def test_ends_that_are_one_edge_apart_are_noted(tmp_path: Path) -> None:
    note = "the ends of strand A are one edge apart; if it is closed, repeat its first node at the end"
    path = file_of(tmp_path / "ring.csv", ring(200))
    assert found(path)["notes"] == [note]
    assert ("note", note) in table(path)
    assert found(file_of(tmp_path / "wide.csv", ring(200)[:-5]))["notes"] == []
    assert found(file_of(tmp_path / "closed.csv", np.vstack([ring(200), ring(200)[:1]])))["notes"] == []
    assert found("reef")["notes"] == []


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e9])
def test_ends_that_nearly_meet_are_refused(tmp_path: Path, size: float) -> None:
    x = size * np.vstack([ring(200), ring(200)[:1] + 1e-13])
    with pytest.raises(ts.TorsadeError, match=r"is the first one but for .* m; repeat the first exactly if"):
        found(file_of(tmp_path / "ring.csv", x))


def test_crossings_made_by_leading_out_ends_are_told_apart(tmp_path: Path) -> None:
    """A figure-eight knot cut open here and there, its ends in the midst of the drawing or not."""
    (x,) = ts.topology.braid_curves([1, -2, 1, -2])
    told = 0
    for k in range(0, len(x), len(x) // 12):
        path = file_of(tmp_path / "open.csv", np.roll(x, -k, axis=0)[: -len(x) // 12])
        led = found(path)["projection"]["led_out"]
        shown = value(path, "crossings N")
        assert shown.endswith(f"; {led} made by leading out ends") == (led > 0)
        told += led
    assert told
    assert "leading out" not in value("reef", "crossings N")

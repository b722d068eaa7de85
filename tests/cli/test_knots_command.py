"""`torsade knots`: list, show and build."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import torsade as ts
from torsade.cli.knots import build_knot, list_knots, show_knot
from torsade.topology import identify_curves

NO_LENGTHS: dict[str, str | None] = dict.fromkeys(("radius", "length", "lead", "tail", "spacing"))


def shell(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", "knots", *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
    )


def shown(capsys: pytest.CaptureFixture[str], name: str) -> dict[str, Any]:
    assert show_knot(name, json=True) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def test_everything_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert list_knots("", None, json=True) == 0
    rows = json.loads(capsys.readouterr().out)
    names = [row["name"] for row in rows]
    assert {"reef", "thief", "overhand", "5,-3", "T(3,4)", "10_165", "L6a4", "bowline13"} <= set(names)
    assert len(names) == len(set(names)) == len(ts.knots.search())
    assert list_knots("", None, json=False) == 0
    text = capsys.readouterr().out
    for word in ("Zeppelin bend", "3_1 ... 10_165", "250 in all", "torsade knots show NAME"):
        assert word in text


def test_part_of_a_name_is_found(capsys: pytest.CaptureFixture[str]) -> None:
    list_knots("fisher", None, json=False)
    text = capsys.readouterr().out
    assert "double_fisherman" in text
    assert "2 names" in text
    with pytest.raises(ts.TorsadeError, match="nothing has 'zzz' in its name"):
        list_knots("zzz", None, json=False)


def test_a_bend_is_shown_with_its_pulls(capsys: pytest.CaptureFixture[str]) -> None:
    reef = shown(capsys, "square knot")
    assert (reef["name"], reef["kind"], reef["pulled"], reef["crossings"]) == ("reef", "bend", "A1B1", 6)
    assert {pull["pulled"]: pull["circulation"] for pull in reef["pulls"]} == {
        "A1B1": 4.0,
        "A1B0": 1.0,
        "A0B1": 1.0,
        "A0B0": 4.0,
    }
    assert reef["abok"] == ["1204"]
    show_knot("reef", json=False)
    text = " ".join(capsys.readouterr().out.split())
    assert "pulled by A1B1 Wr +0, tau 1, Gamma 4: reef, as usual" in text
    assert "#1204" in text


def test_a_closed_knot_is_shown_with_its_codes(capsys: pytest.CaptureFixture[str]) -> None:
    knot = shown(capsys, "8_19")
    assert knot["codes"]["conway"] == "[3;3;2-]"
    assert knot["unknotting_number"] == "3"
    assert knot["ropelength"] == pytest.approx(60.99, abs=0.01)
    assert shown(capsys, knot["codes"]["pd"])["crossings"] == 8
    assert shown(capsys, "overhand")["ends"] == ["A0", "A1"]


def test_a_knot_is_built_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "knot.csv")
    lengths = NO_LENGTHS | {"radius": "1 mm", "length": "10 cm"}
    assert build_knot("m5_2", out, lengths, None, None, json=True, overwrite=False) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["radius_m"] == 1e-3
    assert found["clearance_m"] >= 2.1e-3 * (1 - 1e-9)
    assert found["h_kappa"] <= 0.5
    (strand,) = found["strands"]
    assert strand["closed"]
    assert strand["length_m"] == pytest.approx(0.1, rel=1e-3)
    read = ts.read_centerline(out)
    assert identify_curves(read.strands).names == ("m5_2",)
    with pytest.raises(ts.TorsadeError, match="exists already"):
        build_knot("m5_2", out, lengths, None, None, json=True, overwrite=False)
    assert build_knot("3_1", out, NO_LENGTHS, None, None, json=False, overwrite=True) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "read again the curve is this knot" in text


def test_a_bend_is_built_as_it_is_pulled(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, pulled, expected in (("thief", None, "A1B0"), ("reef", "a0b0", "A0B0")):
        build_knot(name, None, NO_LENGTHS, pulled, None, json=True, overwrite=False)
        assert json.loads(capsys.readouterr().out)["pulled"] == expected


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("shw",), "choose knots list, knots show or knots build"),
        (("show",), "nothing is given; give a name such as reef"),
        (("show", "zepelin"), "did you mean 'zeppelin'"),
        (("show", "reef", "granny"), "'granny' comes after what the command is about"),
        (("list", "--kind", "bends"), "choose one of bend, strand"),
        (("build",), "nothing is given"),
        (("build", "reef"), "there is nowhere to put the fiber"),
        (("build", "reef", "--out"), "--out has no value"),
        (("build", "reef", "--out", "a.foo"), "is no format of curves"),
        (("build", "3_1", "--json", "--length", "1 mm"), "the shortest fiber made of this diagram"),
        (("build", "3_1", "--json", "--length", "1 kg"), "is a mass, not a length"),
        (("build", "reef", "--json", "--colour", "red"), "has no option --colour"),
    ],
)
def test_refusals(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = shell(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert says in " ".join(done.stderr.split())
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr

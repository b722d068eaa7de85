"""`torsade topology` from the real shell: names, codes, files, JSON, and refusals in one sentence."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import torsade as ts
from torsade.cli.subject import subject
from torsade.cli.topology import report
from torsade.cli.topology_table import rows

KEYS = {
    "input", "kind", "title", "strands", "ends", "pulled", "crossings", "charges", "writhe", "linking", "tau",
    "circulation", "circulation_range", "whitney", "faces", "fewest", "pulls", "strand_types", "closures",
    "names", "certain", "reason", "alexander", "determinant", "signature", "jones", "writhe_3d", "acn",
    "linking_3d", "projection", "closed_at_infinity", "codes",
}  # fmt: skip


def shell(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", "topology", *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
    )


def found(text: str, pulled: str | None = None, drawings: int = 0) -> dict[str, Any]:
    """The report, which always has the same keys and becomes JSON."""
    answer = report(subject(text), pulled, drawings)
    assert set(answer) == KEYS
    assert all(isinstance(value, str) for row in rows(answer) for value in row)
    loaded: dict[str, Any] = json.loads(json.dumps(answer, allow_nan=False))
    return loaded


def loop(path: Path, *curves: np.ndarray, closed: bool = True) -> str:
    """A file of curves."""
    ts.write_csv(ts.Centerline(tuple(curves), (closed,) * len(curves)), path)
    return str(path)


# --- from the shell


def test_a_bend_as_a_table() -> None:
    done = shell("thief")
    assert (done.returncode, done.stderr) == (0, "")
    lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
    for line in (
        "bend Thief knot: reef (square) knot pulled by A1B0",
        "pulled A1B0: thief",
        "crossings N 6, 3 right-handed and 3 left-handed",
        "twist fluctuation tau 1",
        "circulation Gamma 1",
        "Whitney index +1",
        "strand A alone unknot",
        "joined B0-A0 B1-A1 3_1#m3_1",
    ):
        assert line in lines


def test_a_knot_as_json() -> None:
    done = shell("5_1", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    answer = json.loads(done.stdout)
    assert set(answer) == KEYS
    assert (answer["names"], answer["certain"], answer["reason"]) == (["5_1"], True, None)
    assert (answer["crossings"], answer["writhe"], answer["determinant"], answer["signature"]) == (
        5,
        5,
        5,
        -4,
    )
    assert answer["alexander"] == {
        "text": "t^-2 - t^-1 + 1 - t + t^2", "lowest": -2.0, "coefficients": [1, -1, 1, -1, 1]
    }  # fmt: skip
    assert answer["jones"]["text"] == "t^2 + t^4 - t^5 + t^6 - t^7"
    assert answer["closures"] is None
    assert answer["writhe_3d"] is None


def test_help_imports_nothing_heavy() -> None:
    script = (
        "import sys\nfrom torsade.cli import main\ntry:\n    main(['topology', '--help'])\n"
        "except SystemExit:\n    pass\nheavy = ('numba', 'numpy', 'scipy', 'xarray', 'zarr', 'pydantic')\n"
        "print([m for m in heavy if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
    for words in ("--pulled", "--drawings", "--json", "DT: 4 6 2", "torsade topology reef"):
        assert words in done.stdout


def test_a_suture_that_begins_with_a_hyphen() -> None:
    done = shell("-3,5", "--json", "--drawings", "0")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["writhe"] == 2


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((), "nothing is given; give a name such as reef or 5_1"),
        (("",), "nothing is given"),
        (("zepelin",), "did you mean 'zeppelin'?"),
        (("trefoill",), "did you mean 'trefoil'?"),
        (("3_2",), "no knot or link is called '3_2'"),
        (("11_1",), "prime knots through 10 crossings"),
        (("L10a1",), "links through 8"),
        (("3_1#nonsense",), "nothing is called '3_1#nonsense'"),
        (("3_1#9_99",), "in '3_1#9_99'"),
        (("4 6 2",), "say which code it is, such as 'DT: 4 6 2'"),
        (("DT: 3 5 1",), "the DT code has the odd entry 3"),
        (("DT: 4 6 8",), "does not have each of 2, 4 ... 6 once"),
        (("DT: 4 6 8 10 2",), "the DT code cannot be drawn in the plane"),
        (("DT:",), "the DT code is empty"),
        (("DT: 4 six 2",), "'six' in the DT code is no integer"),
        (("O1+ U2+ U1+ O2+",), "cannot be drawn in the plane"),
        (("Gauss: 1 -2 3 1 -2 3",), "passed 0 times above and 2 times below"),
        (("O1+ U1-",), "crossing 1 of the Gauss code has both signs"),
        (("O1 U1",), "nothing is called 'O1 U1'"),
        (("braid:",), "the braid word is empty"),
        (("{}",), "the braid word is empty"),
        (("{1,0,2}",), "an entry that is no generator"),
        (("{1,a}",), "'a' in the braid word is no integer"),
        (("X[1,5,2] X[3,1,4,6]",), "has 3 labels"),
        (("X[1,5,2,4] X[3,1,4,6] X[5,3,6,7]",), "label 2 occurs once in the PD code"),
        (("[[1,2,3,4],[1,3,2,4]]",), "PD code"),
        (("PD[abc]",), "PD code"),
        (("[3 2",), "has a bracket that is not closed"),
        (("[]",), "the Conway code is empty"),
        (("C[3;]",), "where a tangle is due"),
        (("5,-4",), "give two odd numbers"),
        (("none.csv",), "there is no file 'none.csv'"),
        (("no/such",), "there is no file 'no/such'"),
        (("reef", "--pulled", "A2B1"), "give one of each open strand, A0 or A1 and B0 or B1"),
        (("reef", "--pulled", "A1"), "give one of each open strand"),
        (("reef", "--pulled", "up"), "give one of each open strand"),
        (("5_1", "--pulled", "A1"), "all strands are closed"),
        (("reef", "--pulled"), "--pulled has no value"),
        (("reef", "--drawings", "many"), "--drawings is 'many'"),
        (("reef", "--jsn"), "did you mean --json?"),
        (("--jsn",), "has no option '--jsn'"),
        (("reef", "knot"), "'knot' comes after what the command is about"),
    ],
)
def test_refusals(tmp_path: Path, arguments: tuple[str, ...], says: str) -> None:
    done = shell(*arguments, cwd=tmp_path)
    assert done.returncode == 2, done
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith("torsade: ")
    assert says in done.stderr


@pytest.mark.parametrize(
    ("nodes", "says"),
    [
        ([(0, 0, 0), (2, 0, 0), (2, 2, 0), (1, -1, 0)], "meet"),
        ([(0, 0, 0), (1, 0, 0), (1, 0, 0), (0, 1, 0)], ""),
    ],
)
def test_a_polyline_that_meets_itself(tmp_path: Path, nodes: list[Any], says: str) -> None:
    path = loop(tmp_path / "mine.csv", np.array(nodes, dtype=float))
    done = shell(path, cwd=tmp_path)
    assert done.returncode == 2, done.stdout
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    assert says in done.stderr


# --- what is found


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("m3_1#3_1", ["3_1#m3_1"]),
        ("unknot", ["0_1"]),
        ("trefoil", ["3_1"]),
        ("cinquefoil", ["5_1"]),
        ("Whitehead link", ["L5a1"]),
        ("borromean rings", ["L6a4"]),
        ("mL4a1", ["mL4a1"]),
        ("{1,-2,1,-2}", ["4_1"]),
        ("[[1,5,2,4],[3,1,4,6],[5,3,6,2]]", ["3_1"]),
        ("O1+ U2+ O3+ U1+ O2+ U3+", ["3_1"]),
        ("{1,-1}", ["0_1 ⊔ 0_1"]),
        ("{1,1,1,3,3,3}", ["3_1 ⊔ 3_1"]),
    ],
)
def test_closed_names_and_codes(text: str, names: list[str]) -> None:
    answer = found(text)
    assert (answer["names"], answer["certain"]) == (names, True)
    assert answer["closures"] is None
    assert answer["pulled"] is None
    assert answer["determinant"] == abs(answer["determinant"])


def test_every_bend_by_name_and_pull() -> None:
    for name in ts.knots.bend_names():
        answer = found(name)
        counts = ts.topology.state(ts.knots.bend_diagram(name))
        assert (answer["crossings"], answer["writhe"], answer["whitney"]) == (
            counts.crossings,
            counts.writhe,
            counts.whitney,
        )
        assert (answer["tau"], answer["circulation"]) == (counts.tau, counts.gamma)
        assert [pull["pulled"] for pull in answer["pulls"]] == ["A1B1", "A1B0", "A0B1", "A0B0"]
        assert len(answer["closures"]) == 2
        assert len(answer["strand_types"]) == 2


def test_pulled_ends_in_any_order_and_case() -> None:
    assert found("reef", "b0a1")["pulled"] == "A1B0"
    assert found("reef", "A1B0")["circulation"] == found("thief")["circulation"] == 1


def test_the_range_of_gamma_is_left_out_or_limited() -> None:
    assert found("carrick")["circulation_range"] is None
    assert found("carrick", drawings=500)["circulation_range"] == {
        "least": 3.0,
        "greatest": 3.0,
        "crossings": 8,
        "drawings": 1,
        "complete": True,
    }
    assert found("hunter", drawings=3)["circulation_range"]["complete"] is False


@pytest.mark.parametrize("name", ["3_1", "m8_19", "L5a1", "3_1#4_1", "unknot"])
def test_codes_are_read_back(name: str) -> None:
    for kind, code in found(name)["codes"].items():
        if code and name != "unknot":
            names = found(code)["names"]
            assert names == found(name)["names"] or (kind == "dt" and len(names) == 1), (kind, code)


def test_codes_of_a_tangle_are_read_back() -> None:
    codes = found("carrick", "A1B0")["codes"]
    assert found(codes["pd"], "A1B0")["circulation"] == pytest.approx(10 / 3)
    assert codes["gauss"] is codes["dt"] is codes["conway"] is None


def test_a_file_is_looked_at_from_where_one_says(tmp_path: Path) -> None:
    built = ts.knots.bend("reef")
    path = tmp_path / "reef.csv"
    ts.write_csv(built, path)

    def seen(direction: str) -> dict[str, Any]:
        return report(subject(str(path), direction=direction), "A1B1", 0)

    assert seen("z")["projection"]["direction"] == pytest.approx([0, 0, 1], abs=0.05)
    assert seen("0, -2, 0")["projection"]["direction"] == pytest.approx([0, -1, 0], abs=0.05)
    assert seen("-x")["projection"]["direction"] == pytest.approx([-1, 0, 0], abs=0.05)
    fewest = seen("fewest")
    assert (fewest["crossings"], fewest["tau"]) == (6, 1)


@pytest.mark.parametrize("direction", ["0,0,0", "w", "1,2", "1,2,nan", "inf,0,0", ""])
def test_directions_that_are_none(tmp_path: Path, direction: str) -> None:
    (tmp_path / "a.csv").write_text("strand,x,y,z\n0,0,0,0\n0,1,0,0\n")
    with pytest.raises(ts.TorsadeError, match=r"--direction is .*; give an axis such as z, three numbers"):
        subject(str(tmp_path / "a.csv"), direction=direction)


def test_a_drawing_has_its_own_direction() -> None:
    with pytest.raises(ts.TorsadeError, match="'reef' is a drawing already; give it with a file"):
        subject("reef", direction="x")


def test_a_tangle_as_a_code() -> None:
    answer = found("X[B0,A1,B1,A0]")
    assert (answer["strands"], len(answer["ends"]), answer["crossings"]) == (2, 4, 1)
    assert answer["linking"] in ([[0.0, 0.5], [0.5, 0.0]], [[0.0, -0.5], [-0.5, 0.0]])


# --- files


def test_a_closed_file(tmp_path: Path) -> None:
    (x,) = ts.topology.braid_curves([1, 1, 1])
    answer = found(loop(tmp_path / "trefoil.csv", x))
    assert answer["names"] == ["3_1"]
    assert answer["writhe_3d"] == pytest.approx(ts.topology.writhe(x, True), abs=1e-12)
    assert answer["acn"] >= abs(answer["writhe_3d"])
    assert answer["projection"]["direction"] == [0.0, 0.0, 1.0]
    assert answer["closed_at_infinity"] == [None]
    assert answer["linking_3d"] is None


def test_a_link_in_a_file(tmp_path: Path) -> None:
    answer = found(loop(tmp_path / "hopf.csv", *ts.topology.braid_curves([1, 1])))
    assert answer["names"] == ["L2a1"]
    assert answer["linking"][0][1] == 1.0
    assert answer["linking_3d"][0][1] == pytest.approx(1.0, abs=1e-9)


def test_an_open_file(tmp_path: Path) -> None:
    knot = ts.knots.bend("reef")
    path = tmp_path / "reef.csv"
    ts.write_csv(knot, path)
    answer = found(str(path))
    assert (answer["crossings"], answer["tau"], answer["circulation"]) == (6, 1.0, 4.0)
    assert [closure["names"] for closure in answer["closures"]] == [["3_1#m3_1"], ["0_1 ⊔ 0_1"]]
    assert answer["pulled"] == "A1B1"
    for fractions in answer["closed_at_infinity"]:
        assert next(iter(fractions)) == "0_1"
        assert sum(fractions.values()) == pytest.approx(1)


def test_a_file_in_millimetres(tmp_path: Path) -> None:
    (x,) = ts.topology.braid_curves([1, -2, 1, -2])
    path = loop(tmp_path / "eight.csv", 1e3 * x)
    done = shell(path, "--length-unit", "mm", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["names"] == ["4_1"]
    assert "unit" in shell(path, "--length-unit", "mmm", cwd=tmp_path).stderr

"""`torsade trials` and `torsade material` from the shell: numbers, and one sentence for every mistake."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from torsade.cli import main
from torsade.fracture.measured import GRAVITY
from torsade.fracture.rod import spaghetti

ROD = spaghetti()

TRIALS = """twist_deg,end_distance_mm,lengths_mm,speed_mm_per_s,notes
0,176,90 30 120,3,first
0,180,95 25 50 70,30,
0,180,95 15 60 70,300,
300,225,121 118,3,
"""


def told(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    """Exit code, output and message of a command."""
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    out, err = capsys.readouterr()
    return int(stopped.value.code or 0), out, err


def table(folder: Path, name: str, text: str) -> str:
    path = folder / name
    path.write_text(text)
    return str(path)


def test_trials_for_machines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = told(["trials", table(tmp_path, "a.csv", TRIALS), "--json"], capsys)
    found = json.loads(out)
    assert code == 0
    assert [t["pieces"] for t in found["trials"]] == [3, 4, 4, 2]
    assert [t["fragment_estimate_m"] for t in found["trials"]] == pytest.approx([0.03, 0.025, 0.015, 0.06])
    assert found["ignored_columns"] == ["notes"]
    assert math.degrees(found["binary_threshold"]["twist_rad"]) == pytest.approx(257.8, abs=0.1)
    assert found["fits"]["fragment_m"]["exponent"]["value"] < 0
    assert sum(s["pieces"]["n"] for s in found["sectors"]) == 4


def test_trials_for_people(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = told(["trials", table(tmp_path, "a.csv", TRIALS)], capsys)
    assert code == 0
    assert "258 degrees at 10.00 1/m" in out
    assert "1 of 2, 1 of 3, 2 of 4" in out


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--criterion", "tresca"], "--criterion is 'tresca'; give one of effective, von_mises"),
        (["--rays", "all"], "--rays is 'all'; give one of ellipse or printed"),
        (["--length", "3 kg"], "--length '3 kg' is a mass, not a length"),
        (
            ["--length", "100 mm"],
            "longer than the rod of 100 mm; check the unit in the heading and the length",
        ),
        (["--strength", "0"], "--strength is '0'; give more than 0"),
        (["--amplification", "0.5"], "--amplification is 0.5; give 1 or more"),
        (["--sectors", "0"], "--sectors is '0'; give a whole number"),
        (["--material", "cheese"], "unknown material 'cheese'"),
        (["--lenght", "1 m"], "trials has no option --lenght; did you mean --length?"),
    ],
)
def test_refused(
    options: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = told(["trials", table(tmp_path, "a.csv", TRIALS), *options], capsys)
    assert (code, out) == (2, "")
    assert sentence in err
    assert err.count("\n") == 1


def test_nothing_given(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = told(["trials"], capsys)
    assert (code, err) == (2, "torsade: nothing is given; give a CSV file of trials, such as trials.csv.\n")


class TestMaterial:
    RADIUS = ("--radius", "0.7 mm", "--radius-error", "0.025 mm")

    def files(self, folder: Path) -> dict[str, str]:
        """Samples and tracks that spaghetti would give, with a mass of 2 kg mm^2 on the pendulum."""
        lengths = (0.15, 0.2, 0.24)
        buckled = [1e3 * math.pi**2 * ROD.B / (GRAVITY * l**2) for l in lengths]
        weighed = [1e3 * ROD.rho * ROD.section.A * l for l in lengths]
        omega = math.sqrt(ROD.C / (2e-6 * 0.2))
        decay = 2 * 1.68e4 * ROD.rho * ROD.section.I * (0.2 / 3) / 2e-6
        time = np.linspace(0, 2, 300)
        angle = np.degrees(0.5 * np.exp(-decay * time) * np.cos(math.sqrt(omega**2 - decay**2) * time))
        return {
            "--buckling": table(
                folder, "b.csv", self.csv("mass_g,length_mm", buckled, [1e3 * l for l in lengths])
            ),
            "--weights": table(
                folder, "w.csv", self.csv("mass_g,length_mm", weighed, [1e3 * l for l in lengths])
            ),
            "--pendulum": table(
                folder, "p.csv", self.csv("time_s,angle_deg,length_mm", time, angle, np.full(300, 200.0))
            ),
        }

    @staticmethod
    def csv(head: str, *columns: object) -> str:
        rows = zip(*columns, strict=True)  # type: ignore[call-overload]
        return head + "\n" + "".join(",".join(repr(float(x)) for x in row) + "\n" for row in rows)

    def test_spaghetti_comes_back(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        given = [word for pair in self.files(tmp_path).items() for word in pair]
        options = [*self.RADIUS, "--inertia", "2 kg mm^2", "--mass-height", "1 cm", "--json"]
        code, out, _ = told(["material", *given, *options], capsys)
        found = json.loads(out)
        assert code == 0
        assert found["E_Pa"]["value"] == pytest.approx(ROD.E, rel=1e-9)
        assert found["mu_Pa"]["value"] == pytest.approx(ROD.mu, rel=1e-6)
        assert found["rho_kg_per_m3"]["value"] == pytest.approx(ROD.rho, rel=1e-9)
        assert found["nu"]["value"] == pytest.approx(0.3, abs=1e-5)
        assert found["b_per_s"]["value"] == pytest.approx(1.68e4, rel=1e-4)
        assert found["b_printed_per_s"]["value"] == pytest.approx(1.68e4 * 20 / 3, rel=1e-4)
        # The radius is the same in E and mu, and its error falls out of their ratio.
        assert found["E_Pa"]["error"] > 0.1 * ROD.E
        assert found["nu"]["error"] < 0.01

    @pytest.mark.parametrize(
        ("options", "sentence"),
        [
            ((), "nothing was measured; give --buckling, --weights or --pendulum"),
            (("--weights", "none.csv"), "there is no file 'none.csv'; give the path of a file of samples"),
            (("--pendulum", "p.csv"), "--pendulum comes without --inertia"),
            (
                ("--pendulum", "p.csv", "--inertia", "2 kg"),
                "--inertia '2 kg' is a mass, not a moment of inertia",
            ),
        ],
    )
    def test_refused(
        self, options: tuple[str, ...], sentence: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        code, out, err = told(["material", *self.RADIUS, *options], capsys)
        assert (code, out) == (2, "")
        assert sentence in err

    def test_a_negative_mass(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = table(tmp_path, "w.csv", "mass_g,length_mm\n1,200\n-1,200\n")
        code, _, err = told(["material", *self.RADIUS, "--weights", path], capsys)
        assert code == 2
        assert "line 3 has a mass that is not above 0" in err

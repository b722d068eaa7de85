"""The command line as it is meant to be used."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import torsade as ts
from torsade.protocols import PROTOCOLS

SHORT = ("run", "prison-escape", "--knot", "reef", "--duration", "5 ms", "--frames", "4")


def shell(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", *arguments], capture_output=True, text=True, cwd=cwd, check=False
    )


def test_version_and_help(tmp_path: Path) -> None:
    assert shell("--version", cwd=tmp_path).stdout.strip() == ts.__version__
    text = shell("--help", cwd=tmp_path).stdout
    assert "demo" in text
    assert "run" in text


def test_help_imports_nothing_heavy(tmp_path: Path) -> None:
    script = (
        "import sys\nfrom torsade.cli import main\ntry:\n    main(['--help'])\nexcept SystemExit:\n    pass\n"
        "heavy = ('numba', 'numpy', 'xarray', 'zarr', 'pydantic', 'matplotlib', 'pyvista')\n"
        "print([m for m in heavy if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_every_field_is_an_option(tmp_path: Path, protocol: str) -> None:
    text = shell("run", protocol, "--help", cwd=tmp_path).stdout
    for name in PROTOCOLS[protocol].model_fields:
        assert name == "protocol" or f"--{name.replace('_', '-')} " in text
    assert "--no-" not in text
    assert "--empty-" not in text


def test_json_is_alone_and_agrees_with_the_stored_result(tmp_path: Path) -> None:
    done = shell(*SHORT, "--json", "--out", "reef.zarr", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    report = json.loads(done.stdout)
    stored = ts.open(tmp_path / "reef.zarr")
    assert report["times_s"] == stored.dataset["time"].values.tolist()
    assert report["separation_m"] == stored.dataset["separation"].values.tolist()
    assert report["compression_N"] == stored.dataset["compression"].values.tolist()
    assert report["twist_rad"] == stored.dataset["twist"].values.T.tolist()
    assert report["c_f"] == stored.c_f
    assert report["slipped_at_s"] is None
    assert report["steps"] == stored.dataset.attrs["steps"]


def test_a_bent_fiber_in_numbers_and_pictures(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    arguments = ("run", "bend-twist", "--end-distance", "19 cm", "--twist", "270 deg")
    done = shell(*arguments, "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    numbers = json.loads(done.stdout)
    assert numbers["kappa_max_per_m"] == pytest.approx(13.3755, rel=1e-4)
    assert numbers["stable"] is True
    done = shell(*arguments, "--end-distance-error", "1 mm", "--plot", "bent.svg", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for words in ("240 mm, ends 190 mm apart", "grips turned by 272.55 deg", "13.375 1/m, between 13.23"):
        assert words in done.stdout
    assert (tmp_path / "bent.svg").stat().st_size > 1000


def test_a_table_names_the_files(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    done = shell(*SHORT, "--out", "reef.zarr", "--plot", "reef.svg", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "topological friction c_f" in done.stdout
    assert "no, not within 0.005 s" in done.stdout
    assert "mm/s, from 0 s to 0.005 s" in done.stdout
    assert "nylon, radius 0.2 mm" in done.stdout
    assert "A1 clamped, B1 pulled" in done.stdout
    assert "mm at 0.005 s" in done.stdout
    assert "reef.zarr" in done.stdout
    assert (tmp_path / "reef.svg").stat().st_size > 1000
    again = shell(*SHORT, "--out", "reef.zarr", cwd=tmp_path)
    assert again.returncode == 2
    assert "--overwrite" in again.stderr
    assert shell(*SHORT, "--out", "reef.zarr", "--overwrite", cwd=tmp_path).returncode == 0


def test_a_specification_file_with_and_without_its_protocol(tmp_path: Path) -> None:
    text = 'protocol = "prison-escape"\nknot = "reef"\nduration = "5 ms"\nframes = 4\nforce = "12 N"\n'
    (tmp_path / "reef.toml").write_text(text)
    one = shell("run", "prison-escape", "--spec", "reef.toml", "--frames", "2", "--json", cwd=tmp_path)
    two = shell("run", "--frames", "2", "--spec", "reef.toml", "--json", cwd=tmp_path)
    assert one.returncode == two.returncode == 0, one.stderr + two.stderr
    first, second = json.loads(one.stdout), json.loads(two.stdout)
    assert len(first["times_s"]) == 3
    np.testing.assert_array_equal(first["separation_m"], second["separation_m"])


@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C is sent otherwise there")
def test_ctrl_c_says_what_is_saved_and_how_to_go_on(tmp_path: Path) -> None:
    command = ("run", "prison-escape", "--knot", "reef", "--duration", "60 s", "--frames", "60000")
    process = subprocess.Popen(
        [sys.executable, "-m", "torsade", *command, "--out", "reef.zarr"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
    )
    part = tmp_path / "reef.zarr.part"
    try:
        for _ in range(1200):
            if (part / "restart.npz").exists() and ts.open(part).frames > 5:
                break
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "frames are saved in 'reef.zarr.part'" in error
    assert "--resume" in error
    assert "stopping ..." in error
    assert "Traceback" not in error
    stored = ts.open(part)
    assert stored.frames > 5
    assert np.isfinite(stored.dataset["position"]).all()
    assert stored.dataset.attrs["status"] == "interrupted"


@pytest.mark.slow
def test_the_demo(tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    done = shell("demo", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "torsade run prison-escape --knot thief" in done.stdout
    assert sorted(p.name for p in (tmp_path / "demo").iterdir()) == [
        "reef-separation.png",
        "reef.png",
        "reef.zarr",
    ]
    assert ts.open(tmp_path / "demo" / "reef.zarr").slipped_at is None


DRAWING = """
import sys
from torsade.view import plots, scene
def stop(*arguments, **options):
    raise KeyboardInterrupt
{where} = stop
from torsade.cli import main
main(sys.argv[1:])
"""


def test_ctrl_c_while_drawing_says_that_the_result_is_complete(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    script = DRAWING.format(where="plots.plot_separation")
    done = subprocess.run(
        [sys.executable, "-c", script, *SHORT, "--out", "reef.zarr", "--plot", "reef.png"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert done.returncode == 130
    assert done.stderr == (
        "torsade: interrupted while drawing 'reef.png'; the result is complete in 'reef.zarr'.\n"
    )
    assert "topological friction" in done.stdout
    assert ts.open(tmp_path / "reef.zarr").complete


def test_a_picture_that_fails_keeps_neither_numbers_nor_plot_away(tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    failing = (
        "from torsade.errors import TorsadeError\ndef stop(*_, **__):\n    raise TorsadeError('no lamp')\n"
    )
    script = failing + DRAWING.replace("def stop", "def unused").format(where="scene.render_result")
    done = subprocess.run(
        [sys.executable, "-c", script, *SHORT, "--json", "--picture", "reef.png", "--plot", "reef.svg"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert (done.returncode, done.stderr) == (2, "torsade: no lamp.\n")
    assert json.loads(done.stdout)["steps"] > 0
    assert (tmp_path / "reef.svg").exists()


def test_a_very_early_ctrl_c_is_clean(tmp_path: Path) -> None:
    script = (
        "import sys\nclass Stop:\n    def find_spec(self, name, *_):\n        if name == 'cyclopts':\n"
        "            raise KeyboardInterrupt\nsys.meta_path.insert(0, Stop())\n"
        "from torsade.cli import main\nmain(['run'])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (130, 1)
    assert done.stderr.startswith("torsade: interrupted before the first frame")


def test_a_centerline_in_millimetres_and_semicolons(tmp_path: Path) -> None:
    from torsade.knots import strand

    (x,) = strand("overhand", "0.2 mm").strands
    rows = [f"0;{1e3 * a!r};{1e3 * b!r};{1e3 * c!r}" for a, b, c in x.tolist()]
    (tmp_path / "mine.csv").write_text("strand;x;y;z\n" + "\n".join(rows))
    short = ("--duration", "2 ms", "--frames", "1")
    done = shell(
        "run", "tighten", "--centerline", "mine.csv", "--length-unit", "mm", *short, "--json", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["length_m"][0] == pytest.approx(ts.curve.length(x), rel=0.01)
    assert "--length-unit" in shell("run", "tighten", "--centerline", "mine.csv", cwd=tmp_path).stderr


def test_the_path_of_a_result_is_printed_in_one_line(tmp_path: Path) -> None:
    name = "a" * 100 + ".zarr"
    done = shell(*SHORT, "--out", name, cwd=tmp_path)
    assert f"result{' ' * 20}{name}\n" in done.stdout

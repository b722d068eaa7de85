"""What README and docs promise: examples run, commands exist, links lead somewhere."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import torsade as ts
from torsade.cli.app import OPTIONS
from torsade.protocols import PROTOCOLS

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])


def blocks(page: Path, language: str) -> list[str]:
    """Code blocks of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)


def commands() -> list[str]:
    """Every torsade command that the pages show."""
    lines = [line for page in PAGES for block in blocks(page, "console") for line in block.splitlines()]
    return [line for line in lines if line.startswith("torsade ")]


def anchor(heading: str) -> str:
    """The anchor that a heading gets when it is rendered."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def test_the_python_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The README's example, for a hundredth of its duration."""
    (example,) = blocks(ROOT / "README.md", "python")
    assert example.count('"1 s"') == 1
    monkeypatch.chdir(tmp_path)
    exec(compile(example.replace('"1 s"', '"10 ms"'), "README.md", "exec"), {})
    friction, separation, strain = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"topological friction \d+\.\d", friction)
    assert 1e-3 < float(separation.removesuffix(" m")) < 1e-1
    assert 0 < float(strain) < 1


def test_commands_are_found() -> None:
    """The tests below have something to test."""
    assert {line.split()[1] for line in commands()} == {
        "run",
        "topology",
        "convert",
        "tight",
        "knots",
        "figure",
        "movie",
        "trials",
        "material",
        "sweep",
        "query",
        "info",
        "export",
        "open",
    }
    assert len(commands()) >= 5


@pytest.mark.parametrize("line", [line for line in commands() if line.split()[1] == "topology"])
def test_a_topology_shown_is_read(line: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("line", [line for line in commands() if line.split()[1] == "figure"])
def test_a_figure_shown_is_made(line: str, tmp_path: Path) -> None:
    """Quickly, where it is asked to be whole."""
    quick = [*shlex.split(line), "--quick"]
    done = subprocess.run(
        [sys.executable, "-m", *quick], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    folder = quick[quick.index("--out") + 1] if "--out" in quick else "figures"
    assert (tmp_path / folder / f"figure-{quick[2]}.png").stat().st_size > 10_000


LABORATORY = {
    "trials.csv": "lengths_mm,twist_deg,speed_mm_per_s\n90 30 120,0,3\n120 120,300,3\n",
    "masses.csv": "mass_g,length_mm\n32,150\n15,220\n",
    "weights.csv": "mass_g,length_mm\n0.55,240\n0.56,240\n",
}
"""What the files of the commands shown may hold."""


@pytest.mark.parametrize("line", [line for line in commands() if line.split()[1] in ("trials", "material")])
def test_measurements_shown_are_read(line: str, tmp_path: Path) -> None:
    for name, text in LABORATORY.items():
        (tmp_path / name).write_text(text)
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("line", [line for line in commands() if line.split()[1] == "convert"])
def test_a_conversion_shown_is_done(line: str, tmp_path: Path) -> None:
    _, _, given, out, *options = shlex.split(line)
    (x,) = ts.knots.strand("overhand", "0.2 mm").strands
    ts.write_centerline(ts.Centerline((1e3 * x if "mm" in options else x,)), tmp_path / given)
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / out).stat().st_size > 1000


@pytest.mark.parametrize("line", [line for line in commands() if line.split()[1] in ("tight", "knots")])
def test_a_knot_shown_is_made(line: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("line", [line for line in commands() if line.split()[1] == "movie"])
def test_a_movie_shown_lacks_nothing_but_its_result(line: str, tmp_path: Path) -> None:
    """Options are read before the result is looked for."""
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.returncode == 2
    assert "zarr' does not exist; give a folder" in done.stderr


@pytest.mark.parametrize("line", [line for line in commands() if line.split()[1] == "run"])
def test_a_command_shown_is_a_valid_specification(line: str) -> None:
    _, run, protocol, *arguments = shlex.split(line)
    assert run == "run"
    fields = {}
    while arguments:
        option = arguments.pop(0)
        name = option.removeprefix("--").replace("-", "_")
        value = True if OPTIONS.get(name, (str, ""))[0] is bool else arguments.pop(0)
        if name not in OPTIONS:
            fields[name] = value
    PROTOCOLS[protocol](**fields)


@pytest.mark.parametrize(
    "words",
    [
        (),
        ("demo",),
        ("topology",),
        ("convert",),
        ("tight",),
        ("knots",),
        ("trials",),
        ("material",),
        ("sweep",),
        ("query",),
        ("run", "prison-escape"),
        ("run", "tighten"),
        ("run", "bend-twist"),
    ],
)
def test_help_comes(words: tuple[str, ...]) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "torsade", *words, "--help"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("Usage: torsade")


def test_the_example_without_torsade_runs_without_it(stored: Callable[[str], Path], tmp_path: Path) -> None:
    """The page's second block of Python, where torsade cannot be imported."""
    shutil.copytree(stored("prison-escape"), tmp_path / "reef.zarr")
    plain = next(
        block for block in blocks(ROOT / "docs" / "results.md", "python") if "import xarray" in block
    )
    script = "import sys\nsys.modules['torsade'] = None\n" + plain
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    said = done.stdout.splitlines()
    assert said[0] == "prison-escape reef 15.0 N"
    assert said[1].startswith("largest strain of strand B: 0.")
    assert "position ('time', 'node', 'space') m node positions" in said


def test_the_example_with_torsade_runs(
    stored: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All but the window."""
    shutil.copytree(stored("prison-escape"), tmp_path / "reef.zarr")
    example = next(b for b in blocks(ROOT / "docs" / "results.md", "python") if "import torsade" in b)
    monkeypatch.chdir(tmp_path)
    exec(compile(example.replace("run.show()", ""), "results.md", "exec"), {})
    assert (tmp_path / "reef.glb").stat().st_size > 10_000


@pytest.mark.parametrize(
    "line", [line for line in commands() if line.split()[1] in ("info", "export", "open")]
)
def test_a_result_shown_is_described_and_written(
    line: str, stored: Callable[[str], Path], tmp_path: Path
) -> None:
    shutil.copytree(stored("prison-escape"), tmp_path / "reef.zarr")
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(line)], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_readme_has_two_commands_for_a_fresh_machine() -> None:
    """What `.ci/run` executes."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.findall(r"^(?:python3 -m venv|\.venv/bin/pip) .*$", text, re.M)
    assert len(found) == 2
    assert found[0].endswith("torsade demo")
    assert found[1].endswith("pytest -n auto")


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if link.startswith(("https://", "http://")):
            continue
        path, _, fragment = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        if fragment:
            headings = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.M)
            assert fragment in [anchor(h) for h in headings], link


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_tests_named_exist(page: Path) -> None:
    for path in re.findall(r"`(tests/[\w/]+\.py)`", page.read_text(encoding="utf-8")):
        assert (ROOT / path).is_file(), path


def test_architecture_names_every_module() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    for entry in (ROOT / "src" / "torsade").iterdir():
        if entry.name.startswith("__") or not (entry.is_dir() or entry.suffix == ".py"):
            continue
        assert f"`{entry.stem}`" in text or f"`{entry.stem}/`" in text, entry.name


def test_the_citation_parses() -> None:
    yaml = pytest.importorskip("yaml")
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == ts.__version__
    assert citation["authors"]
    assert citation["title"]
    assert citation["message"]

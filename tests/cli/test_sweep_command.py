"""`torsade sweep` and `torsade query` from the shell: what they say, and what a kill or Ctrl-C leaves."""

from __future__ import annotations

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

BENT = """
protocol = "bend-twist"
[fixed]
nodes = 21
[grid]
end_distance = { from = "10 cm", to = "23 cm", count = 4 }
twist = ["0 deg", "90 deg"]
"""

LONG = """
protocol = "snap-twist"
[fixed]
edges = 10
frames = 1
disorder = 0.1
[grid]
seed = { from = 0, to = 399 }
"""


def shell(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "torsade", *arguments], capture_output=True, text=True, cwd=cwd, check=False
    )


def refusal(*arguments: str, cwd: Path) -> str:
    done = shell(*arguments, cwd=cwd)
    assert done.returncode == 2, done
    assert (done.stdout, done.stderr.count("\n")) == ("", 1)
    assert done.stderr.startswith("torsade: ")
    assert ". " not in done.stderr.strip()
    return done.stderr.removeprefix("torsade: ").strip()


@pytest.fixture(scope="module")
def bent(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a design and its sweep, `bent`."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "bent.toml").write_text(BENT)
    done = shell("sweep", "bent.toml", "--workers", "1", cwd=folder)
    assert (done.returncode, done.stderr) == (0, "")
    assert "8: 8 done, 0 failed" in done.stdout
    return folder


def test_a_sweep_is_told_before_it_is_run(bent: Path) -> None:
    (bent / "more.toml").write_text(BENT.replace("count = 4", "count = 8"))
    told = shell("sweep", "more.toml", "--dry-run", cwd=bent)
    assert told.returncode == 0
    assert "points                    16" in told.stdout
    assert "end_distance = 0.1 m, twist = 90 deg" in told.stdout
    found = json.loads(shell("sweep", "more.toml", "--dry-run", "--json", cwd=bent).stdout)
    assert (found["points"], len(found["first"])) == (16, 5)
    assert not (bent / "more").exists()


def test_what_was_run_is_said_as_json(bent: Path) -> None:
    done = shell("sweep", "bent.toml", "--json", cwd=bent)
    found = json.loads(done.stdout)
    assert (found["points"], found["done"], found["ran"], found["stored_before"]) == (8, 8, 0, 8)
    assert done.stderr == ""


def test_a_query_comes_as_table_csv_and_json(bent: Path) -> None:
    sql = "SELECT twist, max(thrust_N) AS thrust, list(end_distance) AS ends FROM runs GROUP BY 1 ORDER BY 1"
    table = shell("query", "bent", sql, cwd=bent).stdout.splitlines()
    assert table[0].split() == ["twist", "thrust", "ends"]
    assert len(table) == 3
    found = json.loads(shell("query", "bent", sql, "--json", cwd=bent).stdout)
    assert found["columns"] == {"twist": "DOUBLE", "thrust": "DOUBLE", "ends": "DOUBLE[]"}
    lines = list(csv.DictReader(io.StringIO(shell("query", "bent", sql, "--csv", cwd=bent).stdout)))
    for line, row in zip(lines, found["rows"], strict=True):
        assert float(line["thrust"]) == row["thrust"]
        assert json.loads(line["ends"]) == row["ends"]
    assert len(found["rows"][0]["ends"]) == 4


def test_without_a_query_it_is_said_what_there_is(bent: Path) -> None:
    told = shell("query", "bent", cwd=bent)
    assert told.returncode == 0
    for text in (
        "bend-twist",
        "8: 8 done, 0 failed, 0 waiting",
        "end_distance, twist",
        "thrust_N",
        "force_N",
    ):
        assert text in told.stdout
    found = json.loads(shell("query", "bent", "--json", cwd=bent).stdout)
    assert len(found["rows"]) == 8


def test_a_failure_is_told_and_the_command_succeeds(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text('protocol = "snap-twist"\n[grid]\ntwist = ["600 deg", "700 deg"]\n')
    done = shell("sweep", "a.toml", "--workers", "1", cwd=tmp_path)
    assert done.returncode == 0
    assert done.stderr.startswith("torsade: 2 of 2 points failed; see why with torsade query a ")
    assert done.stderr.count("\n") == 1


def test_bad_input_is_refused_in_one_sentence(bent: Path) -> None:
    (bent / "bad.toml").write_text(BENT.replace("10 cm", "10 s"))
    assert "end_distance in [grid]: '10 s' is a time, not a length" in refusal("sweep", "bad.toml", cwd=bent)
    assert "nothing is given; give a TOML file" in refusal("sweep", cwd=bent)
    assert "there is no file 'no.toml'" in refusal("sweep", "no.toml", cwd=bent)
    assert "--workers is '0'" in refusal("sweep", "bent.toml", "--workers", "0", cwd=bent)
    assert "--scheduler is 'x'; give an address" in refusal(
        "sweep", "bent.toml", "--scheduler", "x", "--out", "x", cwd=bent
    )
    assert "has 8 points, more than 7" in refusal("sweep", "bent.toml", "--at-most", "7", cwd=bent)
    assert "did you mean --retry-failed?" in refusal("sweep", "bent.toml", "--retry-faild", cwd=bent)
    assert "'none' does not exist" in refusal("query", "none", cwd=bent)
    assert "holds no sweep" in refusal("query", ".", cwd=bent)
    assert 'column "thrust" not found' in refusal("query", "bent", "SELECT thrust FROM runs", cwd=bent)
    assert "quotes" in refusal("query", "bent", "SELECT", "point", cwd=bent)
    assert "--csv and --json are both given" in refusal("query", "bent", "--csv", "--json", cwd=bent)
    assert "the query is empty" in refusal("query", "bent", "", cwd=bent)


def started(folder: Path) -> subprocess.Popen[str]:
    """A sweep at work, with something stored."""
    (folder / "long.toml").write_text(LONG)
    command = [sys.executable, "-m", "torsade", "sweep", "long.toml", "--workers", "2"]
    running = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 300
    while not list((folder / "long").glob("part-*.parquet")):
        assert running.poll() is None
        assert time.monotonic() < until
        time.sleep(0.05)
    return running


def children(process: int) -> list[int]:
    """Processes that a process has begun, by what Linux says of them."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            after_name = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(after_name[1]) == process:
            found.append(int(stat.parent.name))
    return found


def ended(process: int) -> bool:
    try:
        return "\nState:\tZ" in Path(f"/proc/{process}/status").read_text()
    except OSError:
        return True


def stored(folder: Path) -> int:
    sql = "SELECT count(*) AS n FROM runs WHERE status = 'done'"
    return int(json.loads(shell("query", "long", sql, "--json", cwd=folder).stdout)["rows"][0]["n"])


def test_ctrl_c_says_how_many_points_are_stored(tmp_path: Path) -> None:
    running = started(tmp_path)
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=120)
    assert (running.returncode, out) == (130, "")
    *_, last = err.splitlines()
    n = stored(tmp_path)
    assert last == f"torsade: interrupted; {n} of 400 points are stored in 'long'; the same command goes on."
    assert 0 < n < 400
    assert not list(tmp_path.glob("*.lock"))


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks Linux for processes")
def test_a_killed_command_takes_its_workers_with_it_and_is_gone_on_with(tmp_path: Path) -> None:
    running = started(tmp_path)
    workers = children(running.pid)
    assert len(workers) >= 2
    os.kill(running.pid, signal.SIGKILL)
    running.communicate(timeout=60)
    until = time.monotonic() + 60
    while not all(map(ended, workers)):
        assert time.monotonic() < until
        time.sleep(0.05)
    before = stored(tmp_path)
    (tmp_path / "long.toml").write_text(LONG.replace("399", str(before + 9)))
    found = json.loads(shell("sweep", "long.toml", "--workers", "1", "--json", cwd=tmp_path).stdout)
    assert found["points"] == found["done"] == before + 10
    assert 0 < found["stored_before"] <= before

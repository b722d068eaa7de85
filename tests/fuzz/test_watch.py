"""The watch over what is fuzzed: what hangs, dies or fills the memory is kept, with the reason."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))

import fuzz.__main__ as watch
from fuzz.child import keep

ROOT = Path(__file__).parents[2]

BUSY = """
import sys
from pathlib import Path
from fuzz.child import STATE
with Path(sys.argv[1]).open("r+b") as file:
    file.write(STATE.pack(7, 1e-3, 0.0, 3) + b"abc")
while True:
    pass
"""

GREEDY = """
import sys
from pathlib import Path
from fuzz import child
from fuzz.targets import Target
child.MEMORY = 2**20
child.Round(Target(lambda kind: lambda body, folder: None, ()), Path(sys.argv[1]).parent, 1e9)(b"a\\nb")
"""


@pytest.mark.parametrize(
    ("script", "kind", "inputs", "data"), [(BUSY, "hang", 7, b"abc"), (GREEDY, "memory", 1, b"a\nb")]
)
def test_an_input_that_does_harm_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str, kind: str, inputs: int, data: bytes
) -> None:
    begin = subprocess.Popen

    def popen(command: list[str], **options: object) -> subprocess.Popen[bytes]:
        return begin([sys.executable, "-c", script, str(tmp_path / "state")], cwd=ROOT, **options)  # type: ignore[call-overload,no-any-return]

    monkeypatch.setattr(watch.subprocess, "Popen", popen)
    monkeypatch.setattr(watch, "SLOWEST", 0.3)
    watch.fuzz("names", tmp_path, seconds=0.2, wall=60.0, seed=1)
    (found,) = tmp_path.glob("*.input")
    assert found.name.startswith(kind)
    assert found.read_bytes() == data
    assert found.with_suffix(".reason").read_text().startswith(f"{kind} after ")
    numbers = json.loads((tmp_path / "numbers.json").read_text())
    assert (numbers["inputs"], numbers["findings"]) == (inputs, 1)


def test_of_inputs_with_one_reason_the_shortest_stays(tmp_path: Path) -> None:
    for data in (b"long enough", b"short", b"longer again"):
        keep(tmp_path, data, "ValueError", "files/a.py:3", "wrong")
    keep(tmp_path, b"another", "ValueError", "files/a.py:4", "wrong")
    assert sorted(path.read_bytes() for path in tmp_path.glob("*.input")) == [b"another", b"short"]


def test_the_table_takes_the_place_of_the_last_one(tmp_path: Path) -> None:
    (tmp_path / "codes").mkdir()
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- table -->\nold\n<!-- end of table -->\nafter\n")
    numbers = {"inputs": 12, "seconds": 3.4, "findings": 0, "most_mb": 99.6, "slowest_s": 0.25}
    (tmp_path / "codes" / "numbers.json").write_text(json.dumps(numbers))
    for _ in range(2):
        watch.write_table(tmp_path, page)
    text = page.read_text()
    assert "| `codes` | 12 | 3 | 0 | 0.2 | 100 |" in text
    assert text.startswith("before\n")
    assert text.endswith("\nafter\n")
    assert "old" not in text
    assert len(text.splitlines()) == 7

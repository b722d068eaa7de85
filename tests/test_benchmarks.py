"""Every benchmark runs, in its quick mode, and finds finite numbers; how fast is for the docs to say."""

from __future__ import annotations

import importlib
import json
import math
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Loads a benchmark by name."""
    monkeypatch.syspath_prepend(str(ROOT))

    def load(name: str) -> ModuleType:
        return importlib.import_module(f"benchmarks.{name}")

    return load


def numbers(found: Any) -> list[float]:
    """All numbers in nested lists and dictionaries."""
    if isinstance(found, dict):
        return [x for value in found.values() for x in numbers(value)]
    if isinstance(found, list | tuple):
        return [x for value in found for x in numbers(value)]
    return [float(found)] if isinstance(found, int | float) else []


SCRIPTS = (
    "step",
    "kernels",
    "mobility",
    "start",
    "bends",
    "convergence",
    "writhe",
    "topology",
    "tight",
    "building",
    "variants",
    "chapter4",
    "statics",
    "tails",
    "torque_writhe",
    "tightening",
    "batteries",
    "sutures",
    "battery_map",
    "charging",
    "symmetric",
    "breaking",
    "third_break",
    "movies",
    "block",
    "ensembles",
    "protocols",
    "storing",
    "cost",
)


@pytest.mark.parametrize("name", SCRIPTS)
def test_quick_mode_finds_finite_numbers(script: Any, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    found = script(name).main(["--quick", "--json"])
    printed = json.loads(capsys.readouterr().out)
    assert numbers(printed) == numbers(json.loads(json.dumps(found)))
    values = numbers(found)
    assert values
    assert all(math.isfinite(x) for x in values)


@pytest.mark.parametrize("q", [2, 4])
def test_random_curves_are_their_own_mirror_images(script: Any, q: int) -> None:
    """x(s + L/q) = Q x(s), which the mean over images leaves as it is, and Q reflects."""
    symmetric = script("symmetric")
    x = symmetric.random_curve(np.random.default_rng(0), q)
    np.testing.assert_allclose(np.roll(x, -len(x) // q, axis=0), x @ symmetric.MAPS[q].T, atol=1e-12)
    np.testing.assert_allclose(symmetric.symmetric(x, q), x, atol=1e-12)
    assert np.linalg.det(symmetric.MAPS[q]) == pytest.approx(-1.0)


def test_a_table_is_printed_without_json(script: Any, capsys: pytest.CaptureFixture[str]) -> None:
    script("step").main(["--quick"])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("| nodes | contacts |")
    assert lines[1].count("---") == lines[0].count("|") - 1


def test_an_absent_peer_is_skipped_in_one_sentence(script: Any, capsys: pytest.CaptureFixture[str]) -> None:
    peer = script("peers.pyelastica")
    assert list(peer.main(["--quick"], installed=lambda: False)) == ["skipped"]
    assert capsys.readouterr().out.strip() == peer.ABSENT


def test_the_knot_compared_with_the_peer_touches_itself_at_rest(script: Any) -> None:
    peer = script("peers.pyelastica")
    motion = peer.ours(peer.trefoil(100))
    way = peer.ours_to_rest(motion, peer.AT_REST)
    assert len(motion.measure().contacts) > 5
    assert 0 < way.arrival() < len(way.distance) - 1
    assert abs(way.distance[-1] / way.distance[-3] - 1) < 1e-6


def test_the_solvers_compared_agree(script: Any) -> None:
    row = script("mobility").compare(0.6, 0.002, at_least=1e-6, repeats=1)
    assert row["contacts"] > 0
    assert row["residual_of_direct"] < 1e-9
    assert row["off_by_conjugate_gradients"] < 1e-2


def test_a_block_of_threads_finds_the_direct_solution(script: Any) -> None:
    row = script("block").compare(0.6, 0.002)
    assert row["contacts"] > 0
    assert row["off"] < 1e-4
    assert row["barriers"] > row["iterations"] * math.log2(row["nodes"])


def test_absent_centerlines_are_left_out_in_one_sentence(script: Any, tmp_path: Path) -> None:
    common = script("common")
    (tmp_path / "reef.csv").touch()
    found, note = common.data_files(str(tmp_path), ("reef", "thief", "granny"))
    assert list(found) == ["reef"]
    assert note == f"Not in {tmp_path}, so left out: thief, granny."
    assert common.data_files(None, ("reef",))[0] == {}


def test_a_table_replaces_the_one_before(script: Any, tmp_path: Path) -> None:
    common, page = script("common"), tmp_path / "page.md"
    begin, end = "<!-- some:begin -->", "<!-- some:end -->"
    page.write_text(f"# Title\n\n{begin}\nold\n{end}\n\nReasons.\n", encoding="utf-8")
    for _ in range(2):
        common.put("new", page, "some")
    assert page.read_text(encoding="utf-8") == f"# Title\n\n{begin}\nnew\n{end}\n\nReasons.\n"
    with pytest.raises(ValueError, match="lacks the marks"):
        common.put("new", page, "other")


def test_the_exponent_is_the_slope_of_a_power_law(script: Any) -> None:
    rows = [{"nodes": n, "us": 3.0 * n**1.25} for n in (100, 1000, 5000)]
    assert script("step").exponent(rows, "us") == pytest.approx(1.25)

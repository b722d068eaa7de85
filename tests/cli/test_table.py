"""What the printed table says of a result."""

from __future__ import annotations

import math

import pytest

from torsade.cli.table import print_grid, print_table
from torsade.protocols import PrisonEscape, Reidemeister


def test_there_is_no_minus_zero(capsys: pytest.CaptureFixture[str]) -> None:
    result = PrisonEscape(knot="reef", duration=0.002, frames=2).run()
    for value, says in ((-1e-4, "+0.00"), (-0.25, "-0.25"), (0.25, "+0.25")):
        result.dataset["rotation"].values[:] = value
        result.dataset["twist"].values[:] = value
        print_table(result, PrisonEscape.report(result))
        shown = capsys.readouterr().out
        assert f"turned about the pull     {says} rad at 0.002 s" in shown
        assert f"twist                     A {says} rad, B {says} rad" in shown


def test_energies_of_moves_are_those_beyond_strands_lying_apart(capsys: pytest.CaptureFixture[str]) -> None:
    """An arc of 120 degrees has the bending energy (2 pi/3)²/2 B/L, which is no part of the cost of R2."""
    result = Reidemeister(move="R2", length="8 mm", duration="1 s", frames=2).run()
    report = Reidemeister.report(result)
    arc = report["energy_apart_J"] / report["B_over_L_J"]
    assert arc == pytest.approx((2 * math.pi / 3) ** 2 / 2, rel=5e-3)
    print_table(result, report)
    shown = capsys.readouterr().out
    assert "energy at the start       0.000 B/L\n" in "".join(
        line.rstrip() + "\n" for line in shown.splitlines()
    )
    top = report["energy_top_J"] / report["B_over_L_J"] - arc
    assert f"highest energy            {top:.3f} B/L, after" in shown
    assert top < 2

    straight = Reidemeister(move="R3", length="8 mm", duration="1 s", frames=2).run()
    assert Reidemeister.report(straight)["energy_apart_J"] == 0


def test_tables_that_are_too_wide_are_printed_in_parts(capsys: pytest.CaptureFixture[str]) -> None:
    """No number and no heading is folded; each part begins with what names a row."""
    columns = ["knot", *(f"quantity_{k}_per_m" for k in range(9))]
    rows = [[name, *(10.0**-k / 3 for k in range(9))] for name in ("3_1", "4_1")]
    print_grid(columns, rows)
    parts = [part.splitlines() for part in capsys.readouterr().out.split("\n\n")]
    assert len(parts) == 3
    for part in parts:
        assert [line.split()[0] for line in part] == ["knot", "3_1", "4_1"]
        assert max(len(line.rstrip()) for line in part) <= 80
    headings = [word for part in parts for word in part[0].split()[1:]]
    assert list(dict.fromkeys(headings)) == columns[1:]
    numbers = {word for part in parts for word in part[1].split()[1:]}
    assert numbers == {f"{value:.4g}" for value in rows[0][1:]}


def test_long_texts_of_a_table_are_folded(capsys: pytest.CaptureFixture[str]) -> None:
    print_grid(("name", "number", "reason"), [("a", 1.0, "word " * 40), ("b", None, None)])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > 4
    assert max(len(line.rstrip()) for line in lines) <= 80
    assert " ".join(line[14:].strip() for line in lines[1:-1]).split() == ["word"] * 40

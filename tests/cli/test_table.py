"""What the printed table says of a result."""

from __future__ import annotations

import math

import pytest

from torsade.cli.table import print_table
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

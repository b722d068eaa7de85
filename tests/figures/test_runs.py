"""Runs that figures share: kept, found again, gone on with, and the same whatever the number of workers."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.figures.base import Table
from torsade.figures.runs import results, run_path
from torsade.protocols import PrisonEscape


def short(knot, **fields):
    return PrisonEscape(knot=knot, duration=0.004, frames=2, **fields)


def stamps(found):
    return {label: result.dataset.attrs["created"] for label, result in found.items()}


def test_runs_are_made_once_and_are_what_a_single_run_gives(tmp_path):
    specs = {"reef": short("reef"), "granny, published": short("granny", preset="published")}
    said = []
    first = results(specs, tmp_path, workers=2, progress=lambda share, note: said.append((share, note)))
    again = results(specs, tmp_path, workers=1)
    fresh = results(specs, tmp_path, workers=1, fresh=True)
    alone = {label: spec.run() for label, spec in specs.items()}

    assert stamps(first) == stamps(again)
    assert not set(stamps(first).values()) & set(stamps(fresh).values())
    for label in specs:
        for other in (fresh, alone):
            for name in ("position", "separation", "twist"):
                assert np.array_equal(first[label].dataset[name], other[label].dataset[name])
    assert [share for share, _ in said] == [0, 0.5, 1]
    assert said[0][1] == "2 runs to do"


def test_the_place_of_a_run_depends_on_all_that_decides_it(tmp_path):
    paths = {
        run_path("reef", spec, tmp_path)
        for spec in (
            short("reef"),
            short("reef", preset="published"),
            short("reef", spacing=1e-4),
            short("reef", radius=1e-4),
            short("thief"),
        )
    }

    assert len(paths) == 5
    assert run_path("reef", short("reef"), tmp_path) in paths
    assert run_path("a/../b c", short("reef"), tmp_path).parent == tmp_path


@pytest.mark.parametrize("workers", [1, 2])
def test_a_failed_run_does_not_lose_the_others(tmp_path, workers):
    missing = PrisonEscape(centerline=str(tmp_path / "missing.csv"))
    specs = {"bad": missing, "good": short("reef")}

    with pytest.raises(TorsadeError, match=r"^bad: there is no file"):
        results(specs, tmp_path, workers=workers)
    assert run_path("good", specs["good"], tmp_path).exists()


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(TorsadeError, match="cannot make the folder"):
        results({}, tmp_path / "file" / "runs")


def test_tables_leave_out_what_is_not_known(tmp_path):
    Table(
        ("knot", "c_f", "slipped_at_s", "holds"),
        [("reef", 1 / 3, None, True), ("a,b", float("nan"), 2, False)],
    ).write(tmp_path / "t.csv")
    assert (
        tmp_path / "t.csv"
    ).read_text() == 'knot,c_f,slipped_at_s,holds\nreef,0.33333333,,True\n"a,b",,2,False\n'

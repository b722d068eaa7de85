"""Sweeps as a whole: every point once, the same numbers whatever ran them, whatever happened meanwhile."""

from __future__ import annotations

import json
import shutil
import signal
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import torsade as ts
from torsade import places
from torsade.errors import TorsadeError
from torsade.protocols import PROTOCOLS
from torsade.sweep import Catalogue, Sweep, parts, run
from torsade.sweep.query import POINTS
from torsade.sweep.unit import Unit, flat, run_batch

BENT = {"from": "10 cm", "to": "23 cm", "count": 6}


def bends(**more):
    """A sweep of runs that take milliseconds."""
    return Sweep("bend-twist", **({"fixed": {"nodes": 21}, "grid": {"end_distance": BENT}} | more))


def in_threads(sweep, folder, workers=1, **options):
    """Run in this process."""
    with ThreadPoolExecutor(workers) as executor:
        return run(sweep, folder, executor=executor, **options)


def numbers(folder):
    """All that a catalogue holds but times."""
    found = Catalogue(folder).query("SELECT * EXCLUDE (wall_s) FROM runs")
    return found.columns, found.rows


def test_the_numbers_are_those_of_single_runs(tmp_path):
    sweep = bends()
    done = in_threads(sweep, tmp_path / "bent")
    found = done.catalogue.query("SELECT thrust_N, force_N, stable, status FROM runs").rows
    for point, row in zip(sweep.points(), found, strict=True):
        report = point.spec.report(point.spec.run())
        assert row == (report["thrust_N"], report["force_N"], report["stable"], "done")
    assert (done.points, done.ran, done.before, done.failed) == (6, 6, 0, 0)


def test_numbers_do_not_depend_on_who_runs_them(tmp_path):
    """In this process, by one and by two processes, in one go and in three."""
    breaking = {"fixed": {"edges": 10, "disorder": 0.1, "frames": 1}, "grid": {"seed": {"from": 0, "to": 7}}}
    sweep = Sweep("snap-twist", **breaking)
    in_threads(sweep, tmp_path / "a")
    run(sweep, tmp_path / "b", workers=2)
    for last in (2, 4, 7):
        run(
            Sweep("snap-twist", **breaking | {"grid": {"seed": {"from": 0, "to": last}}}),
            tmp_path / "c",
            workers=1,
        )
    assert numbers(tmp_path / "a") == numbers(tmp_path / "b") == numbers(tmp_path / "c")


def test_what_is_stored_is_not_run_again_and_points_can_be_added(tmp_path):
    first = in_threads(bends(), tmp_path)
    again = in_threads(bends(), tmp_path)
    assert (again.ran, again.before) == (0, 6)
    assert numbers(tmp_path) == numbers(first.catalogue.folder)
    more = bends(grid={"end_distance": BENT, "twist": ["0 deg", "90 deg"]})
    added = in_threads(more, tmp_path)
    assert (added.points, added.ran, added.before) == (12, 6, 6)
    back = in_threads(bends(), tmp_path)
    assert (back.points, back.ran) == (6, 0)
    assert back.catalogue.query("SELECT count(*) FROM runs").rows == [(6,)]
    assert back.catalogue.query("SELECT count(*) FROM stored").rows == [(12,)]


TOO_MUCH = {"grid": {"twist": ["0 deg", "90 deg", "600 deg"]}, "fixed": {"edges": 10, "frames": 1}}
"""The last of these twists breaks a straight rod."""


def test_a_failure_is_stored_with_its_reason_and_run_again_when_asked(tmp_path):
    sweep = Sweep("snap-twist", **TOO_MUCH)
    first = in_threads(sweep, tmp_path)
    assert (first.ran, first.failed) == (3, 1)
    (reason,) = first.catalogue.query("SELECT reason FROM runs WHERE status = 'failed'").rows[0]
    assert reason.startswith("a twist of 600 deg breaks the straight rod")
    assert first.catalogue.counts() == {"done": 2, "failed": 1, "waiting": 0}
    left = in_threads(sweep, tmp_path)
    assert (left.ran, left.failed, left.before) == (0, 1, 3)
    again = in_threads(sweep, tmp_path, retry_failed=True)
    assert (again.ran, again.failed, again.before) == (1, 1, 2)
    assert again.catalogue.query("SELECT count(*) FROM stored").rows == [(3,)]


def test_ctrl_c_after_the_last_point_is_not_lost(tmp_path):
    def stop(share, note):
        if share == 1.0:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as stopped:
        in_threads(bends(), tmp_path / "bent", progress=stop)
    said = f"interrupted; 6 of 6 points are stored in {str(tmp_path / 'bent')!r}; the same command goes on"
    assert str(stopped.value) == said
    assert in_threads(bends(), tmp_path / "bent").ran == 0


def test_whole_results_are_kept_where_that_is_wanted(tmp_path):
    in_threads(bends(), tmp_path)
    kept = in_threads(bends(keep="results"), tmp_path)
    assert kept.ran == 6
    for key, thrust in kept.catalogue.query("SELECT key, thrust_N FROM runs").rows:
        result = ts.open(tmp_path / "results" / f"{key}.zarr")
        assert PROTOCOLS["bend-twist"].report(result)["thrust_N"] == thrust
    shutil.rmtree(tmp_path / "results" / f"{key}.zarr")
    assert in_threads(bends(keep="results"), tmp_path).ran == 1
    assert len(list((tmp_path / "results").iterdir())) == 6


def test_what_a_killed_command_left_half_written_goes(tmp_path):
    in_threads(bends(keep="results"), tmp_path)
    before = sorted(path.name for path in tmp_path.rglob("*"))
    mine = tmp_path / "part.mine.new"
    mine.write_text("not theirs")
    (tmp_path / "part.0123456789ab.new").write_bytes(b"half")
    (tmp_path / "results" / "0123456789abcdef.0123456789ab.new.zarr.part").mkdir()
    in_threads(bends(keep="results"), tmp_path)
    assert sorted(path.name for path in tmp_path.rglob("*")) == sorted([*before, mine.name])


def test_two_commands_do_not_share_a_folder(tmp_path):
    lock = places.Lock(tmp_path / "bent")
    try:
        with pytest.raises(
            TorsadeError, match=r"another command runs the sweep in .*bent' \(process \d+\); wait"
        ):
            in_threads(bends(), tmp_path / "bent")
    finally:
        lock.release()


def test_a_damaged_file_is_named_by_sweeps_and_queries(tmp_path):
    done = in_threads(bends(), tmp_path)
    (part,) = parts.live(tmp_path)
    content = part.path.read_bytes()
    part.path.write_bytes(content[:100] + b"\0" + content[101:])
    for ask in (lambda: in_threads(bends(), tmp_path), lambda: done.catalogue.query("SELECT 1")):
        with pytest.raises(
            TorsadeError, match=r"part-.*' is damaged \(its check sum is another\); remove it"
        ):
            ask()
    part.path.unlink()
    assert done.catalogue.counts() == {"done": 0, "failed": 0, "waiting": 6}
    assert in_threads(bends(), tmp_path).ran == 6
    (tmp_path / POINTS).write_bytes(b"PAR1")
    with pytest.raises(TorsadeError, match=r"points.parquet' is damaged .*; run torsade sweep again"):
        done.catalogue.query("SELECT 1")


def test_folders_of_something_else_are_refused(tmp_path):
    (tmp_path / "mine").write_text("")
    with pytest.raises(TorsadeError, match="holds something else than a sweep; give another --out"):
        in_threads(bends(), tmp_path)
    with pytest.raises(TorsadeError, match="is a file, not a folder"):
        in_threads(bends(), tmp_path / "mine")
    in_threads(bends(), tmp_path / "bent")
    with pytest.raises(TorsadeError, match="holds a sweep of bend-twist, not of snap-twist; give another"):
        in_threads(Sweep("snap-twist"), tmp_path / "bent")
    with pytest.raises(TorsadeError, match="holds no sweep"):
        Catalogue(tmp_path)
    (tmp_path / "bent" / "sweep.json").write_text('{"format": 1, "protocol": "../x", "varied": []}')
    with pytest.raises(TorsadeError, match="holds no sweep"):
        Catalogue(tmp_path / "bent")


def test_queries_read_the_sweep_and_nothing_else(tmp_path):
    catalogue = in_threads(bends(), tmp_path / "bent").catalogue
    (tmp_path / "other.csv").write_text("a\n1\n")
    for sql in (
        f"SELECT * FROM read_csv('{tmp_path}/other.csv')",
        f"COPY runs TO '{tmp_path}/out.csv'",
        f"ATTACH '{tmp_path}/new.db'",
        "INSTALL httpfs",
        "SET enable_external_access = true",
        "SELECT nothing FROM runs",
        "",
        "SELEC",
    ):
        with pytest.raises(TorsadeError, match=r"the query (cannot be answered: .|is empty; give one)"):
            catalogue.query(sql)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bent", "other.csv"]


def test_a_query_that_meets_a_merge_is_asked_again(tmp_path, monkeypatch):
    """Files that go between being listed and being read: every point is counted, once."""
    catalogue = in_threads(bends(), tmp_path).catalogue
    con = parts.connect()
    for k in range(3):
        parts.add(con, tmp_path, [{"key": f"{k:016x}", "status": "done"}])
    listed = parts.live

    def merging(folder):
        found = listed(folder)
        if len(found) > 1:
            monkeypatch.setattr(parts, "live", listed)
            parts.merge_all(con, tmp_path)
        return found

    monkeypatch.setattr(parts, "live", merging)
    assert catalogue.query("SELECT count(*), count(DISTINCT key) FROM stored").rows == [(9, 9)]
    assert len(listed(tmp_path)) == 1
    con.close()


def test_columns_come_as_arrays(tmp_path):
    found = in_threads(bends(), tmp_path).catalogue.query(
        "SELECT end_distance, nodes, NULL::BIGINT AS none, force_N, protocol FROM runs"
    )
    arrays = found.arrays()
    assert arrays["end_distance"] == pytest.approx(np.linspace(0.1, 0.23, 6))
    assert arrays["nodes"].tolist() == [21] * 6
    assert np.isnan(arrays["none"]).all()
    assert len(arrays["force_N"][0]) == 3
    assert arrays["protocol"][0] == "bend-twist"


def test_reports_are_flattened_and_repeat_no_field():
    report = {
        "protocol": "p",
        "nodes": 3,
        "twist": 2.5,
        "wall_s": 1.0,
        "mean": {"value": 1.0, "interval": {"low": 0.0}},
        "breaks": [{"time_s": 1.0, "x": 2}, {"time_s": 3.0, "x": None}],
        "lengths_m": [1.0, 2.0],
        "none": None,
    }
    assert flat(report, {"protocol": "p", "nodes": 3, "twist": 1.0}) == {
        "twist_found": 2.5,
        "mean_value": 1.0,
        "mean_interval_low": 0.0,
        "breaks_time_s": [1.0, 3.0],
        "breaks_x": [2, None],
        "lengths_m": [1.0, 2.0],
        "none": None,
    }


@pytest.mark.parametrize(
    ("protocol", "fields"),
    [
        ("bend-twist", {"end_distance": 0.19}),
        ("snap-twist", {"edges": 10, "frames": 1}),
        ("pendulum", {"frames": 5}),
    ],
)
def test_what_a_report_repeats_of_the_specification_is_the_same(protocol, fields):
    spec = PROTOCOLS[protocol](**fields)
    report, asked = spec.report(spec.run()), spec.stored()
    assert {name: report[name] for name in report.keys() & asked} == {
        name: asked[name] for name in report.keys() & asked
    }
    json.dumps(flat(report, asked), allow_nan=False)


def test_an_error_that_nobody_thought_of_is_a_failure_with_its_name(monkeypatch):
    from torsade.protocols import stored
    from torsade.protocols.bend_twist import BendTwist

    def broken(self, progress=None, out=None, **options):
        raise ZeroDivisionError("float division by zero")

    monkeypatch.setattr(BendTwist, "run", broken)
    spec = BendTwist(end_distance=0.19)
    (found,) = run_batch([Unit("k", spec)], stored.sources(), None)
    assert (found.status, found.reason) == ("failed", "ZeroDivisionError: float division by zero")


def test_other_sources_are_noticed():
    (found,) = run_batch([Unit("k", None)], "other", None)
    assert found.status == "other sources"


def test_sweeps_say_what_to_install(monkeypatch, tmp_path):
    import sys

    monkeypatch.setitem(sys.modules, "duckdb", None)
    with pytest.raises(
        TorsadeError, match=r'need duckdb, which is not installed; .*pip install "torsade\[sweep\]"'
    ):
        in_threads(bends(), tmp_path)

"""Rows on disk: whole or not there, exact, merged without any being seen twice or never."""

from __future__ import annotations

import itertools
import os
import random

import pytest

from torsade.errors import TorsadeError
from torsade.sweep import parts


@pytest.fixture
def con():
    found = parts.connect()
    yield found
    found.close()


def row(k, **more):
    return {
        "key": f"{k:016x}",
        "status": "done",
        "reason": None,
        "x": 0.1 * k,
        "list": [k / 7] * (k % 3),
    } | more


def read(con, folder, what="key, x, list"):
    return con.execute(f"SELECT {what} FROM ({parts.union(con, parts.live(folder))}) ORDER BY key").fetchall()


def test_floats_come_back_to_the_last_bit(con, tmp_path):
    random.seed(3)
    rows = [row(k, x=random.uniform(-1, 1) * 10.0 ** random.randint(-300, 300)) for k in range(500)]
    parts.add(con, tmp_path, rows)
    assert read(con, tmp_path) == [(r["key"], r["x"], r["list"]) for r in rows]


@pytest.mark.parametrize("count", [1, 7, 8, 9, 64, 77])
def test_files_stay_few_and_every_row_is_there_once(con, tmp_path, count):
    for k in range(count):
        parts.add(con, tmp_path, [row(k)])
    assert len(parts.live(tmp_path)) <= 2 * parts.FAN
    assert len(list(tmp_path.iterdir())) == len(parts.live(tmp_path))
    assert [k for k, *_ in read(con, tmp_path)] == [row(k)["key"] for k in range(count)]
    parts.merge_all(con, tmp_path)
    assert len(parts.live(tmp_path)) == 1
    assert [k for k, *_ in read(con, tmp_path)] == [row(k)["key"] for k in range(count)]
    parts.add(con, tmp_path, [row(count)])
    assert len(read(con, tmp_path)) == count + 1


def test_a_merge_cut_short_shows_no_row_twice(con, tmp_path, monkeypatch):
    """Killed after the merged file has its name and before the others are removed."""
    for k in range(5):
        parts.add(con, tmp_path, [row(k)])
    with monkeypatch.context() as patch:
        patch.setattr(parts.Path, "unlink", lambda self, missing_ok=False: None)
        parts.merge_all(con, tmp_path)
    assert len(list(tmp_path.glob("part-*.parquet"))) == 6
    assert len(read(con, tmp_path)) == 5
    parts.merge_all(con, tmp_path)
    assert len(list(tmp_path.iterdir())) == 1


def test_what_was_written_later_counts(con, tmp_path):
    parts.add(con, tmp_path, [row(1, status="failed", reason="killed")])
    parts.add(con, tmp_path, [row(1), row(2)])
    parts.merge_all(con, tmp_path)
    assert read(con, tmp_path, "key, status") == [(row(k)["key"], "done") for k in (1, 2)]


def test_a_column_without_a_value_takes_the_type_of_the_others(con, tmp_path):
    parts.add(con, tmp_path, [row(1, never=None, found=None)])
    parts.add(con, tmp_path, [row(2, never=None, found=[1.5, None])])
    parts.add(con, tmp_path, [row(3, never=None, found=None, more="text")])
    for _ in range(2):
        kinds = {
            r[0]: r[1] for r in con.execute(f"DESCRIBE {parts.union(con, parts.live(tmp_path))}").fetchall()
        }
        assert (kinds["found"], kinds["never"], kinds["more"]) == ("DOUBLE[]", "DOUBLE", "VARCHAR")
        assert read(con, tmp_path, "found, never, more") == [
            (None,) * 3,
            ([1.5, None], None, None),
            (None, None, "text"),
        ]
        parts.merge_all(con, tmp_path)


@pytest.mark.parametrize("size", [1, 2, 5])
@pytest.mark.parametrize("merged", [False, True])
def test_empty_lists_take_the_type_of_the_others(con, tmp_path_factory, size, merged):
    """Whichever comes first: names of knots are not numbers, though DuckDB reads '3_1' as 31."""
    names = {"a": [], "b": ["3_1"], "c": [], "d": ["5_2", "4_1"], "e": None, "f": []}
    for order in itertools.permutations("abcd"):
        folder = tmp_path_factory.mktemp("parts")
        keys = [*order, "e", "f"]
        for k in range(0, len(keys), size):
            parts.add(con, folder, [{"key": key, "names": names[key]} for key in keys[k : k + size]])
        if merged:
            parts.merge_all(con, folder)
        assert dict(read(con, folder, "key, names")) == names


def test_lists_that_are_empty_everywhere(con, tmp_path):
    for k in range(2):
        parts.add(con, tmp_path, [{"key": str(k), "names": []}])
    assert read(con, tmp_path, "key, names") == [("0", []), ("1", [])]


def test_a_file_that_is_not_what_was_written_is_named(con, tmp_path):
    parts.add(con, tmp_path, [row(k) for k in range(50)])
    (part,) = parts.live(tmp_path)
    content = part.path.read_bytes()
    for spoilt in (content[:-20], content[:60] + bytes([content[60] ^ 1]) + content[61:], b""):
        part.path.write_bytes(spoilt)
        with pytest.raises(
            TorsadeError, match=r"part-.*parquet' is damaged \(.*\); remove it, and torsade sweep"
        ):
            part.verify()


def test_names_of_another_kind_are_not_looked_at(con, tmp_path):
    parts.add(con, tmp_path, [row(1)])
    (part,) = parts.live(tmp_path)
    for name in ("part.0123456789ab.new", "part-1-2-abc.parquet", f"{part.path.name}.new", "../x"):
        if "/" not in name:
            (tmp_path / name).write_bytes(b"half written")
    assert parts.live(tmp_path) == [part]


def test_nothing_is_left_where_a_write_fails(con, tmp_path, monkeypatch):
    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(TorsadeError, match=r"cannot write .*no space left on device"):
        parts.add(con, tmp_path, [row(1)])
    assert list(tmp_path.iterdir()) == []

"""Runs that figures share: kept, found again, gone on with, and the same whatever the number of workers."""

from __future__ import annotations

import json
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from torsade import store
from torsade.errors import TorsadeError
from torsade.figures.base import Table
from torsade.figures.runs import results, run_path
from torsade.places import Lock, attributes
from torsade.protocols import PrisonEscape
from torsade.protocols.stored import opened, whole


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
        results({"reef": short("reef")}, tmp_path / "file" / "runs")
    with pytest.raises(TorsadeError, match=r"'.*file' is a file, not a folder; remove it, or give"):
        results({"reef": short("reef")}, tmp_path / "file")


def test_nothing_to_run_needs_no_folder(tmp_path):
    (tmp_path / "runs").write_text("mine")
    assert results({}, tmp_path / "runs") == results({}, tmp_path / "other") == {}
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]


@pytest.fixture(scope="module")
def stored_reef(tmp_path_factory):
    """A folder with a run, and the run."""
    folder = tmp_path_factory.mktemp("stored")
    return folder, results({"reef": short("reef")}, folder, workers=1)["reef"]


def a_chunk(path, name):
    return next(found for found in sorted((path / name / "c").rglob("*")) if found.is_file())


def spoil_chunk(path):
    chunk = a_chunk(path, "position")
    chunk.write_bytes(chunk.read_bytes()[:40] + b"x" * 40)


def spoil_attribute(path):
    attributes = json.loads((path / "zarr.json").read_text())
    attributes["attributes"]["done"] = "many"
    (path / "zarr.json").write_text(json.dumps(attributes))


@pytest.mark.parametrize(
    "spoil",
    [
        spoil_chunk,
        lambda path: shutil.rmtree(path / "separation"),
        lambda path: a_chunk(path, "velocity").unlink(),
        spoil_attribute,
    ],
)
def test_a_damaged_run_is_run_anew(tmp_path, stored_reef, spoil):
    """Whatever is damaged, nothing else than the numbers of the whole run is ever given."""
    folder, reef = stored_reef
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    path = run_path("reef", short("reef"), tmp_path)
    assert whole(path) is not None
    spoil(path)
    assert whole(path) is None

    found = results({"reef": short("reef")}, tmp_path, workers=1)["reef"]
    assert found.dataset.attrs["created"] != reef.dataset.attrs["created"]
    assert store.chunk_files(path) == store.chunk_files(run_path("reef", short("reef"), folder))
    for name, values in reef.dataset.variables.items():
        assert np.array_equal(values, found.dataset[name], equal_nan=values.dtype.kind == "f"), name


def test_a_run_that_cannot_be_read_later_is_named(tmp_path, stored_reef):
    folder, _ = stored_reef
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    path = run_path("reef", short("reef"), tmp_path)
    spoil_chunk(path)
    with pytest.raises(TorsadeError, match=r"reef.*zarr' cannot be read \(.*\); remove it, or give --fresh"):
        opened(path)


def interrupted(path, keep):
    """A run that is stopped at its first frame."""
    from torsade.protocols.interrupted import Interrupted

    def stop(share, note):
        if share > 0.4:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(Interrupted):
        short("reef").run(stop, path)
    part = path.with_name(path.name + ".part")
    assert part.is_dir()
    if not keep:
        (part / "restart.npz").write_bytes(b"x")
    return json.loads((part / "zarr.json").read_text())["attributes"]["created"]


@pytest.mark.parametrize(("keep", "fresh"), [(True, False), (True, True), (False, False)])
def test_a_partial_run_is_gone_on_with_unless_it_cannot_be(tmp_path, stored_reef, keep, fresh):
    begun = interrupted(run_path("reef", short("reef"), tmp_path), keep)
    found = results({"reef": short("reef")}, tmp_path, workers=1, fresh=fresh)["reef"]
    assert (found.dataset.attrs["created"] == begun) is (keep and not fresh)
    assert np.array_equal(found.dataset["position"], stored_reef[1].dataset["position"])
    assert len(list(tmp_path.iterdir())) == 1


def make_empty(path):
    path.mkdir()


def make_other(path):
    path.mkdir()
    (path / "zarr.json").write_text('{"attributes": {}}')


def make_bad(path):
    path.mkdir()
    (path / "zarr.json").write_text("{")


@pytest.mark.parametrize("fresh", [False, True])
@pytest.mark.parametrize("ending", ["", ".part"])
@pytest.mark.parametrize("make", [make_empty, make_other, make_bad, lambda path: path.write_text("mine")])
def test_what_is_not_a_run_is_left_alone(tmp_path, make, ending, fresh):
    path = run_path("reef", short("reef"), tmp_path)
    place = path.with_name(path.name + ending)
    make(place)
    with pytest.raises(TorsadeError) as refused:
        results({"reef": short("reef")}, tmp_path, workers=1, fresh=fresh)
    assert str(refused.value) == f"{str(place)!r} exists and is not a run; remove it"
    assert list(tmp_path.iterdir()) == [place]


def test_two_commands_do_not_make_runs_in_one_folder(tmp_path, stored_reef):
    folder, _ = stored_reef
    # This process stands for another one.
    lock = Lock(folder)
    try:
        with pytest.raises(TorsadeError) as refused:
            results({"reef": short("reef"), "thief": short("thief")}, folder, workers=1)
        expected = (
            f"another command is making runs in {str(folder)!r} (process {os.getpid()}); wait for it or"
        )
        assert str(refused.value) == f"{expected} give another --out"
        assert list(results({"reef": short("reef")}, folder)) == ["reef"]  # nothing is to be made
    finally:
        lock.release()


def test_ctrl_c_says_how_many_runs_are_stored(tmp_path, stored_reef):
    """Raised while the first of two missing runs goes on; the one before is kept."""
    folder, _ = stored_reef
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    specs = {"reef": short("reef"), "thief": short("thief")}

    def stop(share, note):
        if note == "1 run to do":
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as stopped:
        results(specs, tmp_path, workers=1, progress=stop)
    said = f"interrupted; 1 of 2 runs is stored in {str(tmp_path)!r}; the same command goes on"
    assert str(stopped.value) == said
    assert len(list(tmp_path.iterdir())) == 1  # neither a lock nor anything begun


def test_ctrl_c_at_the_end_of_a_run_keeps_the_next_from_beginning(tmp_path, monkeypatch):
    give_name = store.give_name

    def then_stopped(*arguments):
        give_name(*arguments)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(store, "give_name", then_stopped)
    with pytest.raises(KeyboardInterrupt) as stopped:
        results({"reef": short("reef"), "thief": short("thief")}, tmp_path, workers=1)
    said = f"interrupted; 1 of 2 runs is stored in {str(tmp_path)!r}; the same command goes on"
    assert str(stopped.value) == said
    assert list(tmp_path.iterdir()) == [run_path("reef", short("reef"), tmp_path)]


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kills a process")
def test_a_process_that_is_killed_is_one_sentence(tmp_path):
    """As the system does when memory runs out; the other process ends too, though a run goes on in it."""
    specs = {name: PrisonEscape(knot=name, duration=60.0, frames=60000) for name in ("reef", "thief")}
    killed = []

    def kill(folder):
        until = time.monotonic() + 300
        while not list(folder.glob("*.part")) and time.monotonic() < until:
            time.sleep(0.02)
        killed.append(multiprocessing.active_children()[0])
        killed[0].kill()

    killer = threading.Thread(target=kill, args=(tmp_path,))
    killer.start()
    with pytest.raises(TorsadeError, match="a process that makes runs was killed, as it is when memory"):
        results(specs, tmp_path, workers=2)
    killer.join()
    assert len(killed) == 1
    assert not multiprocessing.active_children()


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="SIGTERM is sent otherwise there")
def test_sigterm_to_the_command_alone_stops_its_workers_too(tmp_path):
    """Each saves what it has; neither a lock stays nor is a further run begun."""
    command = ["figure", "4-5", "--preset", "standard", "--workers", "2", "--out", str(tmp_path)]
    process = subprocess.Popen(
        [sys.executable, "-m", "torsade", *command],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        for _ in range(3000):
            parts = list(tmp_path.glob("runs/*.part"))
            if parts and any((attributes(part) or {}).get("done", 0) > 2 for part in parts):
                break
            time.sleep(0.1)
        process.send_signal(signal.SIGTERM)
        _, said = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 143
    assert "of 27 runs" in said
    assert "Traceback" not in said
    left = sorted((tmp_path / "runs").iterdir())
    assert not [path for path in left if path.suffix in (".lock", ".new")]
    assert {attributes(path)["status"] for path in left} <= {"complete", "interrupted"}


def test_tables_leave_out_what_is_not_known(tmp_path):
    Table(
        ("knot", "c_f", "slipped_at_s", "holds"),
        [("reef", 1 / 3, None, True), ("a,b", float("nan"), 2, False)],
    ).write(tmp_path / "t.csv")
    assert (
        tmp_path / "t.csv"
    ).read_text() == 'knot,c_f,slipped_at_s,holds\nreef,0.33333333,,True\n"a,b",,2,False\n'

"""Stores that are damaged, foreign or hostile: a sentence each, no traceback, no memory filled."""

from __future__ import annotations

import json
import os
import shutil
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import torsade as ts
from torsade import results, store, vetting
from torsade.protocols import PROTOCOLS

Change = Callable[[Path], None]


@pytest.fixture
def copy(stored: Callable[[str], Path], tmp_path: Path) -> Path:
    """A sound result to be spoilt."""
    return Path(shutil.copytree(stored("prison-escape"), tmp_path / "reef.zarr"))


def described(path: Path, name: str = "", **changes: Any) -> None:
    """Change the description of a variable, or of the whole."""
    file = path / name / "zarr.json"
    about = json.loads(file.read_text())
    file.write_text(json.dumps(about | changes))


def attribute(name: str, value: object) -> Change:
    def change(path: Path) -> None:
        about = json.loads((path / "zarr.json").read_text())
        about["attributes"][name] = value
        (path / "zarr.json").write_text(json.dumps(about))

    return change


def without(name: str) -> Change:
    def change(path: Path) -> None:
        about = json.loads((path / "zarr.json").read_text())
        del about["attributes"][name]
        (path / "zarr.json").write_text(json.dumps(about))

    return change


def variable(name: str, **changes: Any) -> Change:
    return lambda path: described(path, name, **changes)


def codecs(*names: str) -> Change:
    return variable("separation", codecs=[{"name": name, "configuration": {}} for name in names])


def listed_elsewhere(path: Path) -> None:
    """A consolidated description that names a folder above."""
    about = json.loads((path / "zarr.json").read_text())
    metadata = about["consolidated_metadata"]["metadata"]
    metadata["../../separation"] = metadata.pop("separation")
    (path / "zarr.json").write_text(json.dumps(about))


def a_chunk(path: Path, name: str) -> Path:
    return next(store.chunks_of(path / name))


def linked_chunk(path: Path) -> None:
    chunk = a_chunk(path, "separation")
    chunk.rename(path.parent / "secret")
    chunk.symlink_to(path.parent / "secret")


def linked_variable(path: Path) -> None:
    (path / "separation").rename(path.parent / "elsewhere")
    (path / "separation").symlink_to(path.parent / "elsewhere", target_is_directory=True)


def linked_folder(path: Path) -> None:
    """Of the chunks of one frame."""
    folder = a_chunk(path, "position").parent
    folder.rename(path.parent / "elsewhere")
    folder.symlink_to(path.parent / "elsewhere", target_is_directory=True)


def pipe(path: Path) -> None:
    chunk = a_chunk(path, "separation")
    chunk.unlink()
    os.mkfifo(chunk)


def cut(path: Path) -> None:
    chunk = a_chunk(path, "position")
    chunk.write_bytes(chunk.read_bytes()[:-7])


def flipped(path: Path) -> None:
    """One bit in the middle."""
    chunk = a_chunk(path, "position")
    content = bytearray(chunk.read_bytes())
    content[len(content) // 2] ^= 1
    chunk.write_bytes(content)


def bomb(path: Path) -> None:
    """A file that says that it unpacks to 2 GB."""
    chunk = a_chunk(path, "position")
    content = bytearray(chunk.read_bytes())
    content[4:8] = (2**31 - 1).to_bytes(4, "little")
    chunk.write_bytes(content)


def zstd_bomb(path: Path) -> None:
    """A frame of zstd, well formed, that unpacks to 256 MB of zeros."""
    from numcodecs import Zstd

    a_chunk(path, "separation").write_bytes(Zstd(level=9).encode(bytes(2**28)))


def deep(path: Path) -> None:
    (path / "separation" / "zarr.json").write_text("[" * 100_000)


def not_json(path: Path) -> None:
    (path / "separation" / "zarr.json").write_text("{")


def emptied(path: Path) -> None:
    a_chunk(path, "separation").write_bytes(b"")


def pickled(path: Path) -> None:
    """An array of Python objects, as another zarr format packs them."""
    described(path, "separation", data_type="object")


HUGE = {"shape": [10**12], "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [9]}}}

CASES: dict[str, tuple[Change, str]] = {
    "one bit": (flipped, "cannot be read"),
    "a file cut short": (cut, "cannot be read"),
    "an empty file": (emptied, "does not unpack to what belongs there"),
    "a file that is missing": (
        lambda p: a_chunk(p, "velocity").unlink(),
        "'velocity' lies in 0 files and should lie in 1",
    ),
    "a bomb": (bomb, "does not unpack to what belongs there"),
    "a bomb of zstd": (zstd_bomb, "does not unpack to what belongs there"),
    "a link out": (linked_chunk, "leads out of the folder"),
    "a folder of chunks that is a link": (linked_folder, "leads elsewhere"),
    "a folder that is a link": (linked_variable, "leads out of the folder"),
    "names with ..": (listed_elsewhere, "its list of variables is not that of its folders"),
    "names of chunks": (
        variable("separation", chunk_key_encoding={"name": "v2", "configuration": {"separator": "/../"}}),
        "the files of 'separation' are named",
    ),
    "terabytes": (variable("separation", **HUGE), "takes 8e.03 GB, and at most 8 are read"),
    "one chunk of gigabytes": (
        variable("separation", chunk_grid={"name": "regular", "configuration": {"chunk_shape": [10**9]}}),
        "lies in pieces of shape",
    ),
    "negative": (variable("separation", shape=[-9]), r"the shape of 'separation' is \[-9\]"),
    "objects": (pickled, "'separation' holds 'object', not numbers"),
    "text": (variable("separation", data_type={"name": "fixed_length_utf32"}), "not numbers"),
    "pickles": (codecs("bytes", "numcodecs.pickle"), "is packed by .*pickle"),
    "gzip": (codecs("bytes", "gzip"), "is packed by"),
    "no codecs": (variable("separation", codecs=None), "is packed by"),
    "no dimensions": (variable("separation", dimension_names=None), "does not name its 1 dimensions"),
    "dimensions that disagree": (variable("separation", shape=[8]), "done is 9, more than there are"),
    "a group in it": (variable("separation", node_type="group"), "is no array of zarr's third format"),
    "nesting without end": (deep, "is not JSON"),
    "half a description": (not_json, "is not JSON"),
    "a spec that is none": (attribute("spec", "[1, 2"), "its attribute 'spec' does not hold JSON"),
    "a spec of something else": (attribute("spec", 3), "its attribute 'spec' is 3"),
    "no spec": (without("spec"), "it has no attribute 'spec'"),
    "no status": (without("status"), "it has no attribute 'status'"),
    "friction in words": (attribute("c_f", "x"), "its attribute 'c_f' is 'x'"),
    "frames in words": (attribute("done", "many"), "its attribute 'done' is 'many'"),
    "frames that are not there": (attribute("done", 10**9), "done is 1000000000, more than there are"),
    "frames below none": (attribute("done", -1), "its attribute 'done' is -1"),
    "a truth value": (attribute("sampled", True), "its attribute 'sampled' is True"),
    "versions in a list": (attribute("versions", ["numpy"]), "its attribute 'versions' is"),
    "a machine of lists": (attribute("machine", {"cores": []}), "its attribute 'machine' is"),
    "restarts of numbers": (attribute("resumed", [1]), "its attribute 'resumed' is"),
    "a later format": (
        attribute("format", 2),
        "is of format 2, and this version of torsade reads 1; read it with",
    ),
}
if hasattr(os, "mkfifo"):
    CASES["a pipe"] = (pipe, "cannot be read")


@pytest.mark.parametrize("case", CASES)
def test_what_is_unfit_is_refused_in_a_sentence(copy: Path, case: str) -> None:
    spoil, says = CASES[case]
    spoil(copy)
    tracemalloc.start()
    try:
        with pytest.raises(ts.TorsadeError, match=says) as refused:
            ts.open(copy)
        assert tracemalloc.get_traced_memory()[1] < 64 * 2**20
    finally:
        tracemalloc.stop()
    said = str(refused.value)
    assert "reef.zarr" in said
    assert "\n" not in said
    assert len(said) < len(str(copy)) + 400


@pytest.mark.parametrize("case", ["one bit", "a file cut short", "a bomb", "a file that is missing"])
def test_damage_in_what_is_read_later_is_told_when_it_is_read(
    copy: Path, case: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    spoil, _ = CASES[case]
    sound = ts.open(copy).dataset
    spoil(copy)
    monkeypatch.setattr(results, "READ_AT_ONCE", 1000)
    late = ts.open(copy)
    assert late.dataset["separation"].equals(sound["separation"])
    name = "velocity" if "missing" in case else "position"
    with pytest.raises(ts.TorsadeError, match=r"reef.zarr.*(cannot be read|lies in 0 files)") as told:
        _ = late.dataset[name].isel(time=3).values
    assert "\n" not in str(told.value)
    if "missing" not in case:
        with pytest.raises(ts.TorsadeError, match="cannot be read"):
            late.export("vtk", copy.parent / "a.pvd")
        assert sorted(p.name for p in copy.parent.iterdir()) == ["reef.zarr"]


def test_what_is_read_later_is_the_same(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sound = ts.open(copy).dataset
    for limits in ({"READ_AT_ONCE": 1000}, {"READ_IN_ALL": 20_000}):
        with monkeypatch.context() as patch:
            for name, value in limits.items():
                patch.setattr(results, name, value)
            late = ts.open(copy).dataset
        assert not late["position"].variable._in_memory
        assert late.identical(sound)
        np.testing.assert_array_equal(
            late["position"][[1, 4], 3:9, ::-1], sound["position"][[1, 4], 3:9, ::-1]
        )


def test_what_is_read_later_is_saved_too(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sound = ts.open(copy).dataset
    monkeypatch.setattr(results, "READ_AT_ONCE", 1000)
    for path in (copy.with_name("b.zarr"), copy):  # even onto itself
        ts.open(copy).save(path, overwrite=True)
        assert ts.open(path).dataset.identical(sound)


def test_every_bit_that_is_flipped_is_noticed(copy: Path) -> None:
    """In the numbers of any variable, by its checksum; at random, a hundred times."""
    chance = np.random.default_rng(5)
    sound = ts.open(copy).dataset
    names = [name for name, files in store.chunk_files(copy).items() if files]
    for _ in range(100):
        chunk = a_chunk(copy, names[chance.integers(len(names))])
        content = chunk.read_bytes()
        bad = bytearray(content)
        bad[chance.integers(len(bad))] ^= 1 << int(chance.integers(8))
        chunk.write_bytes(bad)
        with pytest.raises(ts.TorsadeError, match="cannot be read"):
            ts.open(copy)
        chunk.write_bytes(content)
    assert ts.open(copy).dataset.identical(sound)


def test_other_files_in_the_folder_do_no_harm(copy: Path) -> None:
    sound = ts.open(copy).dataset
    (copy / ".DS_Store").write_bytes(b"x")
    (copy / "position" / "c" / ".nfs0001").write_bytes(b"x")
    (copy / "notes").mkdir()
    (copy / "notes" / "zarr").write_text("mine")
    assert ts.open(copy).dataset.identical(sound)


def test_a_store_of_another_program_is_not_ours(tmp_path: Path) -> None:
    path = tmp_path / "theirs.zarr"
    for version in (2, 3):
        xarray.Dataset({"a": ("x", np.arange(3))}).to_zarr(
            path, zarr_format=version, consolidated=False, mode="w"
        )
        with pytest.raises(ts.TorsadeError, match="is not a result of torsade; give a folder"):
            ts.open(path)
    for content in ("", "[]", '{"attributes": 3}', "[" * 100_000, '{"a": ' + "1" * 5000 + "}"):
        (path / "zarr.json").write_text(content)
        with pytest.raises(ts.TorsadeError, match="is not a result of torsade"):
            ts.open(path)
    with (path / "zarr.json").open("wb") as file:
        file.truncate(10**12)  # takes no room on disk
    with pytest.raises(ts.TorsadeError, match="is not a result of torsade"):
        ts.open(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes")
def test_a_description_that_is_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    (tmp_path / "a.zarr").mkdir()
    os.mkfifo(tmp_path / "a.zarr" / "zarr.json")
    with pytest.raises(ts.TorsadeError, match="is not a result of torsade"):
        ts.open(tmp_path / "a.zarr")


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_what_runs_write_is_fit(protocol: str, stored: Callable[[str], Path]) -> None:
    path = stored(protocol)
    attrs, described = vetting.vetted(path)
    assert attrs["chunks"] == store.chunk_files(path)
    for name, about in described.items():
        vetting.check_files(path, name, about, attrs["chunks"][name])
    result = ts.open(path)
    assert result.dataset.attrs["format"] == 1
    for name, values in result.dataset.variables.items():
        assert values.attrs["units"], name
        assert values.attrs["long_name"], name
    saved = result.save(path.with_name(f"{protocol}-saved.zarr"), overwrite=True)
    assert store.chunk_files(saved) == vetting.vetted(saved)[0]["chunks"]
    assert ts.open(saved).dataset.identical(result.dataset)


PLAIN = """
import json, sys
class NoTorsade:
    def find_spec(self, name, *_):
        if name.partition(".")[0] == "torsade":
            raise ImportError("torsade is not here")
sys.meta_path.insert(0, NoTorsade())
import xarray
run = xarray.open_zarr(sys.argv[1], chunks=None)
ends = {"time": "done", "sample": "sampled"}
run = run.isel({dim: slice(0, run.attrs[name]) for dim, name in ends.items() if dim in run.dims})
spec = json.loads(run.attrs["spec"])
assert run.sizes["time"] == run.attrs["done"] and spec["protocol"] == run.attrs["protocol"]
assert all(v.attrs["units"] and v.attrs["long_name"] for v in run.variables.values())
assert not [name for name in sys.modules if name.partition(".")[0] == "torsade"]
print(float(abs(run.load()).sum(skipna=True).to_array().sum()))
"""


def test_plain_xarray_opens_every_result_without_torsade(
    stored: Callable[[str], Path], tmp_path: Path
) -> None:
    import subprocess

    for protocol in PROTOCOLS:
        path = stored(protocol)
        done = subprocess.run(
            [sys.executable, "-W", "error", "-c", PLAIN, str(path)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert (done.returncode, done.stderr) == (0, "")
        mine = float(abs(ts.open(path).dataset).sum(skipna=True).to_array().sum())
        assert float(done.stdout) == pytest.approx(mine, rel=1e-13)  # sums depend on how arrays lie in memory

"""Results on disk: what is written is read, nothing is harmed, and what cannot be written is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray

import torsade as ts
from torsade import store, zarr_files

FRAMES, NODES = 5, 7


@pytest.fixture
def result() -> ts.Result:
    rng = np.random.default_rng(3)
    dataset = xarray.Dataset(
        {
            "separation": ("time", rng.random(FRAMES), {"units": "m"}),
            "position": (("time", "node", "space"), rng.random((FRAMES, NODES, 3)).astype(np.float32)),
            "node_start": ("fiber_bound", np.array([0, 3, 7])),
            "closed": ("fiber", np.array([False, False])),
        },
        coords={"time": np.linspace(0, 1, FRAMES)},
        attrs={
            "protocol": "prison-escape",
            "spec": '{"force": 15.0}',
            "knot": "reef",
            "versions": {"torsade": ts.__version__},
            "status": "complete",
            "done": FRAMES,
            "c_f": 48.9,
        },
    )
    return ts.Result(dataset)


def test_what_is_saved_is_opened(tmp_path: Path, result: ts.Result) -> None:
    path = result.save(tmp_path / "reef.zarr")
    again = ts.open(path)
    assert again.dataset.identical(result.dataset)
    assert again.dataset["position"].dtype == np.float32
    assert (again.c_f, again.slipped_at, again.frames, again.complete) == (48.9, None, FRAMES, True)
    assert again.spec == {"force": 15.0}
    assert repr(again) == "<Result of prison-escape on reef: 5 frames to t = 1 s>"


def test_the_last_frame_that_held(result: ts.Result) -> None:
    assert result.last_held == FRAMES - 1
    result.dataset.attrs["slipped_at_s"] = 0.75  # the frame at index 3
    assert result.last_held == 2
    result.dataset.attrs["slipped_at_s"] = 0.8  # between frames
    assert result.last_held == 3


def test_plain_xarray_reads_it(tmp_path: Path, result: ts.Result) -> None:
    path = result.save(tmp_path / "reef.zarr")
    with xarray.open_zarr(path, chunks=None) as plain:
        assert plain.attrs.pop("chunks") == store.chunk_files(path)
        assert plain.load().identical(result.dataset)


def test_a_result_is_replaced_only_when_asked(tmp_path: Path, result: ts.Result) -> None:
    path = result.save(tmp_path / "reef.zarr")
    with pytest.raises(ts.TorsadeError, match="exists already; give another name, or overwrite=True"):
        result.save(path)
    ts.open(path).save(path, overwrite=True)  # even onto itself
    assert ts.open(path).dataset.identical(result.dataset)
    assert [p.name for p in tmp_path.iterdir()] == ["reef.zarr"]


@pytest.mark.parametrize("name", ["other.zarr", "other.zarr.part"])
def test_what_is_not_ours_is_never_touched(tmp_path: Path, result: ts.Result, name: str) -> None:
    foreign = tmp_path / name
    foreign.mkdir()
    (foreign / "thesis.tex").write_text("years of work")
    with pytest.raises(ts.TorsadeError, match="is not a result of torsade; give another name"):
        result.save(tmp_path / "other.zarr", overwrite=True)
    assert (foreign / "thesis.tex").read_text() == "years of work"


def test_a_zarr_of_somebody_else_is_not_ours(tmp_path: Path, result: ts.Result) -> None:
    (tmp_path / "a.zarr").mkdir()
    (tmp_path / "a.zarr" / "zarr.json").write_text('{"zarr_format": 3, "attributes": {}}')
    with pytest.raises(ts.TorsadeError, match="is not a result of torsade"):
        result.save(tmp_path / "a.zarr", overwrite=True)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("reef", "give a name that ends in .zarr"),
        ("missing/reef.zarr", "there is no folder"),
        ("file/reef.zarr", "there is no folder"),
    ],
)
def test_places_that_cannot_be_written(tmp_path: Path, result: ts.Result, name: str, says: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ts.TorsadeError, match=says):
        result.save(tmp_path / name)


def test_opening_what_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ts.TorsadeError, match="does not exist; give a folder NAME"):
        ts.open(tmp_path / "none.zarr")
    with pytest.raises(ts.TorsadeError, match="is not a result of torsade"):
        ts.open(tmp_path)


def test_frames_are_appended_in_whole_chunks(tmp_path: Path) -> None:
    frames = 3 * zarr_files.CHUNK_BYTES // 8 + 5  # more than three chunks of a scalar
    values = np.full(frames, np.nan)
    attrs = {"protocol": "tighten", "spec": "{}", "status": "running", "versions": {}, "done": 0}
    path = tmp_path / "long.zarr.part"
    store.create(xarray.Dataset({"time": ("time", values), "length": ("time", values)}, attrs=attrs), path)
    done = 0
    for upto in (1, 100, frames // 2, frames):
        values[done:upto] = np.arange(done, upto)
        store.append(path, {"time": values, "length": values}, done, upto)
        store.set_attributes(path, {"done": upto})
        done = upto
        read = ts.open(path).dataset["length"].values
        np.testing.assert_array_equal(read, np.arange(upto))


def test_a_report_of_what_is_damaged_or_not_done_is_refused(result: ts.Result) -> None:
    with pytest.raises(ts.TorsadeError, match=r"cannot be read \('pulled'\); it is damaged"):
        result.report()
    result.dataset.attrs["status"] = "interrupted"
    with pytest.raises(ts.TorsadeError, match="the run is interrupted, and its numbers come at its end"):
        result.report()
    result.dataset.attrs["protocol"] = "knit"
    with pytest.raises(ts.TorsadeError, match="protocol 'knit', which this version does not have"):
        result.report()

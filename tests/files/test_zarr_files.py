"""Folders of arrays as zarr writes them: what is there, who reads it, what is refused."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import xarray
import zarr

import torsade as ts
from torsade import store


@pytest.fixture
def dataset() -> xarray.Dataset:
    """Numbers of every kind that results have, one that takes several files, one that is empty."""
    rng = np.random.default_rng(7)
    about = {"units": "1", "long_name": "numbers"}
    variables = {
        "position": (("time", "node", "space"), rng.normal(size=(50, 300, 3)).astype(np.float32)),
        "twist": (("time", "fiber"), rng.normal(size=(50, 2))),
        "zeros": (("time", "node"), np.zeros((50, 300), np.float32)),
        "unknown": ("time", np.full(50, np.nan)),
        "node_start": ("fiber_bound", np.array([0, 100, 300])),
        "count": ("fiber", np.array([3, 4], np.uint8)),
        "closed": ("fiber", np.array([False, True])),
        "number": ((), np.array(2.5)),
        "nothing": (("time", "none"), np.zeros((50, 0))),
    }
    labelled = {name: (dims, values, about) for name, (dims, values) in variables.items()}
    attrs = {"protocol": "tighten", "spec": "{}", "status": "complete", "versions": {}, "c_f": np.float64(3)}
    return xarray.Dataset(labelled, coords={"time": np.linspace(0, 1, 50)}, attrs=attrs)


def test_every_file_is_there(dataset: xarray.Dataset, tmp_path: Path) -> None:
    """Of zeros and of nan too, so that all can be counted; rows that come later are not."""
    store.create(dataset, tmp_path / "a.zarr")
    counts = store.chunk_files(tmp_path / "a.zarr")
    assert counts == ts.places.attributes(tmp_path / "a.zarr")["chunks"]
    assert (counts["position"], counts["zeros"], counts["unknown"], counts["nothing"]) == (3, 1, 1, 0)
    store.create(dataset.assign_attrs(done=1), tmp_path / "growing.zarr.part")
    assert store.chunk_files(tmp_path / "growing.zarr.part")["position"] == 1


def test_threads_that_store_leave_out_no_file(dataset: xarray.Dataset, tmp_path: Path) -> None:
    """What zarr is told holds for the whole process: one thread would take it back while another writes."""
    places = [tmp_path / f"{k}.zarr" for k in range(24)]
    with ThreadPoolExecutor(4) as threads:
        list(threads.map(lambda path: store.create(dataset, path), places))
    assert {store.chunk_files(path)["zeros"] for path in places} == {1}
    assert zarr.config.get("array.write_empty_chunks") is False


def test_xarray_reads_what_was_written(dataset: xarray.Dataset, tmp_path: Path) -> None:
    store.create(dataset, tmp_path / "a.zarr")
    with xarray.open_zarr(tmp_path / "a.zarr", chunks=None) as read:
        assert read.attrs.pop("chunks") == store.chunk_files(tmp_path / "a.zarr")
        assert read.load().identical(dataset)
    assert ts.open(tmp_path / "a.zarr").dataset.identical(dataset)


@pytest.mark.parametrize("order", [">f8", "<f8"])
def test_numbers_lie_in_one_order_of_bytes(order: str, tmp_path: Path) -> None:
    values = np.linspace(0, 1, 5).astype(order)
    attrs = {"protocol": "tighten", "spec": "{}", "status": "complete", "versions": {}}
    store.create(xarray.Dataset(coords={"time": values[::-1]}, attrs=attrs), tmp_path / "a.zarr")
    np.testing.assert_array_equal(ts.open(tmp_path / "a.zarr").dataset["time"], values[::-1])


def test_what_is_no_number_is_refused(tmp_path: Path) -> None:
    words = xarray.Dataset({"name": ("x", np.array(["a", "b"]))})
    with pytest.raises(
        ts.TorsadeError, match=r"'name' holds str.*, and only numbers are stored; leave it out"
    ):
        store.create(words, tmp_path / "a.zarr")
    named = xarray.Dataset({"../name": ("x", np.zeros(3))})
    with pytest.raises(ts.TorsadeError, match=r"a variable is called '../name'; give it a name that"):
        store.create(named, tmp_path / "a.zarr")
    odd = xarray.Dataset({"number": ("x", np.zeros(3))}, attrs={"made": object})
    with pytest.raises(ts.TorsadeError, match=r"an attribute is <class 'object'>; give numbers, text"):
        store.create(odd, tmp_path / "a.zarr")
    with pytest.raises(ts.TorsadeError, match=r"cannot write .*; give a place with room"):
        store.create(words.drop_vars("name"), tmp_path / "none" / "a.zarr")
    assert list(tmp_path.iterdir()) == []

"""What storing a run costs: files that zarr makes in memory, and the same written by zarr and xarray.

Both write folders that plain xarray opens, from the same numbers. A short run is written once at its end; by
zarr, as runs did before, its folder is made at the start, and grows with the first frame and with the last. A
long run grows in both ways. Times are medians of processor time, and of time on the wall.
"""

from __future__ import annotations

import itertools
import os
import statistics
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any
from unittest.mock import patch

import numpy as np
import zarr
from zarr.codecs import BloscCodec, Crc32cCodec, ZstdCodec

from benchmarks import common
from benchmarks.protocols import QUICK, TYPICAL
from torsade import store, zarr_files
from torsade.variables import ENDS

if TYPE_CHECKING:
    import xarray

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"

LONG = 20
"""Writes of a run that goes on for ten seconds."""

RESTART = {"x": np.zeros((300, 3)), "theta": np.zeros(300)}


class ByZarr:
    """What `torsade.store` does, done by xarray and zarr."""

    @staticmethod
    def create(dataset: xarray.Dataset, path: Path) -> None:
        encoding: dict[str, dict[str, Any]] = {}
        for name, variable in dataset.variables.items():
            single = variable.dtype == np.float32
            packing = (
                BloscCodec(cname="zstd", clevel=5, shuffle="bitshuffle") if single else ZstdCodec(level=0)
            )
            chunks = zarr_files.chunk_shape(variable)
            encoding[str(name)] = {"compressors": [packing, Crc32cCodec()], "chunks": chunks}
        beyond = {
            name: (variable.dims, np.full(variable.shape, np.nan, variable.dtype), variable.attrs)
            for name, variable in dataset.variables.items()
            if variable.dims[0] in ENDS and name not in dataset.coords
        }
        dataset.assign(beyond).to_zarr(path, mode="w-", zarr_format=3, consolidated=True, encoding=encoding)

    @staticmethod
    def append(path: Path, arrays: dict[str, np.ndarray], first: int, last: int) -> None:
        group = zarr.open_group(path, mode="r+")
        for name, values in arrays.items():
            array = group[name]
            assert isinstance(array, zarr.Array)
            rows = array.chunks[0]
            whole = slice(first // rows * rows, min(-(-last // rows) * rows, len(values)))
            array[whole] = values[whole]

    @staticmethod
    def set_attributes(path: Path, changed: dict[str, Any]) -> None:
        zarr.open_group(path, mode="r+").update_attributes(changed)

    @staticmethod
    def complete(part: Path, out: Path, sizes: dict[str, int], changed: dict[str, Any]) -> None:
        group = zarr.open_group(part, mode="r+")
        for _, array in group.arrays():
            size = sizes.get(str(array.metadata.dimension_names[0]))  # type: ignore[index, union-attr]
            if size not in (None, array.shape[0]):
                array.resize((size, *array.shape[1:]))
        group.update_attributes(changed | {"chunks": store.chunk_files(part)})
        zarr.consolidate_metadata(str(part))
        store.give_name(part, out)


def grown(by: Any, dataset: xarray.Dataset, folder: Path, writes: int) -> None:
    """Write a dataset as a run does that comes to the disk so many times before its end."""
    part, out = folder / "run.zarr.part", folder / "run.zarr"
    ends = {
        dim: np.linspace(1, dataset.sizes[dim], writes + 1).astype(int) for dim in ENDS if dim in dataset.dims
    }
    attributes = [{ENDS[dim]: int(end[k]) for dim, end in ends.items()} for k in range(writes + 1)]
    by.create(dataset.assign_attrs(attributes[0]), part)
    for k in range(writes + 1):
        for dim, end in ends.items():
            arrays = {str(n): v.values for n, v in dataset.variables.items() if v.dims[0] == dim}
            by.append(part, arrays, int(end[k - 1]) if k else 0, int(end[k]))
        store.write_restart(part, RESTART)
        by.set_attributes(part, attributes[k])
    by.complete(part, out, {dim: dataset.sizes[dim] for dim in ends}, attributes[-1])


def at_once(dataset: xarray.Dataset, folder: Path) -> None:
    """Write a dataset as a run does that ends before it comes to the disk."""
    store.create(dataset, folder / "run.zarr.part")
    store.give_name(folder / "run.zarr.part", folder / "run.zarr")


@contextmanager
def operations() -> Iterator[Counter[str]]:
    """Counts what is asked of the system: files opened, folders made, names given, and waits for the disk."""
    counts: Counter[str] = Counter()

    def counted(name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def once(*arguments: Any, **options: Any) -> Any:
            counts[name] += 1
            return call(*arguments, **options)

        return once

    names = {"mkdir": "folders", "replace": "names", "rename": "names", "fsync": "waits"}
    patches = [patch.object(os, call, counted(what, getattr(os, call))) for call, what in names.items()]
    patches.append(patch("io.open", counted("files", open)))
    for each in patches:
        each.start()
    try:
        yield counts
    finally:
        for each in patches:
            each.stop()


def timed(write: Callable[[Path], None], repeats: int) -> tuple[float, float, Counter[str]]:
    """Median processor time and time on the wall [s] of writing to a new folder, and what the system did."""
    taken: list[tuple[float, float]] = []
    with TemporaryDirectory() as place:
        folders = (Path(place) / str(k) for k in itertools.count())

        def once() -> None:
            folder = next(folders)
            folder.mkdir()
            write(folder)

        once()
        for _ in range(repeats):
            began = common.CLOCK(), common.WALL()
            once()
            taken.append((common.CLOCK() - began[0], common.WALL() - began[1]))
        with operations() as counts:
            once()
    cpu, wall = (statistics.median(times) for times in zip(*taken, strict=True))
    return cpu, wall, counts


def compared(spec: Any, writes: int, repeats: int) -> dict[str, Any]:
    """One run, stored both ways."""
    dataset = spec.run().dataset.drop_encoding()
    ways: dict[str, Callable[[Path], None]] = {
        "ours": (lambda folder: grown(store, dataset, folder, writes))
        if writes
        else (lambda folder: at_once(dataset, folder)),
        "by zarr": lambda folder: grown(ByZarr, dataset, folder, max(1, writes)),
    }
    found: dict[str, Any] = {
        "protocol": spec.protocol,
        "writes": writes,
        "variables": len(dataset.variables),
        "mb": dataset.nbytes / 1e6,
    }
    for way, write in ways.items():
        cpu, wall, counts = timed(write, repeats)
        found[way] = {"cpu_ms": 1e3 * cpu, "wall_ms": 1e3 * wall, **dict(counts)}
    found["cpu_ratio"], found["wall_ratio"] = (
        found["by zarr"][key] / found["ours"][key] for key in ("cpu_ms", "wall_ms")
    )
    return found


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--write", action="store_true", help="put the table into docs/performance.md")
    given = options.parse_args(arguments)
    specs, repeats = (QUICK, 1) if given.quick else (TYPICAL, 5)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata is currently not part")
        warnings.filterwarnings("ignore", message="Object at restart.npz is not recognized")
        rows = [compared(spec, writes, repeats) for spec in specs for writes in (0, LONG)]
    heads = (
        "protocol", "written", "variables", "MB", "processor time [ms]", "by zarr", "ratio", "wall [ms]",
        "by zarr", "ratio", "files, folders, names", "by zarr",
    )  # fmt: skip

    def asked(row: dict[str, Any], way: str) -> str:
        return ", ".join(str(row[way].get(what, 0)) for what in ("files", "folders", "names"))

    table = common.table(
        heads,
        [
            [
                r["protocol"], f"{r['writes']} times" if r["writes"] else "once", r["variables"], r["mb"],
                r["ours"]["cpu_ms"], r["by zarr"]["cpu_ms"], r["cpu_ratio"],
                r["ours"]["wall_ms"], r["by zarr"]["wall_ms"], r["wall_ratio"],
                asked(r, "ours"), asked(r, "by zarr"),
            ]
            for r in rows
        ],
    )  # fmt: skip
    if given.write:
        common.put(table, PAGE, "storing")
    return common.show({"runs": rows}, [table], given.json)


if __name__ == "__main__":
    main()

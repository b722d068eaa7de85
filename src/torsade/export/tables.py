"""CSV: histories, a line for every frame; samples; and the nodes of one frame."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.files.regular import replace_file
from torsade.view.strands import strands_at

if TYPE_CHECKING:
    import xarray

__all__ = ["beside", "written"]

Columns = dict[str, NDArray[np.generic]]


def beside(path: Path, what: str) -> Path:
    """The name of a further table: NAME-nodes.csv."""
    return path.with_name(f"{path.stem}-{what}{path.suffix}")


def written(dataset: xarray.Dataset, path: Path, frames: range, overwrite: bool) -> list[Path]:
    """Write NAME.csv of histories, NAME-samples.csv and NAME-nodes.csv where there are any.

    Names of columns end in the unit, as in `separation_m` and `pull_speed_m_per_s`; what is not known is left
    empty. Nodes are those of the last of the frames; those that belong to no piece of a rod are left out.
    """
    tables = {path: _histories(dataset, frames)}
    samples = {
        _column(dataset, name): dataset[name].values
        for name in dataset.data_vars
        if dataset[name].dims == ("sample",)
    }
    if samples:
        tables[beside(path, "samples")] = samples
    if "position" in dataset:
        tables[beside(path, "nodes")] = _nodes(dataset, frames[-1])
    for file in tables:
        if file.exists() and not overwrite:
            raise TorsadeError(
                f"{str(file)!r} exists already; give another name, or --overwrite "
                "(overwrite=True) to replace it"
            )
    for file, columns in tables.items():
        replace_file(file, _table(columns))
    return list(tables)


def _histories(dataset: xarray.Dataset, frames: range) -> Columns:
    """Numbers of frames, times, and whatever is one number a frame, or one for every fiber."""
    at = list(frames)
    columns: Columns = {"frame": np.array(at), "time_s": dataset["time"].values[at]}
    for name, variable in dataset.data_vars.items():
        if variable.dims == ("time",):
            columns[_column(dataset, name)] = variable.values[at]
        elif variable.dims == ("time", "fiber"):
            for k in range(variable.shape[1]):
                columns[_column(dataset, name, k)] = variable.values[at, k]
    return columns


def _nodes(dataset: xarray.Dataset, frame: int) -> Columns:
    """Strand, number along it, position, and whatever is recorded of nodes."""
    strands = strands_at(dataset, frame)
    columns: Columns = {
        "strand": np.concatenate([np.full(len(s.x), k) for k, s in enumerate(strands)]),
        "node": np.concatenate([np.arange(len(s.x)) for s in strands]),
    }
    for name, variable in dataset.data_vars.items():
        if variable.dims[:2] != ("time", "node"):
            continue
        values = variable.isel(time=frame).values
        values = np.concatenate([values[s.rows] for s in strands])
        if values.ndim == 1:
            columns[_column(dataset, name)] = values
        else:
            for k, axis in enumerate("xyz"):
                columns[_column(dataset, name, axis)] = values[:, k]
    return columns


def _column(dataset: xarray.Dataset, name: object, part: object = None) -> str:
    """The name of a column: that of the variable, of its part, and its unit."""
    unit = str(dataset[name].attrs.get("units", "1"))
    over, _, under = unit.partition("/")
    words = [str(name), "" if part is None else str(part), "" if over == "1" else over.replace(" ", "_")]
    return "_".join([word for word in words if word] + ([f"per_{under}"] if under else []))


def _table(columns: Columns) -> bytes:
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(columns)
    rows: Iterable[Sequence[object]] = zip(*(values.tolist() for values in columns.values()), strict=True)
    out.writerows([["" if _unknown(cell) else cell for cell in row] for row in rows])
    return text.getvalue().encode()


def _unknown(cell: object) -> bool:
    return isinstance(cell, float) and not math.isfinite(cell)

"""NPZ: every array of a result, and what it says of itself as JSON; nothing is pickled."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.lib import format as npy

from torsade.places import private, writing

if TYPE_CHECKING:
    import xarray

__all__ = ["written"]


def written(dataset: xarray.Dataset, path: Path, frames: range, tell: Callable[[float], None]) -> list[Path]:
    """Write one file; `about` in it is JSON: attributes, and dimensions, unit and meaning of every variable.

    Variables are read and written one after the other, so that memory holds one of them.
    """
    about = {
        "attributes": dict(dataset.attrs),
        "variables": {
            str(name): {"dims": list(variable.dims)} | dict(variable.attrs)
            for name, variable in dataset.variables.items()
        },
    }
    new = private(path, "new")
    with writing(path):
        try:
            with zipfile.ZipFile(new, "x", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
                arrays = {"about": np.array(json.dumps(about))}
                for name, values in arrays.items():
                    _add(archive, name, values)
                for k, (key, variable) in enumerate(dataset.variables.items()):
                    at = {"time": list(frames)} if "time" in variable.dims else {}
                    _add(archive, str(key), np.asarray(variable.isel(at)))
                    tell((k + 1) / len(dataset.variables))
            new.replace(path)
        finally:
            new.unlink(missing_ok=True)
    return [path]


def _add(archive: zipfile.ZipFile, name: str, values: np.ndarray) -> None:
    with archive.open(name + ".npy", "w", force_zip64=True) as file:
        npy.write_array(file, values, allow_pickle=False)

"""Results on disk: zarr folders that grow as a run goes on and are renamed when it is complete.

NAME.zarr.part holds what is done so far: arrays of the full number of frames, nan beyond the attribute
`done`, and restart.npz, the exact state to go on from. Every write replaces a file at once, and `done`
is written last, so whatever stops the program, the frames it counts can be read.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError

if TYPE_CHECKING:
    import xarray

__all__ = [
    "append",
    "attributes",
    "check_target",
    "complete",
    "create",
    "discard",
    "has_restart",
    "part_of",
    "read_restart",
    "set_attributes",
    "write_restart",
]

Arrays = Mapping[str, NDArray[Any]]

RESTART = "restart.npz"
CHUNK_BYTES = 2**16
"""Size of a chunk [bytes], rounded up to whole frames."""


def part_of(out: Path) -> Path:
    """Where a result is while it grows."""
    return out.with_name(out.name + ".part")


def attributes(path: Path) -> dict[str, Any] | None:
    """Attributes of a result on disk, complete or not; None when the path is nothing of ours."""
    try:
        found = json.loads((path / "zarr.json").read_text(encoding="utf-8"))["attributes"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    ours = isinstance(found, dict) and "protocol" in found and "versions" in found
    return found if ours else None


def check_target(out: str | Path, overwrite: bool = False) -> Path:
    """The path to write a result to, once it is certain that this can be done and harms nothing.

    Raises
    ------
    TorsadeError
        When the name does not end in .zarr, the folder is missing or cannot be written, or something
        is there already: a result that may not be replaced, or anything else.
    """
    out = Path(out)
    if out.suffix != ".zarr" or out.name == ".zarr":
        raise TorsadeError(f"the output is called {str(out)!r}; give a name that ends in .zarr")
    for path in (out, part_of(out)):
        if os.path.lexists(path) and attributes(path) is None:
            raise TorsadeError(f"{str(path)!r} exists and is not a result of torsade; give another name")
    if out.exists() and not overwrite:
        raise TorsadeError(
            f"{str(out)!r} exists already; give another name, or overwrite=True (--overwrite) to replace it"
        )
    if not out.parent.is_dir():
        raise TorsadeError(f"there is no folder {str(out.parent)!r} to write to; create it or give another")
    with _writing(out), tempfile.TemporaryFile(dir=out.parent):
        pass
    return out


def create(dataset: xarray.Dataset, path: Path) -> None:
    """Write a dataset as a new folder in zarr's third format, in place of what was there."""
    from zarr.codecs import BloscCodec

    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in dataset.variables.items():
        if variable.dims[:1] == ("time",):
            frame = max(1, variable.dtype.itemsize * int(np.prod(variable.shape[1:])))
            rows = max(1, min(variable.shape[0], -(-CHUNK_BYTES // frame)))
            encoding[str(name)] = {"chunks": (rows, *variable.shape[1:])}
            if variable.dtype == np.float32:
                codec = BloscCodec(cname="zstd", clevel=5, shuffle="bitshuffle")
                encoding[str(name)]["compressors"] = [codec]
    with _writing(path), _quiet_zarr():
        shutil.rmtree(path, ignore_errors=True)
        dataset.drop_encoding().to_zarr(path, mode="w-", zarr_format=3, consolidated=True, encoding=encoding)


def append(path: Path, arrays: Arrays, first: int, last: int) -> None:
    """Write frames first to last (not included) of arrays (n_frames, ...) that hold all frames so far."""
    import zarr

    with _writing(path), _quiet_zarr():
        group = zarr.open_group(path, mode="r+")
        for name, values in arrays.items():
            array = group[name]
            assert isinstance(array, zarr.Array)
            rows = array.chunks[0]
            # Whole chunks, so that none has to be read back.
            whole = slice(first // rows * rows, min(-(-last // rows) * rows, len(values)))
            array[whole] = values[whole]


def set_attributes(path: Path, changed: Mapping[str, Any]) -> None:
    """Change attributes of a result on disk."""
    import zarr

    with _writing(path), _quiet_zarr():
        zarr.open_group(path, mode="r+").attrs.update(dict(changed))


def write_restart(part: Path, arrays: Arrays) -> None:
    """Replace the restart file at once."""
    with _writing(part):
        new = part / (RESTART + ".new")
        with new.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
        new.replace(part / RESTART)


def has_restart(part: Path) -> bool:
    """Whether a growing result can be gone on with."""
    return (part / RESTART).is_file()


def discard(part: Path) -> None:
    """Remove a growing result that holds no frame."""
    shutil.rmtree(part, ignore_errors=True)


def read_restart(part: Path) -> dict[str, NDArray[Any]]:
    """The arrays of the restart file."""
    try:
        with np.load(part / RESTART, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except (OSError, ValueError, zipfile.BadZipFile):
        raise TorsadeError(
            f"{str(part)!r} has no state to go on from; run without resume to begin anew"
        ) from None


def complete(part: Path, out: Path, frames: int, changed: Mapping[str, Any]) -> None:
    """Cut a grown result to its frames, give it its last attributes and its name."""
    import zarr

    with _writing(part), _quiet_zarr():
        group = zarr.open_group(part, mode="r+")
        for _, array in group.arrays():
            names = array.metadata.dimension_names  # type: ignore[union-attr]
            if names and names[0] == "time" and array.shape[0] != frames:
                array.resize((frames, *array.shape[1:]))
        group.attrs.update(dict(changed))
        (part / RESTART).unlink(missing_ok=True)
        zarr.consolidate_metadata(str(part))
        replaced = out.with_name(out.name + ".replaced")
        if out.exists():
            shutil.rmtree(replaced, ignore_errors=True)
            out.rename(replaced)
        part.rename(out)
        shutil.rmtree(replaced, ignore_errors=True)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Turn what the system says about a path that cannot be written into one sentence."""
    try:
        yield
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise TorsadeError(
            f"cannot write {str(path)!r} ({reason}); give a place with room that can be written"
        ) from None


@contextmanager
def _quiet_zarr() -> Iterator[None]:
    """Leave out that consolidated metadata is not in the standard yet; readers that lack it do without."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata is currently not part")
        warnings.filterwarnings("ignore", message="Object at .* is not recognized as a component")
        yield

"""Results on disk: zarr folders that grow as a run goes on and are renamed when it is complete.

NAME.zarr.part holds what is done so far: arrays of the full number of frames, nan beyond the attribute
`done`, and restart.npz, the exact state to go on from. Every write replaces a file at once, and `done`
is written last, so whatever stops the program, the frames it counts can be read.
"""

from __future__ import annotations

import os
import shutil
import stat
import warnings
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.places import replace, writing

if TYPE_CHECKING:
    import xarray

__all__ = [
    "append",
    "check_restart",
    "chunk_files",
    "chunks_of",
    "complete",
    "create",
    "has_restart",
    "quiet_zarr",
    "read_restart",
    "save",
    "set_attributes",
    "sound_restart",
    "write_restart",
]

Arrays = Mapping[str, NDArray[Any]]

DAMAGE = (OSError, ValueError, EOFError, KeyError, MemoryError, zipfile.BadZipFile, zlib.error)
"""What reading a restart file that is damaged may raise."""

RESTART = "restart.npz"
CHUNK_BYTES = 2**16
"""Size of a chunk [bytes], rounded up to whole frames."""


def create(dataset: xarray.Dataset, path: Path) -> None:
    """Write a dataset as a new folder in zarr's third format; nothing is left when that fails.

    Every file of numbers ends with a checksum, so that one that is damaged is noticed.
    """
    from zarr.codecs import BloscCodec, Crc32cCodec, ZstdCodec

    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in dataset.variables.items():
        single = variable.dtype == np.float32
        packing = BloscCodec(cname="zstd", clevel=5, shuffle="bitshuffle") if single else ZstdCodec(level=0)
        encoding[str(name)] = {"compressors": [packing, Crc32cCodec()]}
        if variable.dims[:1] in (("time",), ("sample",)):
            frame = max(1, variable.dtype.itemsize * int(np.prod(variable.shape[1:])))
            rows = max(1, min(variable.shape[0], -(-CHUNK_BYTES // frame)))
            encoding[str(name)]["chunks"] = (rows, *variable.shape[1:])
    with writing(path), quiet_zarr():
        try:
            dataset.drop_encoding().to_zarr(
                path, mode="w-", zarr_format=3, consolidated=True, encoding=encoding
            )
        except BaseException:
            shutil.rmtree(path, ignore_errors=True)
            raise


def save(dataset: xarray.Dataset, path: Path) -> None:
    """Write a dataset that does not grow any more as a new folder; nothing is left when that fails."""
    create(dataset, path)
    try:
        _seal(path, {})
    except BaseException:
        shutil.rmtree(path, ignore_errors=True)
        raise


def append(path: Path, arrays: Arrays, first: int, last: int) -> None:
    """Write frames first to last (not included) of arrays (n_frames, ...) that hold all frames so far."""
    import zarr

    with writing(path), quiet_zarr():
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

    with writing(path), quiet_zarr():
        zarr.open_group(path, mode="r+").update_attributes(dict(changed))


def write_restart(part: Path, arrays: Arrays) -> None:
    """Replace the restart file at once."""
    with writing(part):
        new = part / (RESTART + ".new")
        with new.open("wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]
            file.flush()
            os.fsync(file.fileno())
        new.replace(part / RESTART)


def has_restart(part: Path) -> bool:
    """Whether a growing result can be gone on with."""
    return (part / RESTART).is_file()


def read_restart(part: Path, wanted: Iterable[str]) -> dict[str, NDArray[Any]]:
    """The arrays of the restart file, those wanted among them."""
    with sound_restart(part):
        return _restart(part, wanted)


@contextmanager
def sound_restart(part: Path) -> Iterator[None]:
    """Turn what a restart file leads to that is damaged, or of something else, into one sentence."""
    try:
        yield
    except TorsadeError:
        raise
    except (*DAMAGE, TypeError, IndexError):
        raise TorsadeError(
            f"the state to go on from in {str(part / RESTART)!r} is damaged; open {str(part)!r} for the "
            "frames that there are, or give --overwrite (overwrite=True) in place of resume to begin anew"
        ) from None


def check_restart(part: Path) -> None:
    """Read all of the restart file.

    Raises
    ------
    One of `DAMAGE`
        When it is damaged.
    """
    _restart(part, None)


def _restart(part: Path, wanted: Iterable[str] | None) -> dict[str, NDArray[Any]]:
    path = part / RESTART
    if not stat.S_ISREG(path.lstat().st_mode):
        raise ValueError
    with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
        if any(member.compress_type != zipfile.ZIP_STORED for member in file.zip.infolist()):
            raise ValueError  # it may unpack to more than memory holds
        return {name: file[name] for name in (file.files if wanted is None else wanted)}


def chunk_files(path: Path) -> dict[str, int]:
    """How many files hold the numbers of every variable of a result on disk.

    Chunks of zeros, or of nothing but nan, have none: whoever reads cannot tell one that was lost.
    """
    arrays = (found.parent for found in sorted(path.glob("*/zarr.json")))
    return {array.name: sum(1 for _ in chunks_of(array)) for array in arrays}


def chunks_of(array: Path) -> Iterator[Path]:
    """The files that hold the numbers of a variable, in its folder."""
    under = array / "c"
    if under.is_file():  # of a single number
        yield under
    for folder, _, names in os.walk(under):
        yield from (Path(folder, name) for name in names if name.isdigit())


def _seal(path: Path, changed: Mapping[str, Any]) -> None:
    """Give a result its last attributes, with the number of its files, and gather what describes it."""
    import zarr

    with writing(path), quiet_zarr():
        group = zarr.open_group(path, mode="r+")
        group.update_attributes(dict(changed) | {"chunks": chunk_files(path)})
        zarr.consolidate_metadata(str(path))


def complete(part: Path, out: Path, sizes: Mapping[str, int], changed: Mapping[str, Any]) -> None:
    """Cut a grown result to the sizes of its dimensions, give it its last attributes and its name.

    What is needed to go on goes last: whatever stops this, it can be done once more.
    """
    import zarr

    with writing(part), quiet_zarr():
        group = zarr.open_group(part, mode="r+")
        for _, array in group.arrays():
            names = array.metadata.dimension_names  # type: ignore[union-attr]
            size = sizes.get(str(names[0])) if names else None
            if size not in (None, array.shape[0]):
                array.resize((size, *array.shape[1:]))
        _seal(part, changed)
        replace(part, out)
        (out / RESTART).unlink(missing_ok=True)


@contextmanager
def quiet_zarr() -> Iterator[None]:
    """Leave out that consolidated metadata is not in the standard yet; readers that lack it do without."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata is currently not part")
        warnings.filterwarnings("ignore", message="Object at .* is not recognized as a component")
        yield

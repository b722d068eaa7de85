"""Results on disk: zarr folders that grow as a run goes on and are renamed when it is complete.

NAME.zarr.part holds what is done so far: arrays of the full number of frames, of which those are written
that the attribute `done` counts, and restart.npz, the exact state to go on from. Every write replaces a file
at once, and `done` is written last, so whatever stops the program, the frames it counts can be read. With it
`chunks` says in how many files they lie, so that one that is lost is noticed.
"""

from __future__ import annotations

import os
import shutil
import stat
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade import zarr_files
from torsade.errors import TorsadeError
from torsade.places import private, replace, writing
from torsade.variables import ENDS, grown

if TYPE_CHECKING:
    import xarray
    import zarr

__all__ = [
    "append",
    "check_restart",
    "chunk_files",
    "chunks_of",
    "complete",
    "create",
    "give_name",
    "has_restart",
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


def create(dataset: xarray.Dataset, path: Path) -> None:
    """Write a dataset as a new folder in zarr's third format; nothing is left when that fails.

    Of what grows, those rows are written that its attributes `done` and `sampled` count. Every file of
    numbers ends with a checksum, so that one that is damaged is noticed.

    Raises
    ------
    TorsadeError
        When it cannot be written, or a variable does not hold numbers.
    """
    with writing(path):
        path.mkdir()
        try:
            with zarr_files.opened(path, whole=True) as group:
                for name, variable in dataset.variables.items():
                    upto = grown([str(dim) for dim in variable.dims], dataset.attrs)
                    zarr_files.add(group, str(name), variable, upto)
                zarr_files.set_attributes(group, dataset.attrs | {"chunks": _counted(group, dataset.attrs)})
        except BaseException:
            shutil.rmtree(path, ignore_errors=True)
            raise


def save(dataset: xarray.Dataset, out: Path) -> None:
    """Write a dataset that does not grow any more, in place of what was there; that stays when this fails."""
    new = private(out, "new")
    create(dataset, new)
    try:
        replace(new, out)
    except BaseException:
        shutil.rmtree(new, ignore_errors=True)
        raise


def append(path: Path, arrays: Arrays, first: int, last: int) -> None:
    """Write frames first to last (not included) of arrays (n_frames, ...) that hold all frames so far."""
    with writing(path), zarr_files.opened(path) as group:
        for name, values in arrays.items():
            zarr_files.write_rows(group[name], values, first, last)


def set_attributes(path: Path, changed: Mapping[str, Any]) -> None:
    """Change attributes of a result on disk; with how far it has grown, what says how many files hold it."""
    with writing(path), zarr_files.opened(path) as group:
        attrs = {**group.attrs, **changed}
        if "chunks" in attrs and not changed.keys().isdisjoint(ENDS.values()):
            attrs["chunks"] = _counted(group, attrs)
        zarr_files.set_attributes(group, attrs)


def _counted(group: zarr.Group, attrs: Mapping[str, Any]) -> dict[str, int]:
    """How many files hold what there is of every array."""
    counts = {}
    for name, dims, array in zarr_files.arrays_of(group):
        shape, upto = array.shape, grown(dims, attrs)
        if upto is not None:
            shape = (min(upto, shape[0]), *shape[1:])
        counts[name] = zarr_files.file_count(shape, array.chunks)
    return counts


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

    Earlier versions left out those of zeros, or of nothing but nan.
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


def complete(part: Path, out: Path, sizes: Mapping[str, int], changed: Mapping[str, Any]) -> None:
    """Cut a grown result to the sizes of its dimensions, give it its last attributes and its name.

    What is needed to go on goes last: whatever stops this, it can be done once more.
    """
    with writing(part), zarr_files.opened(part, whole=True) as group:
        for _, dims, array in zarr_files.arrays_of(group):
            size = sizes.get(next(iter(dims), ""))
            if size not in (None, array.shape[0]):
                array.resize((size, *array.shape[1:]))
        attrs = {**group.attrs, **changed}
        # Earlier versions left out files of zeros, and did not count while a run was growing.
        counts = _counted(group, attrs) if "chunks" in group.attrs else chunk_files(part)
        zarr_files.set_attributes(group, {**attrs, "chunks": counts})
    give_name(part, out)


def give_name(part: Path, out: Path) -> None:
    """Give a grown result that is complete its name."""
    with writing(part):
        replace(part, out)
        (out / RESTART).unlink(missing_ok=True)

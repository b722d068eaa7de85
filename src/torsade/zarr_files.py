"""Folders in zarr's third format: zarr writes them in memory, and here what it wrote goes to the disk.

Where zarr writes to a disk itself it hands every file to another thread, which costs several times what
writing does; and files appear in any order.
"""

from __future__ import annotations

import json
import math
import threading
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError, quoted

if TYPE_CHECKING:
    import xarray
    import zarr

__all__ = [
    "CHUNK_BYTES",
    "NUMBERS",
    "add",
    "arrays_of",
    "chunk_shape",
    "file_count",
    "opened",
    "set_attributes",
    "write_rows",
]

NUMBERS = {
    "bool": 1,
    **{f"{kind}{8 * size}": size for kind in ("int", "uint") for size in (1, 2, 4, 8)},
    "float32": 4,
    "float64": 8,
}
"""Types of numbers that are stored, and their size [bytes]."""

CHUNK_BYTES = 2**16
"""What a file of numbers unpacks to [bytes], rounded up to whole rows."""

LEVEL = 2
"""How hard single precision is packed: 5 takes three times as long and saves nothing, or a twentieth."""

DESCRIPTION = "zarr.json"

_ONE_AT_A_TIME = threading.Lock()
"""What zarr is told, and which warnings are left out, holds for all threads of a process."""


@contextmanager
def opened(path: Path, *, whole: bool = False) -> Iterator[zarr.Group]:
    """A folder for zarr to change, or a new one; at the end new files go to the disk, each at once.

    Numbers go first, then what describes arrays, and last what describes the folder and is read first.

    Parameters
    ----------
    whole : gather the descriptions of arrays anew in that of the folder, as is needed when one has changed
    """
    import zarr
    from zarr.buffer.cpu import Buffer
    from zarr.storage import MemoryStore

    there = [path / DESCRIPTION, *(path.glob(f"*/{DESCRIPTION}") if whole else ())]
    before = {
        file.relative_to(path).as_posix(): Buffer.from_bytes(file.read_bytes())
        for file in there
        if file.is_file()
    }
    held: dict[str, Any] = dict(before)
    store = MemoryStore(held)
    # Every file is written, of zeros too, so that all can be counted.
    with _ONE_AT_A_TIME, zarr.config.set({"array.write_empty_chunks": True}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata is currently not part")
        yield zarr.open_group(store, mode="a", zarr_format=3)
        if whole:
            zarr.consolidate_metadata(store)
    for key in sorted(held, key=lambda key: (key.endswith(DESCRIPTION), -key.count("/"))):
        if held[key] is not before.get(key):
            _put(path / key, held[key].to_bytes())


def add(group: zarr.Group, name: str, variable: xarray.Variable, last: int | None) -> None:
    """Add an array: 64 KiB or a row in a file, with a checksum. Its rows before last are written, or all.

    Raises
    ------
    TorsadeError
        When it does not hold numbers, or has a name that no folder can have.
    """
    from zarr.codecs import BloscCodec, Crc32cCodec, ZstdCodec

    kind, values = variable.dtype.name, variable.values
    if kind not in NUMBERS:
        raise TorsadeError(f"{name!r} holds {kind}, and only numbers are stored; leave it out")
    if name != Path(name).name:
        raise TorsadeError(f"a variable is called {quoted(name)}; give it a name that a folder can have")
    single = values.dtype == np.float32
    packing = BloscCodec(cname="zstd", clevel=LEVEL, shuffle="bitshuffle") if single else ZstdCodec(level=0)
    array = group.create_array(
        name,
        shape=values.shape,
        dtype=values.dtype.newbyteorder("<"),
        chunks=chunk_shape(variable),
        compressors=[packing, Crc32cCodec()],
        fill_value=np.nan if values.dtype.kind == "f" else 0,
        dimension_names=[str(dim) for dim in variable.dims],
        attributes=dict(variable.attrs),
    )
    if values.ndim == 0:
        array[...] = values
    else:
        write_rows(array, values, 0, len(values) if last is None else last)


def chunk_shape(variable: xarray.Variable) -> tuple[int, ...]:
    """The shape of what one file of a variable holds: whole rows, of `CHUNK_BYTES` or one."""
    row = variable.dtype.itemsize * math.prod(variable.shape[1:])
    rows = [max(1, min(n, -(-CHUNK_BYTES // max(1, row)))) for n in variable.shape[:1]]
    return (*rows, *(max(1, n) for n in variable.shape[1:]))


def write_rows(array: Any, values: NDArray[Any], first: int, last: int) -> None:
    """Write the files that hold rows first to last (not included) of an array, of which these are all values.

    Rows behind last that come into the last of these files are written too: none has to be read back.
    """
    rows = array.chunks[0]
    whole = slice(first // rows * rows, min(-(-last // rows) * rows, len(values)))
    if values[whole].size:
        array[whole] = values[whole]


def arrays_of(group: zarr.Group) -> Iterator[tuple[str, tuple[str, ...], Any]]:
    """Name, dimensions and array of all that a folder holds."""
    for name, array in sorted(group.arrays()):
        dims = array.metadata.dimension_names  # type: ignore[union-attr]
        yield name, tuple(str(dim) for dim in dims or ()), array


def file_count(shape: Sequence[int], chunk: Sequence[int]) -> int:
    """How many files hold an array of a shape, in pieces of a shape."""
    return math.prod(-(-n // k) for n, k in zip(shape, chunk, strict=True))


def set_attributes(group: zarr.Group, changed: Mapping[str, Any]) -> None:
    """Change attributes of a folder.

    Raises
    ------
    TorsadeError
        When one is neither a number nor text nor made of them.
    """
    group.update_attributes(json.loads(json.dumps(dict(changed), default=_plain)))


def _plain(value: object) -> object:
    """Numbers and arrays of numpy as JSON takes them."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TorsadeError(f"an attribute is {quoted(value)}; give numbers, text, lists and tables of them")


def _put(path: Path, content: bytes) -> None:
    """Replace a file at once."""
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_name(f".{path.name}.new")
    try:
        new.write_bytes(content)
        new.replace(path)
    except BaseException:
        new.unlink(missing_ok=True)
        raise

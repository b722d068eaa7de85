"""Arrays in zarr's third format, written: descriptions in JSON, and files that hold so many rows each.

The layout is that of the Zarr core specification, version 3. NAME/zarr.json describes an array, the file
NAME/c/K/0/0 holds rows n K to n (K + 1) of one with three dimensions, packed, and the CRC-32C of that. The
zarr.json of the folder has attributes and all descriptions once more, where readers find them together. Zarr
itself writes the same files, and hands each to another thread, which costs many times what writing does.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError, quoted

if TYPE_CHECKING:
    import xarray

__all__ = [
    "CHUNK_BYTES",
    "NUMBERS",
    "described",
    "file_count",
    "read_description",
    "read_group",
    "write_array",
    "write_description",
    "write_group",
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

Described = Mapping[str, Any]


def described(variable: xarray.Variable, name: str) -> dict[str, Any]:
    """The description of an array: 64 KiB or a row in a file; what is not written is nan, 0 or false.

    Raises
    ------
    TorsadeError
        When it does not hold numbers, or has a name that no folder can have.
    """
    kind, shape = variable.dtype.name, [int(n) for n in variable.shape]
    if kind not in NUMBERS:
        raise TorsadeError(f"{name!r} holds {kind}, and only numbers are stored; leave it out")
    if name != Path(name).name:
        raise TorsadeError(f"a variable is called {quoted(name)}; give it a name that a folder can have")
    row = NUMBERS[kind] * math.prod(shape[1:])
    rows = [max(1, min(n, -(-CHUNK_BYTES // max(1, row)))) for n in shape[:1]]
    packing = (
        {"typesize": 4, "cname": "zstd", "clevel": LEVEL, "shuffle": "bitshuffle", "blocksize": 0}
        if kind == "float32"
        else {"level": 0, "checksum": False}
    )
    order = {} if NUMBERS[kind] == 1 else {"configuration": {"endian": "little"}}
    return {
        "zarr_format": 3,
        "node_type": "array",
        "shape": shape,
        "data_type": kind,
        "chunk_grid": {
            "name": "regular",
            "configuration": {"chunk_shape": [*rows, *(max(1, n) for n in shape[1:])]},
        },
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "fill_value": {"b": False, "f": "NaN"}.get(variable.dtype.kind, 0),
        "codecs": [
            {"name": "bytes"} | order,
            {"name": "blosc" if kind == "float32" else "zstd", "configuration": packing},
            {"name": "crc32c"},
        ],
        "attributes": dict(variable.attrs),
        "dimension_names": [str(dim) for dim in variable.dims],
        "storage_transformers": [],
    }


def file_count(shape: Sequence[int], chunk: Sequence[int]) -> int:
    """How many files hold an array of a shape, in pieces of a shape."""
    return math.prod(-(-n // k) for n, k in zip(shape, chunk, strict=True))


def write_array(
    folder: Path, about: Described, values: NDArray[Any], first: int = 0, last: int | None = None
) -> None:
    """Write the files that hold rows first to last (not included) of an array, each whole and at once.

    Rows behind last that come into the last of these files are written too.

    Parameters
    ----------
    folder : of the array, in which its description is
    values : all of the array, of the shape and type described
    """
    if values.size == 0:
        return
    if values.ndim == 0:
        _put(folder / "c", _packed(about, values))
        return
    rows = about["chunk_grid"]["configuration"]["chunk_shape"][0]
    for k in range(first // rows, -(-(len(values) if last is None else last) // rows)):
        held = values[k * rows : (k + 1) * rows]
        if len(held) < rows:
            beyond = np.full((rows - len(held), *held.shape[1:]), float(about["fill_value"]), held.dtype)
            held = np.concatenate([held, beyond])
        file = folder.joinpath("c", str(k), *("0" for _ in values.shape[1:]))
        file.parent.mkdir(parents=True, exist_ok=True)
        _put(file, _packed(about, held))


def write_group(path: Path, attributes: Mapping[str, Any], arrays: Mapping[str, Described]) -> None:
    """Write the description of a folder: attributes, and those of its arrays, by name."""
    _write_json(
        path,
        {
            "attributes": dict(attributes),
            "zarr_format": 3,
            "consolidated_metadata": {
                "kind": "inline",
                "must_understand": False,
                "metadata": dict(sorted(arrays.items())),
            },
            "node_type": "group",
        },
    )


def write_description(folder: Path, about: Described) -> None:
    """Write the description of an array into its folder, which is made when it is missing."""
    folder.mkdir(exist_ok=True)
    _write_json(folder, about)


def read_group(path: Path) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """Attributes of a folder that a run writes, and the descriptions of its arrays, by name."""
    attributes: dict[str, Any] = _read_json(path)["attributes"]
    return attributes, {
        file.parent.name: read_description(file.parent) for file in sorted(path.glob(f"*/{DESCRIPTION}"))
    }


def read_description(folder: Path) -> dict[str, Any]:
    """The description of an array in its folder."""
    return _read_json(folder)


def _read_json(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / DESCRIPTION).read_bytes()))


def _write_json(folder: Path, about: Described) -> None:
    _put(folder / DESCRIPTION, json.dumps(about, default=_plain).encode())


def _plain(value: object) -> object:
    """Numbers and arrays of numpy as JSON takes them."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TorsadeError(f"an attribute is {quoted(value)}; give numbers, text, lists and tables of them")


def _put(path: Path, content: bytes) -> None:
    """Replace a file at once."""
    new = path.with_name(f".{path.name}.new")
    try:
        new.write_bytes(content)
        new.replace(path)
    except BaseException:
        new.unlink(missing_ok=True)
        raise


def _packed(about: Described, values: NDArray[Any]) -> bytes:
    """What a file holds: numbers in little-endian order, packed, and their checksum."""
    from google_crc32c import value as checksum

    (packing,) = (codec for codec in about["codecs"] if codec["name"] in ("blosc", "zstd"))
    plain = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    packed = bytes(_packer(packing["name"]).encode(plain))
    return packed + int(checksum(packed)).to_bytes(4, "little")


@lru_cache(maxsize=2)
def _packer(name: str) -> Any:
    """Whatever its settings were, what it packed is unpacked by the name alone."""
    from numcodecs.blosc import BITSHUFFLE, Blosc
    from numcodecs.zstd import Zstd

    if name == "blosc":
        return Blosc(cname="zstd", clevel=LEVEL, shuffle=BITSHUFFLE)
    return Zstd(level=0)

"""Stored results looked at before they are read: what is foreign, damaged or hostile is refused.

Nothing here trusts a file. Descriptions are small and of known kinds, files regular and within the folder,
and they unpack to what a chunk may hold, so that memory is never filled by what is read.
"""

from __future__ import annotations

import json
import math
import os
import stat
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from torsade.errors import TorsadeError, counted, quoted, reason_of
from torsade.places import LARGEST_DESCRIPTION, attributes
from torsade.store import chunks_of
from torsade.variables import FORMAT
from torsade.zarr_files import NUMBERS, file_count

__all__ = ["Stored", "check_files", "sound_rows", "vetted"]

LARGEST_VARIABLE = 8_000_000_000
"""Largest variable [bytes]: a run holds no more than half of it in memory."""

LARGEST_CHUNK = 64 * 2**20
"""Most that one file of numbers may unpack to [bytes]; those of a run are one frame or 64 KiB."""

MOST_VARIABLES = 500

PACKINGS = ("blosc", "zstd")
CHECKSUM = "crc32c"

KINDS: Mapping[str, tuple[type, ...]] = {
    "protocol": (str,),
    "spec": (str,),
    "model": (str,),
    "start": (str,),
    "knot": (str,),
    "status": (str,),
    "created": (str,),
    "kernels": (str,),
    "versions": (dict,),
    "machine": (dict,),
    "chunks": (dict,),
    "resumed": (list,),
    "format": (int,),
    "done": (int,),
    "sampled": (int,),
    "steps": (int,),
    "radius": (int, float),
    "wall_s": (int, float),
    "c_f": (float, type(None)),
    "slipped_at_s": (float, type(None)),
}
"""Of attributes that a result may have."""

BEFORE = " (info, export and open take the frames before with --salvage, ts.open with salvage=True)"
"""What can be done about files that are lost."""

NEEDED = ("protocol", "spec", "status")
"""Attributes without which nobody knows what it is."""


class Stored(NamedTuple):
    """What the description of a stored variable says.

    Attributes
    ----------
    dims, shape : names and sizes of its dimensions
    itemsize : of one number [bytes]
    chunk : the shape of what one file of it holds
    packing : how it is packed, one of `PACKINGS`, or None
    """

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    itemsize: int
    chunk: tuple[int, ...]
    packing: str | None

    @property
    def chunk_bytes(self) -> int:
        """What one file of it unpacks to [bytes]."""
        return self.itemsize * math.prod(self.chunk)


class _UnfitError(Exception):
    """What is wrong, as the end of a sentence."""


def vetted(path: Path) -> tuple[dict[str, Any], dict[str, Stored]]:
    """Attributes of a stored result, and what its variables are, once both are fit to be read.

    Raises
    ------
    TorsadeError
        When something is not as a run writes it.
    """
    found = attributes(path)
    if found is None:
        raise TorsadeError(
            f"{str(path)!r} is not a result of torsade; give a folder NAME.zarr written by a run"
        )
    with _told(path):
        _check_attributes(found)
    if found.get("format", FORMAT) > FORMAT:
        raise TorsadeError(
            f"{str(path)!r} is of format {found['format']}, and this version of torsade reads {FORMAT}; read "
            "it with a later one"
        )
    with _told(path):
        described = _described(path)
        stored = {name: _variable(name, about) for name, about in described.items()}
        gathered = _description(path / "zarr.json", path).get("consolidated_metadata")
        if gathered is not None and set(_mapping(gathered, "metadata")) != set(stored):
            raise _UnfitError("its list of variables is not that of its folders")
        for name, dim in (("done", "time"), ("sampled", "sample")):
            sizes = {s for v in stored.values() for d, s in zip(v.dims, v.shape, strict=True) if d == dim}
            if sizes and found.get(name, 0) > min(sizes):
                raise _UnfitError(f"{name} is {found[name]}, more than there are")
        if "time" not in stored or stored["time"].dims != ("time",):
            raise _UnfitError("it has no times of frames")
    return found, stored


def check_files(path: Path, name: str, about: Stored, count: object = None, upto: int | None = None) -> None:
    """Look at every file of numbers of a variable.

    Parameters
    ----------
    count : how many should hold the rows that there are, or None where that is not known
    upto : how many rows there are, or None when it does not grow: files behind them were being written when
        the program ended, and count for nothing

    Raises
    ------
    TorsadeError
        When one is not a file within the folder, may unpack to more than belongs there, or is not there.
    """
    with _told(path):
        root = path.resolve()
        _check_folders(path / name, root)
        for file in chunks_of(path / name):
            _check_regular(file, root, 2 * about.chunk_bytes + 2**16)
            if about.packing is not None and _unpacked(file, about.packing) != about.chunk_bytes:
                raise _UnfitError(f"{str(file.relative_to(path))!r} does not unpack to what belongs there")
        number = sum(_pieces(path / name, about, upto).values())
        if count is not None and count != number:
            sound = None if upto is None else sound_rows(path, name, about, count, upto)
            rest = "" if sound is None or (sound == 0 and about.dims[0] == "time") else BEFORE
            lies = f"{name!r} lies in {counted(number, 'file')} and should lie in {quoted(count)}"
            raise _UnfitError(f"{lies}{rest}")


def sound_rows(path: Path, name: str, about: Stored, count: object, upto: int) -> int | None:
    """How many rows of a variable come before the first file that is lost; None where nobody can tell.

    Parameters
    ----------
    count, upto : as `check_files` takes them
    """
    held = _pieces(path / name, about, upto)
    if count is None or count == sum(held.values()):
        return upto
    of_each = file_count(about.shape[1:], about.chunk[1:])
    pieces = -(-upto // about.chunk[0])
    if count != pieces * of_each:  # earlier versions left out files of zeros
        return None
    return about.chunk[0] * next((k for k in range(pieces) if held[k] < of_each), pieces)


def _pieces(array: Path, about: Stored, upto: int | None) -> Counter[int]:
    """How many files there are of each piece along the first dimension that holds some of so many rows."""
    under = len(array.parts) + 1
    held = Counter(file.parts[under] if about.dims else "0" for file in chunks_of(array))
    places = {int(k): n for k, n in held.items() if k.isdecimal()}
    return Counter({k: n for k, n in places.items() if upto is None or k * about.chunk[0] < upto})


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turn what is unfit about a result into one sentence."""
    try:
        yield
    except (_UnfitError, OSError) as error:
        reason = str(error) if isinstance(error, _UnfitError) else reason_of(error)
        raise TorsadeError(
            f"{str(path)!r} cannot be read: {reason}; it is damaged, or no run of torsade wrote it"
        ) from None


def _check_attributes(found: Mapping[str, Any]) -> None:
    for name in NEEDED:
        if name not in found:
            raise _UnfitError(f"it has no attribute {name!r}")
    for name, kinds in KINDS.items():
        value = found.get(name)
        if name in found and (not isinstance(value, kinds) or isinstance(value, bool)):
            raise _UnfitError(f"its attribute {name!r} is {quoted(value)}")
        if isinstance(value, int) and value < 0:
            raise _UnfitError(f"its attribute {name!r} is {quoted(value)}")
    for name in ("spec", "model"):
        try:
            ok = isinstance(json.loads(found.get(name, "{}")), dict)
        except (ValueError, RecursionError):
            ok = False
        if not ok:
            raise _UnfitError(f"its attribute {name!r} does not hold JSON of fields and values")
    for name in ("versions", "machine"):
        if not all(isinstance(value, (str, int)) for value in found.get(name, {}).values()):
            raise _UnfitError(f"its attribute {name!r} is {quoted(found[name])}")
    if not all(isinstance(entry, dict) for entry in found.get("resumed", [])):
        raise _UnfitError(f"its attribute 'resumed' is {quoted(found['resumed'])}")


def _described(path: Path) -> dict[str, dict[str, Any]]:
    """The description of every variable, by the name of its folder."""
    found: dict[str, dict[str, Any]] = {}
    for folder in sorted(path.iterdir()):
        if (folder / "zarr.json").exists():
            found[folder.name] = _description(folder / "zarr.json", path)
            if len(found) > MOST_VARIABLES:
                raise _UnfitError(f"it has more than {MOST_VARIABLES} variables")
    return found


def _description(file: Path, path: Path) -> dict[str, Any]:
    _check_inside(file.parent, path.resolve())
    _check_regular(file, path.resolve(), LARGEST_DESCRIPTION)
    try:
        about = json.loads(file.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        about = None
    if not isinstance(about, dict):
        raise _UnfitError(f"{str(file.relative_to(path))!r} is not JSON")
    return about


def _check_regular(file: Path, root: Path, most: int) -> None:
    """Refuse what is no file, leads out of the folder, or is too large."""
    about = file.lstat()
    if stat.S_ISLNK(about.st_mode):
        _check_inside(file, root)
        about = file.stat()
    if not stat.S_ISREG(about.st_mode):
        raise _UnfitError(f"{file.name!r} in {file.parent.name!r} is a folder, a pipe or a device")
    if about.st_size > most:
        raise _UnfitError(f"{file.name!r} in {file.parent.name!r} has {about.st_size / 2**20:.0f} MB")


def _check_inside(path: Path, root: Path) -> None:
    if not path.resolve().is_relative_to(root):
        raise _UnfitError(f"{path.name!r} in {path.parent.name!r} leads out of the folder")


def _check_folders(array: Path, root: Path) -> None:
    """Refuse folders of a variable that lead elsewhere, where its files would not be looked at."""
    _check_inside(array / "c", root)
    for folder, names, _ in os.walk(array / "c"):
        for name in names:
            if Path(folder, name).is_symlink():
                raise _UnfitError(f"{name!r} in {Path(folder).name!r} leads elsewhere")


def _variable(name: str, about: Mapping[str, Any]) -> Stored:
    """What the description of a variable says, once it is one that a run may have written."""
    if about.get("node_type") != "array" or about.get("zarr_format") != 3:
        raise _UnfitError(f"{name!r} is no array of zarr's third format")
    shape = _sizes(about.get("shape"), f"the shape of {name!r}", 0)
    dims = about.get("dimension_names", [] if not shape else None)  # zarr leaves them out of a single number
    if not (isinstance(dims, list) and len(dims) == len(shape) and all(isinstance(d, str) for d in dims)):
        raise _UnfitError(f"{name!r} does not name its {len(shape)} dimensions")
    kind = about.get("data_type")
    if not isinstance(kind, str) or kind not in NUMBERS:
        raise _UnfitError(f"{name!r} holds {quoted(kind)}, not numbers")
    grid = _mapping(about.get("chunk_grid"), "configuration")
    chunk = _sizes(grid.get("chunk_shape"), f"the chunks of {name!r}", 1)
    size = NUMBERS[kind] * math.prod(shape)
    if size > LARGEST_VARIABLE:
        raise _UnfitError(
            f"{name!r} takes {size / 1e9:.3g} GB, and at most {LARGEST_VARIABLE / 1e9:g} are read"
        )
    chunk_bytes = NUMBERS[kind] * math.prod(chunk)
    if (
        about["chunk_grid"].get("name") != "regular"
        or len(chunk) != len(shape)
        or chunk_bytes > LARGEST_CHUNK
    ):
        raise _UnfitError(f"{name!r} lies in pieces of shape {quoted(chunk)}")
    key = about.get("chunk_key_encoding")
    named = {"name": "default", "configuration": {"separator": "/"}}
    if key != named or about.get("storage_transformers"):
        raise _UnfitError(f"the files of {name!r} are named {quoted(key)}")
    return Stored(tuple(dims), shape, NUMBERS[kind], chunk, _packing(name, about.get("codecs")))


def _packing(name: str, codecs: object) -> str | None:
    """How a variable is packed, of the ways in which runs pack."""
    names = [_mapping(codec).get("name") for codec in codecs] if isinstance(codecs, list) else []
    packing = next((known for known in PACKINGS if known in names), None)
    usual = ["bytes", *([packing] if packing else [])]
    if names not in (usual, [*usual, CHECKSUM]):
        raise _UnfitError(f"{name!r} is packed by {quoted(names)}")
    return packing


def _sizes(value: object, what: str, least: int) -> tuple[int, ...]:
    ok = isinstance(value, list) and len(value) <= 8 and all(type(n) is int and n >= least for n in value)
    if not ok:
        raise _UnfitError(f"{what} is {quoted(value)}")
    assert isinstance(value, list)
    return tuple(value)


def _mapping(value: object, name: str | None = None) -> dict[str, Any]:
    """A mapping, or the one of this name in it."""
    found = value.get(name) if isinstance(value, dict) and name is not None else value
    if not isinstance(found, dict):
        raise _UnfitError(f"it is described by {quoted(value)}")
    return found


def _unpacked(file: Path, packing: str) -> int | None:
    """How many bytes a packed file says that it unpacks to; None where it does not say."""
    with file.open("rb") as raw:
        head = raw.read(18)
    if packing == "blosc":
        return int.from_bytes(head[4:8], "little") if len(head) >= 16 else None
    if head[:4] != b"\x28\xb5\x2f\xfd" or len(head) < 6:
        return None
    # The frame header of RFC 8878, 3.1.1.1: a byte that says which fields follow, then these.
    flags, at = head[4], 5
    single = bool(flags & 0x20)
    at += (0 if single else 1) + (0, 1, 2, 4)[flags & 3]
    width = (1 if single else 0, 2, 4, 8)[flags >> 6]
    size = int.from_bytes(head[at : at + width], "little") + (256 if width == 2 else 0)
    return size if width else None

"""NPZ and NPY: arrays of nodes, shape (n, 3), or (m, n, 3) for m strands; never pickles.

An NPZ file holds `strand0`, `strand1` ... or one array `x`, and may hold `closed`, a truth value for each
strand. Without it a strand that ends with its first node is closed. Sizes are judged by the headers, before
data is read or unpacked.
"""

from __future__ import annotations

import io
import math
import tokenize
import warnings
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, named, quoted
from torsade.files.gathered import MOST_NODES, MOST_STRANDS, made
from torsade.files.regular import opened

__all__ = ["read_npy", "read_npz", "written_npy", "written_npz"]

FloatArray = NDArray[np.float64]

LARGEST_INDEX = 4 * 2**20
"""Largest directory of a zip file that is read [bytes]."""

_DAMAGE = (ValueError, SyntaxError, tokenize.TokenError, TypeError, KeyError, RecursionError, MemoryError)
"""What numpy raises at headers that are none."""

_ZIP_DAMAGE = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, OSError)
"""What zipfile raises at files that are broken, encrypted or packed in unknown ways."""


def written_npz(centerline: Centerline) -> bytes:
    """`strand0`, `strand1` ... and `closed`; nothing is repeated."""
    content = io.BytesIO()
    arrays: dict[str, Any] = {f"strand{k}": x for k, x in enumerate(centerline.strands)}
    np.savez(content, allow_pickle=False, closed=np.array(centerline.closed), **arrays)
    return content.getvalue()


def written_npy(centerline: Centerline) -> bytes:
    """One array; a closed strand ends with its first node.

    Raises:
        TorsadeError: strands have different numbers of nodes.
    """
    pairs = zip(centerline.strands, centerline.closed, strict=True)
    strands = [np.concatenate([x, x[:1]]) if closed else x for x, closed in pairs]
    if len({len(x) for x in strands}) > 1:
        raise TorsadeError("an NPY file holds strands of one length only; give a name that ends in .npz")
    content = io.BytesIO()
    np.save(content, strands[0] if len(strands) == 1 else np.array(strands), allow_pickle=False)
    return content.getvalue()


def read_npy(path: Path) -> Centerline:
    """One array of nodes."""
    name = named(path)
    with opened(path) as (file, _):
        return made(name, _strands(_array(file, name), name))


def read_npz(path: Path) -> Centerline:
    """Arrays `strand0`, `strand1` ... or `x`, and `closed`; others are left out."""
    name = named(path)
    with opened(path) as (file, size):
        _check_index(file, size, name)
        try:
            with zipfile.ZipFile(file) as archive:
                return _read_members(archive, name)
        except _ZIP_DAMAGE as error:
            raise TorsadeError(f"{name} is not a sound NPZ file; write it anew with numpy.savez") from error


def _read_members(archive: zipfile.ZipFile, name: str) -> Centerline:
    members = {member.removesuffix(".npy"): member for member in archive.namelist()}

    def array_of(key: str) -> NDArray[Any]:
        with archive.open(members[key]) as stream:
            return _array(stream, f"{key!r} in {name}")

    strands: list[FloatArray] = []
    while f"strand{len(strands)}" in members:
        key = f"strand{len(strands)}"
        x = _strands(array_of(key), f"{key!r} in {name}")
        strands += x
        if len(x) != 1 or len(strands) > MOST_STRANDS or sum(map(len, strands)) > MOST_NODES:
            raise TorsadeError(
                f"{key!r} in {name} is more than one strand, or one too many; give at most {MOST_STRANDS} "
                f"strands, {MOST_NODES} nodes in all"
            )
    if not strands:
        if "x" not in members:
            has = ", ".join(sorted(members)[:5]) or "nothing"
            raise TorsadeError(f"{name} holds {quoted(has)}; give arrays strand0, strand1 ... or x")
        strands = _strands(array_of("x"), f"'x' in {name}")
    if "closed" not in members:
        return made(name, strands)
    closed = array_of("closed")
    if closed.dtype.kind != "b" or closed.shape not in ((), (len(strands),)):
        raise TorsadeError(
            f"'closed' in {name} has {closed.dtype} of shape {closed.shape}; give {len(strands)} truth values"
        )
    return made(name, strands, np.broadcast_to(closed, (len(strands),)).tolist(), told=True)


def _array(stream: BinaryIO | IO[bytes], what: str) -> NDArray[Any]:
    """The array in a stream, once its header says that it is bearable."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # headers of Python 2
            version = npy.read_magic(stream)
            header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
            shape, fortran, dtype = header(stream)
    except _DAMAGE as error:
        if isinstance(error, (zipfile.BadZipFile, TorsadeError)):
            raise
        raise TorsadeError(f"{what} is no array of numpy; write it anew with numpy.save") from None
    if dtype.hasobject:
        raise TorsadeError(f"{what} holds pickled objects, which are not read; give an array of numbers")
    if dtype.kind not in "fiub" or dtype.subdtype is not None:
        raise TorsadeError(f"{what} has {quoted(str(dtype))}; give an array of real numbers")
    shape = tuple(map(int, shape))  # numpy takes True for a number here, and not below
    count = math.prod(shape)
    if not all(0 <= n <= 3 * MOST_NODES for n in shape) or count > 3 * MOST_NODES:
        raise TorsadeError(f"{what} has shape {quoted(shape)}; give at most {MOST_NODES} nodes")
    data = stream.read(count * dtype.itemsize)
    if len(data) < count * dtype.itemsize:
        raise TorsadeError(f"{what} ends before its {count} numbers; write it anew")
    return np.frombuffer(data, dtype).reshape(shape, order="F" if fortran else "C")


def _strands(x: NDArray[Any], what: str) -> list[FloatArray]:
    """The strands of an array of shape (n, 3) or (m, n, 3)."""
    if x.ndim not in (2, 3) or x.shape[-1] != 3 or x.dtype.kind == "b":
        raise TorsadeError(f"{what} has {x.dtype} of shape {x.shape}; give numbers of shape (n, 3)")
    with np.errstate(over="ignore"):  # longer floats may be beyond double precision
        nodes = np.ascontiguousarray(x, dtype=np.float64)
    if len(nodes) > MOST_STRANDS and nodes.ndim == 3:
        raise TorsadeError(f"{what} has {len(nodes)} strands; give at most {MOST_STRANDS}")
    finite = np.isfinite(nodes).all(axis=-1)
    if not finite.all():
        where = tuple(int(i) for i in np.argwhere(~finite)[0])
        node = ", ".join(f"{c:g}" for c in nodes[where])
        raise TorsadeError(f"{what} has node {where[-1]} at ({node}); give finite numbers")
    return [nodes] if nodes.ndim == 2 else list(nodes)


def _check_index(file: BinaryIO, size: int, name: str) -> None:
    """Refuse a zip file whose directory alone would fill the memory."""
    file.seek(max(0, size - 2**16 - 22))
    tail = file.read()
    at = tail.rfind(b"PK\x05\x06")
    if at < 0 or len(tail) < at + 22:
        raise TorsadeError(f"{name} is not a complete NPZ file; write it anew with numpy.savez")
    if int.from_bytes(tail[at + 12 : at + 16], "little") > LARGEST_INDEX:
        raise TorsadeError(f"{name} holds too many arrays; give strand0, strand1 ... alone")
    file.seek(0)

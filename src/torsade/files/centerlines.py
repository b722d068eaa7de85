"""Read and write centerlines in the format that the name of the file says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from torsade.centerline import Centerline
from torsade.errors import TorsadeError
from torsade.files import csv_table, numpy_arrays, obj, vect, vtk, xyz
from torsade.files.regular import opened, replace_file
from torsade.units import quantity

__all__ = ["SUFFIXES", "format_of", "read_centerline", "read_csv", "write_centerline", "write_csv"]


class Format(NamedTuple):
    """A file format: how it is read, in the unit of the file, and the content that is written."""

    read: Callable[[Path], Centerline] | None
    written: Callable[[Centerline], bytes]


FORMATS = MappingProxyType(
    {
        ".csv": Format(csv_table.read, csv_table.written),
        ".xyz": Format(xyz.read, xyz.written),
        ".obj": Format(obj.read, obj.written),
        ".vect": Format(vect.read, vect.written),
        ".npz": Format(numpy_arrays.read_npz, numpy_arrays.written_npz),
        ".npy": Format(numpy_arrays.read_npy, numpy_arrays.written_npy),
        ".vtk": Format(None, vtk.written),
    }
)

SUFFIXES = tuple(suffix for suffix, form in FORMATS.items() if form.read is not None)
"""How the names of files that can be read end."""


def read_centerline(path: str | Path, unit: str = "m") -> Centerline:
    """Read a file of nodes: CSV, XYZ, OBJ, VECT, NPZ or NPY, by the ending of its name.

    Args:
        path: the file; its suffix, in either case, says the format.
        unit: of length, in which the file has its numbers.

    Returns:
        Strands [m], in the order of the file.

    Raises:
        TorsadeError: an unknown suffix or unit; a file that is missing, too large or not of this form, with
            the line where that can be said.
    """
    form = format_of(path, reading=True)
    assert form.read is not None
    return _in_metres(form.read, path, unit)


def write_centerline(centerline: Centerline, path: str | Path) -> None:
    """Write nodes [m], to the last bit, in a format that `read_centerline` reads or as legacy VTK.

    An earlier file of the name stays until the new one is complete.

    Raises:
        TorsadeError: an unknown suffix, a place that cannot be written, or strands that the format cannot
            hold.
    """
    replace_file(Path(path), format_of(path, reading=False).written(centerline))


def read_csv(path: str | Path, unit: str = "m") -> Centerline:
    """Read nodes from a CSV file with columns strand, x, y, z, in metres or another unit of length.

    Columns are separated by commas, semicolons or tabs, as in the header.
    Lines that begin with # are comments. Strands are numbered 0, 1, 2 ... in the order of the file.
    A strand whose last node equals its first is closed.

    Raises:
        TorsadeError: the file is missing, not a text file of this form, or too large; with the line.
    """
    return _in_metres(csv_table.read, path, unit)


def write_csv(centerline: Centerline, path: str | Path) -> None:
    """Write columns strand, x, y, z [m], to the last bit; a closed strand ends with its first node.

    Raises:
        TorsadeError: the file cannot be written.
    """
    replace_file(Path(path), csv_table.written(centerline))


def format_of(path: str | Path, reading: bool) -> Format:
    """The format that the name of a file says.

    Raises:
        TorsadeError: it says none, or one that is written only.
    """
    suffix = Path(path).suffix.lower()
    form = FORMATS.get(suffix)
    known = ", ".join(SUFFIXES if reading else FORMATS)
    if form is None:
        if reading:
            with opened(Path(path)):  # what is no file at all is refused as such
                pass
        ends = f"ends in {suffix!r}, which is no" if suffix else "has no suffix to say its"
        raise TorsadeError(f"{str(path)!r} {ends} format of curves; give one of {known}")
    if reading and form.read is None:
        raise TorsadeError(f"{str(path)!r} is of a format that is written, not read; give one of {known}")
    return form


def _in_metres(read: Callable[[Path], Centerline], path: str | Path, unit: str) -> Centerline:
    metre = quantity(f"1 {unit}", "length")
    shape = read(Path(path))
    with np.errstate(over="ignore"):
        strands = tuple(metre * x for x in shape.strands)
    for k, x in enumerate(strands):
        if not np.isfinite(x).all():
            raise TorsadeError(
                f"strand {k} in {str(path)!r} is beyond all bounds in {unit}; give another unit"
            )
    return Centerline(strands, shape.closed)

"""Results for other programs: VTK series, glTF, CSV and NPZ.

>>> from torsade.export import FORMATS
>>> sorted(FORMATS)
['csv', 'gltf', 'npz', 'vtk']
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from torsade.errors import TorsadeError, quoted
from torsade.export.frames import chosen
from torsade.places import writing

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["FORMATS", "export"]

FORMATS: Mapping[str, str] = MappingProxyType({"vtk": ".pvd", "gltf": ".glb", "csv": ".csv", "npz": ".npz"})
"""What there is to export to, and how the names of files end."""


def export(
    result: Result,
    to: str,
    path: str | Path,
    frames: str | int | slice | None = None,
    *,
    overwrite: bool = False,
    progress: Callable[[float, str], None] | None = None,
) -> list[Path]:
    """Write a result for other programs.

    Parameters
    ----------
    to : vtk (polylines of every frame, for ParaView), gltf (tubes of one frame), csv (histories, samples, and
        nodes of one frame) or npz (all arrays)
    path : the file to write, of the ending that `FORMATS` says; other files of the export lie beside it
    frames : which: a number, a slice, or text such as "10", "-1", "0:100:10", "all"; all by default, and of
        gltf the last one before a pulled knot slipped
    overwrite : replace files that are there
    progress : called as it goes on

    Returns
    -------
    The files written, `path` first.

    Raises
    ------
    TorsadeError
        When there is no such format or frame, nothing to be drawn, or a file cannot be written.
    """
    ending, out = FORMATS.get(to), Path(path)
    if ending is None:
        raise TorsadeError(f"there is no export to {quoted(to)}; choose vtk, gltf, csv or npz")
    if out.suffix.lower() != ending or not out.stem:
        raise TorsadeError(f"cannot export {to} to {str(path)!r}; give a name that ends in {ending}")
    if os.path.lexists(out) and not overwrite:
        raise TorsadeError(
            f"{str(path)!r} exists already; give another name, or --overwrite (overwrite=True) to replace it"
        )
    with writing(out):
        if out.is_dir():
            raise IsADirectoryError(21, "is a directory")
        if not out.parent.is_dir():
            raise FileNotFoundError(2, "no such folder")
    if result.frames == 0:
        raise TorsadeError("there is no frame yet to be exported; wait for one")

    def tell(share: float) -> None:
        if progress is not None:
            progress(share, f"writing {out.name}")

    wanted = chosen(frames, result.frames, result.last_held if to == "gltf" else slice(None))
    return _written(result, to, out, wanted, overwrite, tell)


def _written(
    result: Result, to: str, out: Path, wanted: range, overwrite: bool, tell: Callable[[float], None]
) -> list[Path]:
    dataset = result.dataset
    if to == "vtk":
        from torsade.export import vtk

        return vtk.written(dataset, out, wanted, overwrite, tell)
    if to == "gltf":
        from torsade.export import gltf

        if len(wanted) != 1:
            raise TorsadeError(
                f"glTF takes one frame, and {len(wanted)} were asked for; give one, such as -1"
            )
        return gltf.written(dataset, out, wanted[0])
    if to == "csv":
        from torsade.export import tables

        return tables.written(dataset, out, wanted, overwrite)
    from torsade.export import arrays

    return arrays.written(dataset, out, wanted, tell)

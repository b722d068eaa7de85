"""VTK: a file of polylines (.vtp) for every frame, and a list of them with their times (.pvd).

ParaView, PyVista and VisIt open the list. The format is that of VTK's XML files, with data in base64.
"""

from __future__ import annotations

import base64
import shutil
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.files.regular import replace_file
from torsade.places import private, replace, writing
from torsade.view.strands import Strand, strands_at

if TYPE_CHECKING:
    import xarray

__all__ = ["written"]

TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "i8": "Int64"}


def written(
    dataset: xarray.Dataset, path: Path, frames: range, overwrite: bool, tell: Callable[[float], None]
) -> list[Path]:
    """Write NAME.pvd, and NAME-frames beside it with a file for every frame."""
    folder = path.with_name(path.stem + "-frames")
    check_folder(folder, overwrite)
    digits = max(4, len(str(max(frames))))
    names = [f"{path.stem}-{frame:0{digits}}.vtp" for frame in frames]
    new = private(folder, "new")
    with writing(new):
        try:
            new.mkdir()
            for k, (frame, name) in enumerate(zip(frames, names, strict=True)):
                (new / name).write_bytes(polydata(dataset, frame))
                tell((k + 1) / len(frames))
            replace(new, folder)
        finally:
            shutil.rmtree(new, ignore_errors=True)
    times = np.asarray(dataset["time"], dtype=float)[list(frames)].tolist()
    replace_file(path, _collection([f"{folder.name}/{name}" for name in names], times))
    return [path, *(folder / name for name in names)]


def check_folder(folder: Path, overwrite: bool) -> None:
    """Refuse to replace a folder, unless that is wanted and there is nothing else than frames in it."""
    if not folder.exists() and not folder.is_symlink():
        return
    ours = folder.is_dir() and all(p.suffix == ".vtp" and p.is_file() for p in folder.iterdir())
    if not ours:
        raise TorsadeError(f"{str(folder)!r} exists and holds other things than frames; give another name")
    if not overwrite:
        raise TorsadeError(
            f"{str(folder)!r} exists already; give another name, or --overwrite "
            "(overwrite=True) to replace it"
        )


def polydata(dataset: xarray.Dataset, frame: int) -> bytes:
    """The strands of a frame as polylines, with all that is recorded of their nodes."""
    strands = strands_at(dataset, frame)
    counts = [len(s.x) for s in strands]
    first = np.cumsum([0, *counts])[:-1]
    lines = [
        np.append(a + np.arange(n), [a] * s.closed) for a, n, s in zip(first, counts, strands, strict=True)
    ]
    points = np.concatenate([s.x for s in strands])
    head = f'NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="{len(lines)}"'
    text = [
        '<?xml version="1.0"?>',
        '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<PolyData>",
        "<FieldData>",
        _array("TimeValue", np.array([float(dataset["time"][frame])]), tuples=True),
        "</FieldData>",
        f'<Piece {head} NumberOfStrips="0" NumberOfPolys="0">',
        "<PointData>",
        *(_array(name, values) for name, values in _point_data(dataset, frame, strands)),
        "</PointData>",
        "<CellData>",
        _array("strand", np.arange(len(lines), dtype=np.int32)),
        "</CellData>",
        "<Points>",
        _array("position", points),
        "</Points>",
        "<Lines>",
        _array("connectivity", np.concatenate(lines).astype(np.int64)),
        _array("offsets", np.cumsum([len(line) for line in lines], dtype=np.int64)),
        "</Lines>",
        "</Piece>",
        "</PolyData>",
        "</VTKFile>",
    ]
    return ("\n".join(text) + "\n").encode()


def _point_data(
    dataset: xarray.Dataset, frame: int, strands: Sequence[Strand]
) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """What is recorded of nodes, by name, and the radius [m], which ParaView's tubes can be given."""
    for name, variable in dataset.data_vars.items():
        if variable.dims[:2] == ("time", "node") and name != "position":
            values = np.asarray(variable.isel(time=frame))
            yield str(name), np.concatenate([values[s.rows] for s in strands])
    count = sum(len(s.x) for s in strands)
    yield "radius", np.full(count, float(dataset.attrs["radius"]))


def _array(name: str, values: NDArray[np.generic], tuples: bool = False) -> str:
    """A DataArray element: the number of bytes, then the numbers, little-endian."""
    kind = values.dtype.newbyteorder("<")
    data = np.ascontiguousarray(values, dtype=kind).tobytes()
    shape = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    shape += f' NumberOfTuples="{len(values)}"' if tuples else ""
    content = base64.b64encode(len(data).to_bytes(8, "little") + data).decode()
    what = f"type={quoteattr(TYPES[kind.str[1:]])} Name={quoteattr(name)}{shape}"
    return f'<DataArray {what} format="binary">{content}</DataArray>'


def _collection(files: Sequence[str], times: Sequence[float]) -> bytes:
    """The list of files with their times [s]."""
    entries = [
        f'<DataSet timestep="{t!r}" group="" part="0" file={quoteattr(file)}/>'
        for file, t in zip(files, times, strict=True)
    ]
    text = [
        '<?xml version="1.0"?>',
        '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">',
        "<Collection>",
        *entries,
        "</Collection>",
        "</VTKFile>",
    ]
    return ("\n".join(text) + "\n").encode()

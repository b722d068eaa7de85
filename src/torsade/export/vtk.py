"""VTK: a file of polylines (.vtp) for every frame, one of the skin around them, and a list with times (.pvd).

ParaView, PyVista and VisIt open the list. The format is that of VTK's XML files, with data in base64.
"""

from __future__ import annotations

import base64
import math
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.files.regular import replace_file
from torsade.places import private, replace, writing
from torsade.view.skin import skin_meshes
from torsade.view.strands import Strand, strands_at

if TYPE_CHECKING:
    import xarray

__all__ = ["written"]

SKIN_SIDES = 32
"""Of a cylinder of skin, around it: there is one of each in every frame."""

TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "i8": "Int64"}


def written(
    dataset: xarray.Dataset, path: Path, frames: range, overwrite: bool, tell: Callable[[float], None]
) -> list[Path]:
    """Write NAME.pvd, and NAME-frames beside it with a file for every frame, and one for its skin."""
    folder = path.with_name(path.stem + "-frames")
    check_folder(folder, overwrite)
    digits = max(4, len(str(max(frames))))
    listed: list[tuple[float, int, str]] = []
    new = private(folder, "new")
    with writing(new):
        try:
            new.mkdir()
            for k, frame in enumerate(frames):
                contents = {"": strands_of(dataset, frame), "-skin": skin_of(dataset, frame)}
                for part, (what, content) in enumerate(contents.items()):
                    if content is not None:
                        name = f"{path.stem}{what}-{frame:0{digits}}.vtp"
                        (new / name).write_bytes(content)
                        listed.append((float(dataset["time"][frame]), part, f"{folder.name}/{name}"))
                tell((k + 1) / len(frames))
            replace(new, folder)
        finally:
            shutil.rmtree(new, ignore_errors=True)
    replace_file(path, _collection(listed))
    return [path, *(path.parent / file for _, _, file in listed)]


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


def strands_of(dataset: xarray.Dataset, frame: int) -> bytes:
    """The strands of a frame as polylines, with all that is recorded of their nodes."""
    strands = strands_at(dataset, frame)
    counts = [len(s.x) for s in strands]
    first = np.cumsum([0, *counts])[:-1]
    lines = [
        np.append(a + np.arange(n), [a] * s.closed) for a, n, s in zip(first, counts, strands, strict=True)
    ]
    return _polydata(
        float(dataset["time"][frame]),
        np.concatenate([s.x for s in strands]),
        {"Lines": lines},
        _point_data(dataset, frame, strands),
        {"strand": np.arange(len(lines), dtype=np.int32)},
    )


def skin_of(dataset: xarray.Dataset, frame: int) -> bytes | None:
    """The skin around which the strands of a frame lie, as triangles; None where there is none."""
    meshes = skin_meshes(dataset, frame, SKIN_SIDES, rings=math.inf)
    if not meshes:
        return None
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])[:-1]
    return _polydata(
        float(dataset["time"][frame]),
        np.concatenate([mesh.vertices for mesh in meshes]).astype(np.float32),
        {"Polys": np.concatenate([mesh.faces + a for mesh, a in zip(meshes, first, strict=True)])},
        {"Normals": np.concatenate([mesh.normals for mesh in meshes]).astype(np.float32)},
        {"side": np.repeat(np.arange(len(meshes), dtype=np.int32), [len(mesh.faces) for mesh in meshes])},
    )


def _polydata(
    time: float,
    points: NDArray[np.floating],
    cells: Mapping[str, Sequence[NDArray[np.generic]] | NDArray[np.generic]],
    point_data: Mapping[str, NDArray[np.generic]],
    cell_data: Mapping[str, NDArray[np.generic]],
) -> bytes:
    """A file of points (n, 3) [m], of cells that join them, and of what is known of both."""
    counts = " ".join(
        f'NumberOf{kind}="{len(cells.get(kind, ()))}"' for kind in ("Verts", "Lines", "Strips", "Polys")
    )
    text = [
        '<?xml version="1.0"?>',
        '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<PolyData>",
        "<FieldData>",
        _array("TimeValue", np.array([time]), tuples=True),
        "</FieldData>",
        f'<Piece NumberOfPoints="{len(points)}" {counts}>',
        "<PointData>",
        *(_array(name, values) for name, values in point_data.items()),
        "</PointData>",
        "<CellData>",
        *(_array(name, values) for name, values in cell_data.items()),
        "</CellData>",
        "<Points>",
        _array("position", points),
        "</Points>",
    ]
    for kind, joined in cells.items():
        text += [
            f"<{kind}>",
            _array("connectivity", np.concatenate(joined).astype(np.int32)),
            _array("offsets", np.cumsum([len(cell) for cell in joined], dtype=np.int32)),
            f"</{kind}>",
        ]
    text += ["</Piece>", "</PolyData>", "</VTKFile>"]
    return ("\n".join(text) + "\n").encode()


def _point_data(
    dataset: xarray.Dataset, frame: int, strands: Sequence[Strand]
) -> dict[str, NDArray[np.generic]]:
    """What is recorded of nodes, by name, and the radius [m], which ParaView's tubes can be given."""
    found: dict[str, NDArray[np.generic]] = {}
    for name, variable in dataset.data_vars.items():
        if variable.dims[:2] == ("time", "node") and name != "position":
            values = np.asarray(variable.isel(time=frame))
            found[str(name)] = np.concatenate([values[s.rows] for s in strands])
    count = sum(len(s.x) for s in strands)
    return found | {"radius": np.full(count, float(dataset.attrs["radius"]))}


def _array(name: str, values: NDArray[np.generic], tuples: bool = False) -> str:
    """A DataArray element: the number of bytes, then the numbers, little-endian."""
    kind = values.dtype.newbyteorder("<")
    data = np.ascontiguousarray(values, dtype=kind).tobytes()
    shape = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    shape += f' NumberOfTuples="{len(values)}"' if tuples else ""
    content = base64.b64encode(len(data).to_bytes(8, "little") + data).decode()
    what = f"type={quoteattr(TYPES[kind.str[1:]])} Name={quoteattr(name)}{shape}"
    return f'<DataArray {what} format="binary">{content}</DataArray>'


def _collection(files: Sequence[tuple[float, int, str]]) -> bytes:
    """The list of files with their times [s] and of which part of what is shown they are."""
    entries = [
        f'<DataSet timestep="{t!r}" group="" part="{part}" file={quoteattr(file)}/>'
        for t, part, file in files
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

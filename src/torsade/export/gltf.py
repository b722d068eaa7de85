"""glTF 2.0, binary (.glb): the fibers of one frame as coloured tubes, and skin around which they lie, for
browsers, Blender and 3-D printers.

The layout is that of the Khronos specification, section 4.4: a header, a chunk of JSON, a chunk of numbers.
Lengths are in metres, as there; colours are linear, as there.
"""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade import __version__
from torsade.files.regular import replace_file
from torsade.view.colours import linear_rgb
from torsade.view.skin import COLOUR, skin_meshes
from torsade.view.stage import OPACITY
from torsade.view.strands import tubes_at
from torsade.view.tube import Mesh

if TYPE_CHECKING:
    import xarray

__all__ = ["written"]

SIDES, SKIN_SIDES = 24, 96
"""Of a tube and of a cylinder of skin, around it."""

FIBER, SKIN = 0, 1
"""Materials, by number."""

MATERIALS = (
    {"name": "fiber", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.5}},
    {
        "name": "skin",
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear_rgb(COLOUR).tolist(), OPACITY],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.8,
        },
        "alphaMode": "BLEND",
    },
)

FLOAT, UNSIGNED_SHORT, UNSIGNED_INT = 5126, 5123, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963


def written(dataset: xarray.Dataset, path: Path, frame: int) -> list[Path]:
    """Write the fibers of a frame, coloured by strain where it is recorded, else each in its own colour.

    Skin lets see through, and comes behind them.
    """
    binary = _Binary()
    meshes = []
    for k, (mesh, rgb) in enumerate(tubes_at(dataset, frame, SIDES)):
        colour = np.ones((len(rgb), 4))
        colour[:, :3] = linear_rgb(rgb)
        primitive = binary.surface(mesh, FIBER)
        colours = binary.add(np.round(65535 * colour).astype("<u2"), UNSIGNED_SHORT, "VEC4")
        primitive["attributes"]["COLOR_0"] = colours
        meshes.append({"name": f"strand {k}", "primitives": [primitive]})
    skin = skin_meshes(dataset, frame, SKIN_SIDES, rings=math.inf)
    for k, mesh in enumerate(skin):
        meshes.append({"name": f"skin {k}", "primitives": [binary.surface(mesh, SKIN)]})
    about = {
        "protocol": dataset.attrs["protocol"],
        "frame": frame,
        "time_s": float(dataset["time"][frame]),
        "radius_m": float(dataset.attrs["radius"]),
    }
    content = {
        "asset": {"version": "2.0", "generator": f"torsade {__version__}", "extras": about},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"name": mesh["name"], "mesh": k} for k, mesh in enumerate(meshes)],
        "meshes": meshes,
        "materials": MATERIALS[: 2 if skin else 1],
        "buffers": [{"byteLength": len(binary.data)}],
        "bufferViews": binary.views,
        "accessors": binary.accessors,
    }
    replace_file(path, _container(content, bytes(binary.data)))
    return [path]


class _Binary:
    """The chunk of numbers, with what describes it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def surface(self, mesh: Mesh, material: int) -> dict[str, Any]:
        """A primitive: what is drawn of a mesh."""
        return {
            "attributes": {
                "POSITION": self.add(mesh.vertices.astype("<f4"), FLOAT, "VEC3", bounds=True),
                "NORMAL": self.add(mesh.normals.astype("<f4"), FLOAT, "VEC3"),
            },
            "indices": self.add(mesh.faces.reshape(-1).astype("<u4"), UNSIGNED_INT, "SCALAR"),
            "material": material,
        }

    def add(self, values: NDArray[np.generic], kind: int, of: str, bounds: bool = False) -> int:
        """The number of the accessor to this array."""
        target = ELEMENT_ARRAY_BUFFER if of == "SCALAR" else ARRAY_BUFFER
        raw = values.tobytes()
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw), "target": target}
        )
        self.data += raw + bytes(-len(raw) % 4)
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": kind,
            "count": len(values),
            "type": of,
        }
        if kind == UNSIGNED_SHORT:
            accessor["normalized"] = True
        if bounds:
            accessor |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _container(content: dict[str, Any], binary: bytes) -> bytes:
    """Header, JSON and numbers in one file."""
    text = json.dumps(content, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + len(binary)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, length),
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(binary), b"BIN\0"),
            binary,
        ]
    )
